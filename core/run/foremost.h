/* run/foremost.h -- of what all ranks' particles have to offer, the foremost: the largest |error|, the particle that
 * bounds the step. */
#ifndef RUN_FOREMOST_H
#define RUN_FOREMOST_H

#include "run/run.h"

struct foremost {
    double key; /* the largest wins; NaN: nothing is offered */
    int64_t id; /* of equals the smallest */
    bool any;   /* somebody has offered something ... */
    bool mine;  /* ... and it was this rank; on one rank: any */
};

/* Everybody's becomes the winner's, and so do the `bytes` of what goes with it (NULL: nothing). All ranks call it
 * with as many bytes. */
int foremost_find(const struct run *r, struct foremost *f, void *with, size_t bytes,
                  struct error *e);

#endif
