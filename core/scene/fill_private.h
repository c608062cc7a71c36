/* scene/fill_private.h -- what the files fill*.c share: regions, lattices over them, points,
 * fields. */
#ifndef SCENE_FILL_PRIVATE_H
#define SCENE_FILL_PRIVATE_H

#include "scene/fill.h"
#include "scene/read.h"

/* Where a fill puts its particles: a shape, and finite bounds around it. */
struct region {
    int dim;
    double min[3], max[3];
    const struct shape *shape; /* NULL: all within the bounds */
    double volume;             /* exact for a box, sampled for others */
};
int region_init(struct region *r, const struct scene *s, const struct scene_fill *f,
                struct error *e);
bool region_holds(const struct region *r, const double x[3]);

/* A lattice whose cells fill the region's bounds exactly. */
struct grid {
    int dim, n_basis;
    double min[3], max[3];
    uint64_t n[3];            /* cells along each axis */
    const double (*basis)[3]; /* points of a cell, in fractions of it */
    double volume;            /* per particle */
};
int grid_init(struct grid *g, const struct scene *s, const struct scene_fill *f,
              const struct region *r, double spacing, struct error *e);
/* Particles of all cells, whether or not in the shape; a double, since it may be absurd. */
double grid_total(const struct grid *g);
void grid_point(const struct grid *g, uint64_t index, double x[3]);

/* Points as they are made. */
struct points {
    int dim;
    size_t n, capacity;
    double *x;       /* [dim * n], interleaved */
    double *spacing; /* [n]; NaN: not known yet */
};
int points_add(struct points *q, const double x[3], double spacing, struct error *e);
void points_fini(struct points *q);

/* The spacing that a fill asks for, from whichever of its three sizes. */
int fill_spacing(const struct scene *s, size_t a, size_t k, const struct region *r, double *spacing,
                 struct error *e);
/* Fails if so many particles are more than the scene may make. */
int fill_guard(const struct scene *s, const struct scene_fill *f, double n, struct error *e);

/* The field of this name that holds in fill k of array a: the fill's, else the array's, else
 * NULL. */
const struct scene_field *fill_field(const struct scene_array *a, size_t k, const char *name);
/* Values of component `part` of the field at `node` at n positions into out[0..n). `name` is for
 * messages. */
int field_values(const struct scene *s, const char *name, const cJSON *node, uint32_t part,
                 const double *const x[3], const double *spacing, size_t n, double *out,
                 struct error *e);
/* All initial fields of particles [first, first + n), which fill k has made. The h column holds
 * their spacing (NaN: unknown) and comes out as the smoothing length. t: what a file gave, or
 * NULL. */
int fill_fields(struct particles *p, const struct scene *s, size_t a, size_t k, size_t first,
                size_t n, const struct table *t, bool *given, struct error *e);

/* Clouds whose particles must keep apart; see fill_overlap.c. */
#define NEAR_OVERLAP .25 /* particles of different origin */
#define NEAR_SAME 1e-6   /* particles of the same file */
struct near_cloud {
    int dim;
    double near; /* how near is too near, in spacings */
    size_t n;
    const double *x[3];
    const double *spacing;
    const uint32_t *group; /* pairs of the same group are not looked at */
};
/* The first pair of different groups nearer than `near` times the lesser spacing; *found false if
 * there is none. */
int near_pair(const struct near_cloud *c, bool *found, size_t *i, size_t *j, struct error *e);

#endif
