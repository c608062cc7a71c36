/* neighbours/manager.h -- what a neighbour manager is: a structure over the sources, made anew for
 * every list, that tells which leaves of eight are near a box. It may name leaves that are not; the
 * filter decides. So all managers give the same lists, and differ in time and memory alone. */
#ifndef NEIGHBOURS_MANAGER_H
#define NEIGHBOURS_MANAGER_H

#include "neighbours/bitset.h"
#include "neighbours/filter.h"
#include "neighbours/sources.h"

struct manager_calls {
    /* Of at least one source. *bytes: the memory it took, at most. NULL: failed. */
    void *(*make)(const struct sources *s, const struct filter *filter, int threads, size_t *bytes,
                  struct error *e);
    void (*free)(void *search);
    /* Puts in every leaf with a source that is near the query, MARGIN included. How many sources
     * were looked at. Any number of threads may ask at once. */
    size_t (*find)(const void *search, const struct query *q, struct bitset *leaf);
};

extern const struct manager_calls manager_boxes, manager_cells, manager_radix, manager_octree;

#endif
