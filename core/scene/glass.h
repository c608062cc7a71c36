/* scene/glass.h -- a glass: points without order, but evenly spread, made by letting random ones
 * push each other apart. */
#ifndef SCENE_GLASS_H
#define SCENE_GLASS_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct glass {
    /* asked for */
    int dim;
    size_t n;
    double min[3], max[3];
    bool
        periodic[3]; /* else reflecting: a point feels its image behind the side, and the others' */
    uint64_t seed;
    uint64_t sweeps; /* at most */
    double noise;    /* stop when the rms density noise is down to this */
    /* made */
    double *x[3];   /* [n] each */
    double reached; /* rms density noise, relative */
    uint64_t done;  /* sweeps */
};

/* Fills in x, reached, done. The same bits for the same input, whatever the threads. */
int glass_make(struct glass *g, struct error *e);
void glass_free(struct glass *g);

#endif
