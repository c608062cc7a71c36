/* run/totals.c -- conserved quantities, summed in blocks of particles and the blocks in order: the same
 * bits for any number of threads. */
#include "run/run.h"
#include <math.h>
#include <stdlib.h>

#define BLOCK 4096

static void add_block(const struct plan_array *a, int dim, size_t first, size_t end,
                      struct totals *t)
{
    const struct particles *p = &a->p;
    const struct column *m = &p->column[a->mass], *x = &p->column[a->position];
    const struct column *v = a->velocity >= 0 ? &p->column[a->velocity] : NULL;
    for (size_t i = first; i < end; i++) {
        double at[3] = {0.0, 0.0, 0.0}, w[3] = {0.0, 0.0, 0.0}, v2 = 0.0, x2 = 0.0;
        const double mass = column_get(m, 0, i);
        for (int c = 0; c < dim; c++) {
            at[c] = column_get(x, (uint32_t)c, i);
            if (v)
                w[c] = column_get(v, (uint32_t)c, i);
            v2 += w[c] * w[c];
            x2 += at[c] * at[c];
        }
        t->mass += mass;
        t->kinetic += 0.5 * mass * v2;
        for (int c = 0; c < 3; c++) {
            t->momentum[c] += mass * w[c];
            t->angular[c] +=
                mass * (at[(c + 1) % 3] * w[(c + 2) % 3] - at[(c + 2) % 3] * w[(c + 1) % 3]);
        }
        t->momentum_scale += mass * sqrt(v2);
        t->angular_scale += mass * sqrt(v2 * x2);
    }
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
            add_block(a, r->plan->dim, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n, &one);
            add(t, &one);
        }
        return;
    }
#pragma omp parallel for schedule(static) num_threads(r->threads) if (blocks > 4)
    for (long k = 0; k < blocks; k++) {
        const size_t end = ((size_t)k + 1) * BLOCK;
        add_block(a, r->plan->dim, (size_t)k * BLOCK, end < a->p.n ? end : a->p.n, &part[k]);
    }
    for (long k = 0; k < blocks; k++)
        add(t, &part[k]);
    free(part);
}

void run_totals(const struct run *r, struct totals *t)
{
    *t = (struct totals){0};
    for (size_t a = 0; a < r->plan->n_array; a++)
        add_array(r, &r->plan->array[a], t);
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        double *sum = d->declared->use == SPH_USE_INTERNAL    ? &t->internal
                      : d->declared->use == SPH_USE_POTENTIAL ? &t->potential
                                                              : NULL;
        if (!sum)
            continue;
        /* Anew, and not what the pass came to: the integrator has advanced it since. */
        *sum += run_reduce(r, d);
        t->has_energy = true;
    }
}
