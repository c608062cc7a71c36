/* check/sweep.h -- calls a pass over a bench as a host does: in chunks, on threads, again while a
 * destination asks for it. Looks after each call at the floating point mode. */
#ifndef CHECK_SWEEP_H
#define CHECK_SWEEP_H

#include "check/bench.h"

/* In which pieces. Chunks are multiples of SPH_LANES, but for the last. */
struct style {
    const char *words; /* "in chunks of 64 on 4 threads" */
    uint64_t chunk;    /* 0: one */
    bool shuffled;     /* not in order */
    int threads;
    bool part; /* only destinations [first, first + count), in one call */
    uint64_t first, count;
};

/* The written columns of the destinations, whole: a copy. */
struct image {
    char **data; /* [property], NULL: not written */
};

struct sweep {
    struct image given;     /* what the plugin found, each time */
    sph_status status;      /* the worst of all calls */
    char reason[512];       /* for it */
    const char *mode_after; /* "run": that call changed the floating point mode; or NULL */
    uint32_t sweeps;        /* how often a pass was called that iterates */
    bool unfinished;        /* destinations still ask for another sweep */
};

/* Copies what is written. */
int image_take(struct image *out, const struct bench *b, struct error *e);
void image_free(struct image *s, const struct bench *b);
/* Puts it back. */
void image_put(const struct image *s, struct bench *b);

/* Once for a bench: keeps what it holds, with the outputs marked and the sums at their start. */
int sweep_begin(struct sweep *s, struct bench *b, struct error *e);
/* Puts that back and calls the pass. Fails for want of memory alone; see s->status. */
int sweep_run(struct sweep *s, struct bench *b, const struct style *style, struct error *e);
void sweep_end(struct sweep *s, const struct bench *b);

/* Is element i of component c the mark of what has not been set? */
bool sweep_is_mark(const struct column *c, const char *data, size_t element);

#endif
