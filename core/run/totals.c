/* run/totals.c -- conserved quantities, summed in blocks of particles and the blocks in order: the same
 * bits for any number of threads. */
#include "run/device.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 4096
#define PIECE 256 /* in doubles at a time */

/* Component k of a piece of a column, or zeros where there is none. */
static void load(const struct plan_array *a, int column, uint32_t k, size_t first, size_t n,
                 double *to)
{
    if (column >= 0 && k < a->p.column[column].ncomp)
        column_load(&a->p.column[column], k, first, n, to);
    else
        memset(to, 0, n * sizeof *to);
}

static void add_piece(const struct plan_array *a, size_t first, size_t n, struct totals *sum)
{
    double m[PIECE], x[3][PIECE], v[3][PIECE];
    struct totals t = *sum;
    load(a, a->mass, 0, first, n, m);
    for (uint32_t c = 0; c < 3; c++) {
        load(a, a->position, c, first, n, x[c]);
        load(a, a->velocity, c, first, n, v[c]);
    }
    for (size_t i = 0; i < n; i++) {
        double v2 = 0.0, x2 = 0.0;
        for (int c = 0; c < 3; c++) {
            v2 += v[c][i] * v[c][i];
            x2 += x[c][i] * x[c][i];
        }
        t.mass += m[i];
        t.kinetic += 0.5 * m[i] * v2;
        for (int c = 0; c < 3; c++) {
            const int d = (c + 1) % 3, f = (c + 2) % 3;
            t.momentum[c] += m[i] * v[c][i];
            t.angular[c] += m[i] * (x[d][i] * v[f][i] - x[f][i] * v[d][i]);
        }
        t.momentum_scale += m[i] * sqrt(v2);
        t.angular_scale += m[i] * sqrt(v2 * x2);
    }
    *sum = t;
}

static void add_block(const struct plan_array *a, size_t first, size_t end, struct totals *t)
{
    for (; first < end; first += PIECE)
        add_piece(a, first, end - first < PIECE ? end - first : PIECE, t);
}

static void add(struct totals *t, const struct totals *b)
{
    t->mass += b->mass;
    t->kinetic += b->kinetic;
    t->momentum_scale += b->momentum_scale;
    t->angular_scale += b->angular_scale;
    for (int c = 0; c < 3; c++) {
        t->momentum[c] += b->momentum[c];
        t->angular[c] += b->angular[c];
    }
}

static void add_array(const struct run *r, const struct plan_array *a, struct totals *t)
{
    const long blocks = (long)((a->p.n + BLOCK - 1) / BLOCK);
    struct totals *part = calloc((size_t)blocks + 1, sizeof *part);
    if (!part) { /* the same sums in the same order, on the stack */
        for (long k = 0; k < blocks; k++) {
            struct totals one = {0};
            const size_t end = ((size_t)k + 1) * BLOCK;
            add_block(a, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n, &one);
            add(t, &one);
        }
        return;
    }
#pragma omp parallel for schedule(static) num_threads(r->threads) if (blocks > 4)
    for (long k = 0; k < blocks; k++) {
        const size_t end = ((size_t)k + 1) * BLOCK;
        add_block(a, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n, &part[k]);
    }
    for (long k = 0; k < blocks; k++)
        add(t, &part[k]);
    free(part);
}

int run_totals(struct run *r, struct totals *t, struct error *e)
{
    *t = (struct totals){0};
    if (r->device)
        return run_device_totals(r, t, e);
    for (size_t a = 0; a < r->plan->n_array; a++)
        add_array(r, &r->plan->array[a], t);
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        double *sum = totals_of(t, d->declared->use);
        if (!sum)
            continue;
        /* Anew, and not what the pass came to: the integrator has advanced it since. */
        *sum += run_reduce(r, d);
        t->has_energy = true;
    }
    return 0;
}
