/* check/floats.h -- a bench's columns as a run in floats has them: positions whole numbers of a
 * quantum, the rest floats. */
#ifndef CHECK_FLOATS_H
#define CHECK_FLOATS_H

#include "check/bench.h"

/* In watched memory, so that nobody reads beyond. */
struct floats {
    sph_column x[2], h[2]; /* of own and other */
    sph_column *dst, *src[2];
    double quantum;
};

/* Makes every position a multiple of the quantum that this gives, everything else a float, in place:
 * then both precisions work on the same numbers. */
double floats_round(struct bench *b);

/* Copies of what the bench holds now. 0; -1: no memory. Those of destinations may be written. */
int floats_make(struct floats *f, const struct bench *b, double quantum, struct error *e);
void floats_free(struct floats *f, const struct bench *b);
/* The destinations of `batch`, and its sources (array k: 0 own, 1 other), in floats. */
void floats_batch(const struct floats *f, sph_batch *batch, int k);
/* What is written, back into the bench. */
void floats_take(const struct floats *f, struct bench *b);

#endif
