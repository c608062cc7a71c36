/* domain/slab.h -- the simplest cut there is, to hold the others against: slabs across the longest side of the box
 * that holds all points, of about the same weight. Knows points and weights. */
#ifndef DOMAIN_SLAB_H
#define DOMAIN_SLAB_H

#include "base/store.h"
#include <stddef.h>

struct slab {
    int dim, ranks, axis;
    double *cut; /* [ranks - 1], ascending: from the k-th on a point belongs to rank k + 1 */
};

/* Among ranks that MPI has begun, as partition.h. */
int slab_open(struct slab *s, int dim, struct error *e);
void slab_close(struct slab *s);
int slab_cut(struct slab *s, const double *const *x, const float *weight, size_t n,
             struct error *e);
/* Into a checkpoint or out of one of as many ranks. */
int slab_store(struct slab *s, struct store *store, struct error *e);
int slab_owner(const struct slab *s, const double *x);

#endif
