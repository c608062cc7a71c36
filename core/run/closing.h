/* run/closing.h -- what the core does with a chunk of destinations when a pass is done with it and it is still
 * in the cache: extremes for the reductions, rates that are no numbers, the integrator's correction. */
#ifndef RUN_CLOSING_H
#define RUN_CLOSING_H

#include "run/run.h"

struct closing_part;

struct closing {
    struct run *r;
    const struct pass *p;
    struct closing_part *part; /* one for each component that is corrected, watched or reduced */
    size_t n_corrected, n_watched, n_reduced;
    double *extreme; /* [chunk][n_reduced] */
    size_t n_chunk;
    int bad; /* a rate is not finite */
};

/* Before what a pass reads is sent: of what it corrects, ghosts take the values that sweeps are to see, which are
 * those before. */
int closing_ask(struct run *r, const struct pass *p, struct error *e);
/* For all particles of the pass's destination, in `chunks` chunks. */
int closing_begin(struct closing *c, struct run *r, const struct pass *p, size_t chunks,
                  struct error *e);
/* Bytes that a thread lends for a chunk of `most` particles. */
size_t closing_room(const struct closing *c, size_t most);
/* Before the pass touches the chunk, and when it is done with it. */
void closing_open(const struct closing *c, void *room, size_t first, size_t n);
void closing_close(struct closing *c, const void *room, size_t chunk, size_t first, size_t n);
/* The reductions have their values. */
void closing_end(struct closing *c);
void closing_free(struct closing *c);

/* Whether a pass's reduction is taken here: an extreme, of a pass that does not iterate. */
bool closing_reduces(const struct pass *p, const struct reduction *d);

#endif
