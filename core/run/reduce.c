/* run/reduce.c -- the global sum, minimum or maximum of a column: summed in blocks of particles and the
 * blocks in order, so that it is the same for any number of threads. */
#include "base/clones.h"
#include "base/exact_sum.h"
#include "run/domain.h"
#include <math.h>
#include <stdlib.h>

#define BLOCK 4096
#define LANES 8
#define PIECE 256

/* The extreme of n numbers, and whether one is none. In several at a time, or each would wait for the one
 * before. */
#define EXTREME(name, T, BETTER)                                                                   \
    CLONES static double name(const T *value, size_t n, double start, bool *bad)                   \
    {                                                                                              \
        T best[LANES];                                                                             \
        int none[LANES] = {0}, any = 0;                                                            \
        for (size_t k = 0; k < LANES; k++)                                                         \
            best[k] = (T)start;                                                                    \
        for (size_t i = 0; i + LANES <= n; i += LANES)                                             \
            for (size_t k = 0; k < LANES; k++) {                                                   \
                best[k] = value[i + k] BETTER best[k] ? value[i + k] : best[k];                    \
                none[k] |= isnan(value[i + k]);                                                    \
            }                                                                                      \
        for (size_t i = n / LANES * LANES; i < n; i++) {                                           \
            best[0] = value[i] BETTER best[0] ? value[i] : best[0];                                \
            none[0] |= isnan(value[i]);                                                            \
        }                                                                                          \
        for (size_t k = 0; k < LANES; k++) {                                                       \
            best[0] = best[k] BETTER best[0] ? best[k] : best[0];                                  \
            any |= none[k];                                                                        \
        }                                                                                          \
        *bad = any;                                                                                \
        return (double)best[0];                                                                    \
    }
EXTREME(least, double, <)
EXTREME(most, double, >)
EXTREME(least4, float, <)
EXTREME(most4, float, >)

static double extreme(const struct column *c, bool smallest, size_t first, size_t end)
{
    const double start = smallest ? INFINITY : -INFINITY;
    const size_t n = end - first;
    bool bad = false;
    double out = start;
    if (c->low) {
        double value[PIECE];
        for (size_t i = first; i < end; i += PIECE) {
            const size_t some = end - i < PIECE ? end - i : PIECE;
            bool none = false;
            column_load(c, 0, i, some, value);
            out = smallest ? least(value, some, out, &none) : most(value, some, out, &none);
            bad |= none;
        }
    } else if (c->size == sizeof(float)) {
        const float *value = (const float *)c->data + first;
        out = smallest ? least4(value, n, start, &bad) : most4(value, n, start, &bad);
    } else {
        const double *value = (const double *)c->data + first;
        out = smallest ? least(value, n, start, &bad) : most(value, n, start, &bad);
    }
    return bad ? NAN : out; /* it comes through */
}

double reduce_range(const struct column *value, const struct column *mass, uint32_t op,
                    size_t first, size_t end)
{
    double out = 0.0;
    if (op != SPH_REDUCE_SUM)
        return extreme(value, op == SPH_REDUCE_MIN, first, end);
    for (size_t i = first; i < end; i++) {
        const double of = column_get(value, 0, i);
        out += mass ? column_get(mass, 0, i) * of : of;
    }
    return out;
}

static int exact(const struct run *r, const struct column *value, const struct column *mass,
                 size_t n, double *out, struct error *e)
{
    struct exact_sum sum = {0};
    for (size_t i = 0; i < n; i++) {
        const double of = column_get(value, 0, i);
        exact_add(&sum, mass ? column_get(mass, 0, i) * of : of);
    }
    if (run_share_exact(r, &sum, 1, e))
        return -1;
    *out = exact_value(&sum);
    return 0;
}

bool reduced_exactly(const struct plan *plan, const struct reduction *d)
{
    return plan->strict && d->declared->op == SPH_REDUCE_SUM;
}

int run_reduce(const struct run *r, const struct reduction *d, double *out, struct error *e)
{
    const struct plan_array *a = &r->plan->array[d->array];
    const uint32_t use = d->declared->use, op = d->declared->op;
    const bool weighted = use == SPH_USE_INTERNAL || use == SPH_USE_POTENTIAL;
    const struct column *value = &a->p.column[d->column],
                        *mass = weighted ? &a->p.column[a->mass] : NULL;
    const long blocks = (long)((a->p.n + BLOCK - 1) / BLOCK);
    if (reduced_exactly(r->plan, d))
        return exact(r, value, mass, a->p.n, out, e);
    double *part = malloc(((size_t)blocks + 1) * sizeof *part);
    double all = reduce_range(value, mass, op, 0, 0);
#pragma omp parallel for schedule(static) num_threads(r->threads) if (part && blocks > 4)
    for (long k = 0; k < (part ? blocks : 0); k++) {
        const size_t end = ((size_t)k + 1) * BLOCK;
        part[k] = reduce_range(value, mass, op, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n);
    }
    for (long k = 0; k < blocks; k++) {
        const size_t first = (size_t)k * BLOCK, end = first + BLOCK;
        all = reduction_merge(
            op, all,
            part ? part[k] : reduce_range(value, mass, op, first, end < a->p.n ? end : a->p.n));
    }
    free(part);
    *out = all;
    return 0;
}
