/* run/reduce.c -- the global sum, minimum or maximum of a column: summed in blocks of particles and the
 * blocks in order, so that it is the same for any number of threads. */
#include "run/run.h"
#include <math.h>
#include <stdlib.h>

#define BLOCK 4096

struct task {
    const struct column *value, *mass; /* mass NULL: not weighted */
    uint32_t op;
};

/* A NaN in a minimum or maximum comes through. */
static double reduce_block(const struct task *t, size_t first, size_t end)
{
    double out = t->op == SPH_REDUCE_MIN ? INFINITY : t->op == SPH_REDUCE_MAX ? -INFINITY : 0.0;
    bool bad = false;
    for (size_t i = first; i < end; i++) {
        const double value = column_get(t->value, 0, i);
        if (t->op == SPH_REDUCE_SUM)
            out += t->mass ? column_get(t->mass, 0, i) * value : value;
        else if (t->op == SPH_REDUCE_MIN)
            out = value < out ? value : out;
        else
            out = value > out ? value : out;
        bad |= isnan(value);
    }
    return bad && t->op != SPH_REDUCE_SUM ? NAN : out;
}

double run_reduce(const struct run *r, const struct reduction *d)
{
    const struct plan_array *a = &r->plan->array[d->array];
    const uint32_t use = d->declared->use;
    const bool weighted = use == SPH_USE_INTERNAL || use == SPH_USE_POTENTIAL;
    const struct task t = {&a->p.column[d->column], weighted ? &a->p.column[a->mass] : NULL,
                           d->declared->op};
    const long blocks = (long)((a->p.n + BLOCK - 1) / BLOCK);
    double *part = malloc(((size_t)blocks + 1) * sizeof *part);
    double out = reduce_block(&t, 0, 0);
#pragma omp parallel for schedule(static) num_threads(r->threads) if (part && blocks > 4)
    for (long k = 0; k < (part ? blocks : 0); k++) {
        const size_t end = ((size_t)k + 1) * BLOCK;
        part[k] = reduce_block(&t, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n);
    }
    for (long k = 0; k < blocks; k++) {
        const size_t end = ((size_t)k + 1) * BLOCK;
        out = reduction_merge(
            d->declared->op, out,
            part ? part[k] : reduce_block(&t, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n));
    }
    free(part);
    return out;
}
