/* neighbours/neighbours.h -- source lists for groups of destinations.
 *
 * A group is SPH_LANES consecutive destinations (the last may be short); its list holds every
 * source that may lie within reach of any of them: r < reach_i, and for symmetric lists also
 * r < reach_j, both enlarged by the skin. A list stays right while
 *     2 * largest displacement since it was made + growth of reach_i <= skin * reach_i(then)
 * for every particle. The manager behind it (linked-list cells now) is one of several to come; all
 * give the same pairs within reach, in ascending index of the source. */
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
    const double *h;   /* smoothing length; reach = scale * h */
    double scale;
};

struct group_list {
    uint64_t *begin; /* [n_group + 1] */
    uint32_t *source;
    size_t n_group, capacity, group_capacity;
    bool symmetric;
    uint64_t pairs;      /* directed pairs within reach (no skin) when it was made, self included */
    uint64_t candidates; /* distances computed while making it */
};

/* Lists for destinations dst over sources src (which may be the same arrays, self pairs included).
 * `skin` is relative (0.1). threads: how many OpenMP threads; the result is the same for any. */
int group_list_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                    bool symmetric, double skin, int threads, struct error *e);
void group_list_fini(struct group_list *list);
size_t group_list_bytes(const struct group_list *list);

/* The order that puts points into linear cell order (cells of edge `cell`, x fastest, sorted by x and
 * then by id within a cell): order[i] = old index of the i-th. Deterministic. */
int cell_order(const struct cloud *points, const int64_t *id, double cell, uint32_t *order,
               struct error *e);

#endif
