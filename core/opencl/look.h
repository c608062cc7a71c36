/* opencl/look.h -- what the host wants to know of particles on a device without having them: whether columns hold
 * what they may, and the sums of the log. */
#ifndef OPENCL_LOOK_H
#define OPENCL_LOOK_H

#include "opencl/arena.h"

struct look;

int look_open(struct look **out, struct device *d, int dim, struct error *e);
void look_close(struct look *l);

/* A real column, all its components: wrong is NaN; with `finite` what is infinite too; what is below `least`
 * (-INFINITY: nothing is). */
struct look_column {
    int column;
    bool finite;
    double least;
};
/* Of the real particles of one array. What was wrong is kept until it is asked for. */
int look_at_columns(struct look *l, const struct arena *a, const struct look_column *c, size_t n,
                    struct error *e);
/* Whether anything was wrong since last asked. Waits. */
int look_wrong(struct look *l, bool *wrong, struct error *e);

/* Of an int32 column: how many groups of SPH_LANES particles have one that is not 0. Waits. */
int look_groups(struct look *l, const struct arena *a, int column, uint64_t *n, struct error *e);

/* Sums over the real particles of one array, block by block (where the device is a processor as run/totals.c has
 * them). velocity: a column, or -1. */
struct look_totals {
    double mass, kinetic, momentum_scale, angular_scale;
    double momentum[3], angular[3];
};
int look_totals(struct look *l, const struct arena *a, int mass, int position, int velocity,
                struct look_totals *t, struct error *e);

#endif
