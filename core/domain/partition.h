/* domain/partition.h -- which rank a place belongs to: Zoltan's recursive bisection by coordinates (RCB) or along
 * axes of inertia (RIB), its Hilbert curve (HSFC), or slabs of our own. Knows points and weights, nothing of
 * particles. */
#ifndef DOMAIN_PARTITION_H
#define DOMAIN_PARTITION_H

#include "base/store.h"
#include <stddef.h>

enum partitioner { PARTITION_RCB, PARTITION_RIB, PARTITION_HSFC, PARTITION_SLAB, PARTITIONERS };
/* "rcb", "rib", "hsfc", "slab". */
extern const char *const partitioner_name[PARTITIONERS];

struct partition;

/* All ranks call each of these together, but for partition_owner. Among ranks that MPI has begun. */
int partition_open(struct partition **p, enum partitioner which, int dim, struct error *e);
void partition_close(struct partition *p);
/* Cuts anew, for points x[axis][n] of this rank with their weights (> 0), so that all ranks have about the same. */
int partition_cut(struct partition *p, const double *const *x, const float *weight, size_t n,
                  struct error *e);
/* Its cuts, where they can be kept (rcb, slab), into a checkpoint; or out of one of as many ranks: *there. */
int partition_store(struct partition *p, struct store *s, struct error *e);
int partition_restore(struct partition *p, struct store *s, bool *there, struct error *e);
/* The rank of a place by the cuts there are: of any place, however far outside. */
int partition_owner(const struct partition *p, const double *x);

#endif
