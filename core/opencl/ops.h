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

/* -- What is left on the device -------- */

/* Waiting for a device costs more than much of what it does. So numbers may be left in places 0 to
 * OPS_RESULTS - 3 (calls that wait themselves use the last two), and signs of trouble in a word of flags, and
 * all be asked for at once. */
#define OPS_RESULTS 256
enum {
    OPS_BAD_RATE = 1, /* ops_advance: a rate is not finite */
    OPS_NOWHERE = 2,  /* ops_mirror_places: a position has no place in the frame, or is no number */
    OPS_BAD_ORDER = 4 /* ops_permute: an index that no particle has */
};

/* The first n results (out: double[n]; n may be 0) and, unless NULL, the flags since last asked, which begin
 * anew. Waits. */
int ops_results(struct ops *o, double *out, size_t n, uint32_t *flags, struct error *e);
/* The flags alone. */
int ops_flags(struct ops *o, uint32_t *flags, struct error *e);

/* -- Columns -------- */

/* run_mirror: the mirror, ghosts included, is right; of the position in whole numbers of the quantum (see
 * OPS_NOWHERE). A column without one: nothing is done. */
int ops_mirror(struct ops *o, struct arena *a, int column, struct error *e);
int ops_mirror_places(struct ops *o, struct arena *a, int column, const double *centre,
                      double quantum, struct error *e);
/* particles_permute: order: uint[n]; every `state` column of the array. Ghosts are lost. Of the other columns
 * neither side's copy is right afterwards. */
int ops_permute(struct ops *o, struct arena *a, const struct device_buffer *order, struct error *e);
/* Real particles' values of one column into another of the same type, held alike. */
int ops_copy(struct ops *o, struct arena *a, int from, int to, struct error *e);
/* A column's component of n real particles to one number, the same however often and on any device of its kind:
 * reduce_range. mass: a column or -1: its product with the value is summed. op: SPH_REDUCE_... */
int ops_reduce(struct ops *o, const struct arena *a, int column, uint32_t component, int mass,
               uint32_t op, double *out, struct error *e);
/* The same, left as result k. */
int ops_reduce_begin(struct ops *o, const struct arena *a, int column, uint32_t component, int mass,
                     uint32_t op, size_t k, struct error *e);

/* -- Sides -------- */

/* Builds what the rest of these need, where the box has sides: else they do it when first called. */
int ops_need_sides(struct ops *o, const struct box *box, struct error *e);
/* sides_wrap. *moved: how many; NULL: nobody asks, and nothing waits. */
int ops_wrap(struct ops *o, struct arena *a, const struct box *box, size_t *moved, struct error *e);
/* A ghost's parent and image, as in struct ghosts. Begin with zeros. */
struct ops_ghosts {
    struct device_buffer parent, image; /* uint, uchar */
    size_t n;
};
void ops_ghosts_release(struct ops *o, struct ops_ghosts *g);
/* ghosts_make, but for their order, which is that of the parents, image by image. x and h of ghosts are set. Waits
 * once an axis that has images. */
int ops_ghosts_make(struct ops *o, struct arena *a, struct ops_ghosts *g, const struct box *box,
                    double margin, struct error *e);
/* ghosts_refresh; a mirror in floats is refreshed with its column, one of positions is not. */
int ops_ghosts_refresh(struct ops *o, struct arena *a, const struct ops_ghosts *g,
                       const struct box *box, int column, struct error *e);

/* -- Other ranks -------- */

/* Builds what these need, at once. */
int ops_need_halo(struct ops *o, struct error *e);
/* The same as they were found elsewhere: n of them. */
int ops_ghosts_set(struct ops *o, struct ops_ghosts *g, const uint32_t *parent,
                   const uint8_t *image, size_t n, struct error *e);
/* Real particles that others want, and as which images. Begin with zeros. */
struct ops_sends {
    struct device_buffer index, image; /* uint, uchar */
    size_t n;
};
void ops_sends_release(struct ops *o, struct ops_sends *s);
int ops_sends_set(struct ops *o, struct ops_sends *s, const uint32_t *index, const uint8_t *image,
                  size_t n, struct error *e);
/* Bytes of n elements of a column where columns stand one behind the other: whole words. */
size_t ops_packed(const struct arena *a, int column, size_t n);
/* What the others want of a column: component by component, from byte `at` of `out` on. */
int ops_pack(struct ops *o, struct arena *a, const struct ops_sends *s, const struct box *box,
             int column, struct device_buffer *out, size_t at, struct error *e);
/* What stands like that becomes that of n ghosts, from `first` on. Mirrors are not touched. */
int ops_unpack(struct ops *o, struct arena *a, int column, size_t first, size_t n,
               const struct device_buffer *in, size_t at, struct error *e);

/* -- Lists: are they still right? -------- */

/* Where particles stood and how far they reached when lists were made: skin_keep, in doubles. Begin with
 * zeros. */
struct ops_skin {
    struct device_buffer x, h;
    size_t n;
};
void ops_skin_release(struct ops *o, struct ops_skin *s);
/* Elements of x from one component to the next, and of h in all. */
size_t ops_skin_stride(const struct ops_skin *s);
int ops_skin_keep(struct ops *o, struct ops_skin *s, const struct arena *a, int position,
                  int smoothing, struct error *e);
/* skin_change: *moved, *room as in struct skin_change; reach = scale * h. NaN if the number of
 * particles has changed. */
int ops_skin_change(struct ops *o, const struct ops_skin *s, const struct arena *a, int position,
                    int smoothing, double scale, double skin, double *moved, double *room,
                    struct error *e);
/* The same, left as results k and k + 1. */
int ops_skin_begin(struct ops *o, const struct ops_skin *s, const struct arena *a, int position,
                   int smoothing, double scale, double skin, size_t k, struct error *e);

/* -- The integrator -------- */

/* Operations [from, to) of a table, none of them an evaluation, on all rates of an array, over a step of dt: what
 * advance() in run/advance.c does. Columns written are marked so. *bad: a rate that it read or wrote is not
 * finite; NULL: it is in the flags, and nothing waits. Rates and their copies are not traded here: saved rates
 * are copied. What is in floats is rounded at each operation. */
int ops_advance(struct ops *o, struct arena *a, const struct plan_array *pa, const struct op *op,
                size_t from, size_t to, double dt, bool *bad, struct error *e);

#endif
