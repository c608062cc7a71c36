/* run/totals.c -- conserved quantities, summed in blocks of particles and the blocks in order: the same
 * bits for any number of threads. Where the order of sums is strict they are exact. */
#include "base/exact_sum.h"
#include "run/device.h"
#include "run/domain.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 4096
#define PIECE 256 /* in doubles at a time */

enum {
    MASS,
    KINETIC,
    MOMENTUM_SCALE,
    ANGULAR_SCALE,
    MOMENTUM,
    ANGULAR = MOMENTUM + 3,
    SUMS = ANGULAR + 3
};

/* Component k of a piece of a column, or zeros where there is none. */
static void load(const struct plan_array *a, int column, uint32_t k, size_t first, size_t n,
                 double *to)
{
    if (column >= 0 && k < a->p.column[column].ncomp)
        column_load(&a->p.column[column], k, first, n, to);
    else
        memset(to, 0, n * sizeof *to);
}

/* A piece of particles in doubles. */
struct piece {
    double m[PIECE], x[3][PIECE], v[3][PIECE];
};

static void piece_load(struct piece *q, const struct plan_array *a, size_t first, size_t n)
{
    load(a, a->mass, 0, first, n, q->m);
    for (uint32_t c = 0; c < 3; c++) {
        load(a, a->position, c, first, n, q->x[c]);
        load(a, a->velocity, c, first, n, q->v[c]);
    }
}

/* What particle i of a piece adds to each sum. */
static inline void terms(const struct piece *q, size_t i, double term[SUMS])
{
    const double m = q->m[i];
    double v2 = 0.0, x2 = 0.0;
    for (int c = 0; c < 3; c++) {
        v2 += q->v[c][i] * q->v[c][i];
        x2 += q->x[c][i] * q->x[c][i];
    }
    term[MASS] = m;
    term[KINETIC] = 0.5 * m * v2;
    term[MOMENTUM_SCALE] = m * sqrt(v2);
    term[ANGULAR_SCALE] = m * sqrt(v2 * x2);
    for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, f = (c + 2) % 3;
        term[MOMENTUM + c] = m * q->v[c][i];
        term[ANGULAR + c] = m * (q->x[d][i] * q->v[f][i] - q->x[f][i] * q->v[d][i]);
    }
}

static void add_block(const struct plan_array *a, size_t block, double sum[SUMS])
{
    const size_t begin = block * BLOCK, end = begin + BLOCK < a->p.n ? begin + BLOCK : a->p.n;
    for (size_t first = begin; first < end; first += PIECE) {
        const size_t n = end - first < PIECE ? end - first : PIECE;
        struct piece q;
        double all[SUMS], term[SUMS];
        memcpy(all, sum, sizeof all);
        piece_load(&q, a, first, n);
        for (size_t i = 0; i < n; i++) {
            terms(&q, i, term);
            for (int k = 0; k < SUMS; k++)
                all[k] += term[k];
        }
        memcpy(sum, all, sizeof all);
    }
}

static void add_array(const struct run *r, const struct plan_array *a, double sum[SUMS])
{
    const long blocks = (long)((a->p.n + BLOCK - 1) / BLOCK);
    double(*part)[SUMS] = calloc((size_t)blocks + 1, sizeof *part);
#pragma omp parallel for schedule(static) num_threads(r->threads) if (part && blocks > 4)
    for (long k = 0; k < (part ? blocks : 0); k++)
        add_block(a, (size_t)k, part[k]);
    for (long k = 0; k < blocks; k++) {
        double one[SUMS] = {0.0};
        if (!part) /* the same sums in the same order, on the stack */
            add_block(a, (size_t)k, one);
        for (int q = 0; q < SUMS; q++)
            sum[q] += part ? part[k][q] : one[q];
    }
    free(part);
}

static void add_exactly(const struct plan_array *a, struct exact_sum sum[SUMS])
{
    for (size_t first = 0; first < a->p.n; first += PIECE) {
        const size_t n = a->p.n - first < PIECE ? a->p.n - first : PIECE;
        struct piece q;
        double term[SUMS];
        piece_load(&q, a, first, n);
        for (size_t i = 0; i < n; i++) {
            terms(&q, i, term);
            for (int k = 0; k < SUMS; k++)
                exact_add(&sum[k], term[k]);
        }
    }
}

/* Of this rank's particles; with --strict of all. */
static int sum_all(const struct run *r, double sum[SUMS], struct error *e)
{
    struct exact_sum exact[SUMS] = {{.digit = {0}}};
    for (size_t a = 0; a < r->plan->n_array; a++) {
        if (r->plan->strict)
            add_exactly(&r->plan->array[a], exact);
        else
            add_array(r, &r->plan->array[a], sum);
    }
    if (!r->plan->strict)
        return 0;
    if (run_share_exact(r, exact, SUMS, e))
        return -1;
    for (int k = 0; k < SUMS; k++)
        sum[k] = exact_value(&exact[k]);
    return 0;
}

/* What the scene's functions reduce to energies, anew, and not what the passes came to: the integrator has advanced it
 * since. Of this rank's particles; with --strict of all. */
static int sum_energies(const struct run *r, struct totals *t, struct error *e)
{
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        double *of = totals_of(t, d->declared->use), here;
        if (!of)
            continue;
        if (run_reduce(r, d, &here, e))
            return -1;
        *of += here;
        t->has_energy = true;
    }
    return 0;
}

/* Of all ranks. */
static int share(const struct run *r, double sum[SUMS], struct totals *t, struct error *e)
{
    double all[SUMS + 2];
    uint32_t op[SUMS + 2];
    if (r->plan->strict)
        return 0;
    for (int k = 0; k < SUMS + 2; k++) {
        all[k] = k < SUMS ? sum[k] : k == SUMS ? t->internal : t->potential;
        op[k] = SPH_REDUCE_SUM;
    }
    if (run_share_numbers(r, all, op, SUMS + 2, e))
        return -1;
    memcpy(sum, all, SUMS * sizeof *sum);
    t->internal = all[SUMS];
    t->potential = all[SUMS + 1];
    return 0;
}

int run_totals(struct run *r, struct totals *t, struct error *e)
{
    double sum[SUMS] = {0.0};
    *t = (struct totals){0};
    if (r->device)
        return run_device_totals(r, t, e);
    if (sum_all(r, sum, e) || sum_energies(r, t, e) || share(r, sum, t, e))
        return -1;
    t->mass = sum[MASS];
    t->kinetic = sum[KINETIC];
    t->momentum_scale = sum[MOMENTUM_SCALE];
    t->angular_scale = sum[ANGULAR_SCALE];
    memcpy(t->momentum, sum + MOMENTUM, sizeof t->momentum);
    memcpy(t->angular, sum + ANGULAR, sizeof t->angular);
    return 0;
}
