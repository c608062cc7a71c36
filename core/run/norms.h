/* run/norms.h -- how far particles are from a reference, in numbers. */
#ifndef RUN_NORMS_H
#define RUN_NORMS_H

#include "io/summary.h"
#include "run/run.h"

/* Of n particles: whether it counts, |f - f*|^2 and |f*|^2. */
struct deviation {
    bool *inside;
    double *d2, *s2;
};

int deviation_init(struct deviation *d, size_t n, struct error *e);
void deviation_fini(struct deviation *d);

/* Sums over the particles of all ranks (sums.h), with V = m / rho: l1 = sum V |d| / sum V, l1_rel = sum V |d| / sum V
 * |f*|, l2 = sqrt(sum V |d|^2 / sum V), l2_rel = sqrt(sum V |d|^2 / sum V |f*|^2), linf the largest |d|, and
 * the place of it. Sets these and n; NaN where there is nobody. */
int norms_of(const struct run *r, const struct plan_array *a, const struct deviation *d,
             struct summary_error *out, struct error *e);

/* Of two courses in time, by straight lines between their rows, over the time that both cover: integrals by
 * the trapezoidal rule over the moments of both. Pieces at whose end a value is NaN are left out. */
struct course {
    const double *time, *value; /* time rises */
    size_t n;
    double scale_time, scale;
};
struct course_norms {
    double begin, end, l1, l1_rel, l2, l2_rel, linf; /* NaN where there is nothing in common */
};
int course_compare(const struct course *f, const struct course *reference, struct course_norms *out,
                   struct error *e);

#endif
