/* plan/exchange.h -- which columns of ghosts are brought up to date before which pass, step after step, while
 * neighbour lists hold: by what passes read of sources, what they write, and what the integrator advances. Of each
 * array, for whoever holds its ghosts; counts of ghosts are not the plan's. Knows the plan alone. */
#ifndef PLAN_EXCHANGE_H
#define PLAN_EXCHANGE_H

#include "plan/plan.h"

/* A column of an array. */
struct exchange_column {
    size_t array;
    int column;
};

/* What is exchanged at once. */
struct exchange {
    size_t pass;
    size_t evaluation; /* of the step: 0, 1, ... */
    bool again; /* before each further sweep of a pass that repeats itself, in any evaluation */
    size_t first, n; /* into column */
};

struct exchanges {
    struct exchange *at;
    size_t n, capacity;
    struct exchange_column *column;
    size_t n_column, column_capacity;
};

/* Of a step. To be freed in any case. */
int exchanges_make(struct exchanges *x, const struct plan *plan, struct error *e);
void exchanges_free(struct exchanges *x);

/* Bytes of a message that holds n[array] particles of each array: each column in whole words of 8 bytes, as it is
 * held while the run goes on. */
size_t exchange_bytes(const struct exchanges *x, const struct exchange *one,
                      const struct plan *plan, const size_t *n);

#endif
