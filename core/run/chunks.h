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
};

/* Accumulators to their start, then the function's before, run over every source array, and after. Ghosts
 * and mirrors are right. */
int chunks_run(struct run *r, struct pass *p, const struct ranges *ranges, struct error *e);
/* The function's prepare: no particles, one thread. */
int chunks_prepare(struct run *r, const struct pass *p, struct error *e);

#endif
