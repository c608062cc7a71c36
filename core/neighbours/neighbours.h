/* neighbours/neighbours.h -- source lists for groups of destinations.
 *
 * A group is SPH_LANES consecutive destinations (the last may be short); its list holds every
 * source that may lie within reach of any of them: r < reach_i, and for symmetric lists also r <
 * reach_j, both enlarged by the skin. A list stays right while 2 * largest displacement since it
 * was made + growth of reach_i <= skin * reach_i(then) for every particle. A list is in ascending
 * index of the source, without repeats. Sources up to 0.5 % beyond the enlarged reach may be in
 * it.
 *
 * Behind it stands a tree of boxes over the sources in the order in which they stand, so sort
 * them by cell_order now and then. Sources out of all order are sorted aside, which costs about
 * as much again; a group whose destinations are far apart costs twenty times another. No ratio of
 * smoothing lengths and no outlier makes it slow or large. */
#ifndef NEIGHBOURS_NEIGHBOURS_H
#define NEIGHBOURS_NEIGHBOURS_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Points in up to three dimensions with their reach (support radius); not owned. */
struct cloud {
    int dim;
    size_t n;
    const double *x[3];
    const double *h; /* smoothing length; reach = scale * h */
    double scale;
};

struct group_list {
    uint64_t *begin; /* [n_group + 1] */
    uint32_t *source;
    size_t n_group, capacity, group_capacity;
    bool symmetric;
    double true_share; /* set by who counts (group_list_count): true pairs per entry of the list */
    uint64_t candidates; /* distances computed while making it */
};

/* Lists for destinations dst over sources src (which may be the same arrays, self pairs
 * included). `skin` is relative (0.1). threads: how many OpenMP threads; the result is the same
 * for any. src->h may be NULL if !symmetric. Fails, naming the particle by its index, if a
 * position or smoothing length is not a number that can be (finite, h >= 0). Begin with a list of
 * zeros; one that is made again uses its memory again. */
int group_list_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                    bool symmetric, double skin, int threads, struct error *e);
/* Directed pairs within reach (no skin, self pairs included) among those that the list offers. */
uint64_t group_list_count(const struct group_list *list, const struct cloud *dst,
                          const struct cloud *src);
void group_list_fini(struct group_list *list);
size_t group_list_bytes(const struct group_list *list);

/* The order that puts points into linear cell order (cells of edge `cell`, x fastest, sorted by x
 * and then by id within a cell): order[i] = old index of the i-th. id may be NULL. Deterministic,
 * and the same however the points stood before if the ids differ. Cells that hold many points are
 * divided further, and in a box that is mostly empty larger cells are taken first. Best for the
 * lists: a cell as wide as the reach (with variable h: the mean reach) in 3D, 1.3 times that in
 * 2D. */
int cell_order(const struct cloud *points, const int64_t *id, double cell, uint32_t *order,
               struct error *e);

#endif
