/* neighbours/worker.h -- what a thread does for neighbour lists: those of a run of groups, one
 * after the other, in memory of its own. */
#ifndef NEIGHBOURS_WORKER_H
#define NEIGHBOURS_WORKER_H

#include "neighbours/manager.h"

#define LANES LEAF /* destinations in a group */

/* What all threads share. */
struct job {
    const struct cloud *dst;
    const struct sources *src;
    const struct filter *filter;
    const struct manager_calls *manager;
    const void *search;      /* the manager's */
    double scale;            /* of the destinations' reach, skin and slack included */
    uint64_t *count;         /* [n_group]: spans of each group */
    const struct cloud *all; /* the sources as they stand in their array */
    bool symmetric;
    struct overflow crowd; /* what is asked */
};

/* What one thread owns. */
struct worker {
    sph_span *span; /* lists of its chunks, one after the other */
    uint16_t *step;
    size_t n_span, span_capacity, n_step, step_capacity;
    struct found found;      /* sources of the group at hand */
    uint32_t *leaf, *chosen; /* of the bundle at hand; of the group */
    struct packed_leaf *pack;
    struct packed_box8 *box;
    size_t n_leaf, leaf_capacity;
    struct box8 eight; /* boxes of groups 8 eight_at and on */
    double least[LEAF];
    size_t eight_at;
    struct bitset near, unsorted; /* leaves near a query; sources of a group */
    size_t left, last; /* of its chunks the first not yet moved into the list, the last */
    uint64_t visited, candidates;
    struct overflow crowd; /* what was found */
    bool no_memory;
    char apart[64]; /* from the next one's cache lines */
};

/* Appends the lists of groups [first, last), which must not be none, and sets their counts. What
 * comes out depends on nothing but the job and the groups. Sets w->no_memory if it could not. */
void worker_make(const struct job *j, struct worker *w, size_t first, size_t last);
void worker_fini(struct worker *w);
size_t worker_bytes(const struct worker *w);

#endif
