/* opencl/ops.h -- what the core itself does to columns on a device: copies for sweeps in floats, ghosts, order,
 * reductions, the integrator. Each has its counterpart on the host, named beside it, and does as that does. */
#ifndef OPENCL_OPS_H
#define OPENCL_OPS_H

#include "domain/sides.h"
#include "opencl/arena.h"
#include "plan/plan.h"

struct ops; /* programs and room; one a device */

int ops_open(struct ops **out, struct device *d, int dim, struct error *e);
void ops_close(struct ops *o);

/* -- Columns -------- */

/* run_mirror: the mirror, ghosts included, is right; of the position in whole numbers of the quantum. */
int ops_mirror(struct ops *o, struct arena *a, int column, struct error *e);
int ops_mirror_places(struct ops *o, struct arena *a, int column, const double *centre,
                      double quantum, struct error *e);
/* particles_permute: order: uint[n]; every `state` column of the array. Ghosts are lost. */
int ops_permute(struct ops *o, struct arena *a, const struct device_buffer *order, struct error *e);
/* A column's component of n real particles to one number, the same however often and on any device of its kind:
 * reduce_range. mass: a column or -1: its product with the value is summed. op: SPH_REDUCE_... */
int ops_reduce(struct ops *o, const struct arena *a, int column, uint32_t component, int mass,
               uint32_t op, double *out, struct error *e);
/* Least and largest of a component of real particles; NaN where one is. */
int ops_range(struct ops *o, const struct arena *a, int column, uint32_t component, double *least,
              double *most, struct error *e);

/* -- Sides -------- */

/* sides_wrap. *moved: how many. */
int ops_wrap(struct ops *o, struct arena *a, const struct box *box, size_t *moved, struct error *e);
/* A ghost's parent and image, as in struct ghosts. */
struct ops_ghosts {
    struct device_buffer parent, image; /* uint, uchar */
    size_t n;
};
/* ghosts_make, but for their order, which is that of the parents, image by image. x and h of ghosts are set. */
int ops_ghosts_make(struct ops *o, struct arena *a, struct ops_ghosts *g, const struct box *box,
                    double margin, struct error *e);
/* ghosts_refresh */
int ops_ghosts_refresh(struct ops *o, struct arena *a, const struct ops_ghosts *g,
                       const struct box *box, int column, struct error *e);

/* -- Lists: are they still right? -------- */

/* Where particles stood and how far they reached when lists were made: skin_keep, in doubles. */
struct ops_skin {
    struct device_buffer x, h;
    size_t n;
};
int ops_skin_keep(struct ops *o, struct ops_skin *s, const struct arena *a, int position,
                  int smoothing, struct error *e);
/* skin_change: *moved, *room as in struct skin_change; reach = scale * h. */
int ops_skin_change(struct ops *o, const struct ops_skin *s, const struct arena *a, int position,
                    int smoothing, double scale, double skin, double *moved, double *room,
                    struct error *e);

/* -- The integrator -------- */

/* Operations [from, to) of a table, none of them an evaluation, on all rates of an array, over a step of dt: what
 * advance() in run/advance.c does. Columns written are marked so. *bad: a rate is not finite. Rates and their
 * copies are not traded here: saved rates are copied. */
int ops_advance(struct ops *o, struct arena *a, const struct plan_array *pa, const struct op *op,
                size_t from, size_t to, double dt, bool *bad, struct error *e);
/* How many elements of a component are not finite, or less than `least` (-INFINITY: not asked). */
int ops_wrong(struct ops *o, const struct arena *a, int column, double least, uint64_t *n,
              struct error *e);

#endif
