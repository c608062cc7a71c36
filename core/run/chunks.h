/* run/chunks.h -- what a pass does with its destinations, a chunk of groups at a time, on all threads. */
#ifndef RUN_CHUNKS_H
#define RUN_CHUNKS_H

#include "run/run.h"

/* Destinations a task: a multiple of SPH_LANES, small enough to balance, large enough to hide the call. */
#define CHUNK 512

/* Ranges of destinations that still take part, none longer than a chunk. */
struct ranges {
    uint64_t *first, *count;
    size_t n, capacity;
    size_t
        near; /* those behind so many need ghosts whose values are still on their way: all others go first */
};

/* Accumulators to their start, then the function's before, run over every source array, and after. Ghosts
 * and mirrors are right; those of other ranks when pass_arrive has been called, before the far ranges. */
int chunks_run(struct run *r, struct pass *p, const struct ranges *ranges, struct error *e);
/* passes.c: waits for what other ranks have sent. */
int pass_arrive(struct run *r, const struct pass *p, struct error *e);
/* The function's prepare: no particles, one thread. */
int chunks_prepare(struct run *r, const struct pass *p, struct error *e);

#endif
