/* plan/measured.h -- a number of a particle that a scene asks for by name: a property, or of a vector or
 * tensor a component ("v.x"), of a vector what points away from a center ("v.r") and around it ("v.phi"). */
#ifndef PLAN_MEASURED_H
#define PLAN_MEASURED_H

#include "particles/particles.h"
#include "scene/scene.h"

enum measured_kind {
    MEASURED_COMPONENT, /* also of a scalar */
    MEASURED_LENGTH,    /* of a vector or a tensor */
    MEASURED_RADIAL,    /* v . e_r */
    MEASURED_AZIMUTHAL  /* v . e_phi */
};

struct measured {
    int column;
    enum measured_kind kind;
    uint32_t k;
};

/* "of" among an array's properties; -1: not there. *component: the property is, but has no such component. */
int measured_find(const struct particles *p, const char *of, struct measured *out, bool *component);

/* Its value of particle i at x; `mirrored` (a bit an axis): the particle is an image, reflected there. */
double measured_value(const struct particles *p, const struct measured *m,
                      const struct scene_about *about, size_t i, const double x[3],
                      unsigned mirrored);

/* Where a particle is. */
static inline void measured_place(const struct particles *p, int position, size_t i, double x[3])
{
    for (int c = 0; c < 3; c++)
        x[c] = c < p->dim ? column_get(&p->column[position], (uint32_t)c, i) : 0.0;
}

#endif
