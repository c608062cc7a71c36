/* run/closing.c -- see closing.h. A rate that a pass makes alone is not kept from step to step
 * (plan/closing.c): its old values, which stand in the column until the pass begins, are set aside for
 * a chunk at a time, and the correction goes into the second of the property's two floats, which no
 * sweep reads. Extremes are merged in the order of the chunks, so that a zero has the same sign for any
 * number of threads. */
#include "run/closing.h"
#include "base/clones.h"
#include <float.h>
#include <stdlib.h>
#include <string.h>

struct closing_part {
    const struct column *c; /* looked at; of a correction the rate */
    const struct column *y; /* of a correction: the property; or NULL */
    uint32_t k;             /* component */
    size_t reduction;
    uint32_t op;
};

bool closing_reduces(const struct pass *p, const struct reduction *d)
{
    return d->declared->op != SPH_REDUCE_SUM && !p->max_sweeps;
}

static bool is_rate(const struct plan_array *a, int column)
{
    for (size_t q = 0; q < a->n_rate; q++)
        if (a->rate[q].rate == column)
            return true;
    return false;
}

/* The components that are corrected, then those watched, then the reduced; `to` NULL: only counted. */
static void find_parts(struct closing *c, struct closing_part *to)
{
    const struct plan *plan = c->r->plan;
    const struct plan_array *a = &plan->array[c->p->dst.array];
    const size_t pass = (size_t)(c->p - plan->pass);
    size_t n = 0;
    for (size_t q = 0; q < a->n_rate; q++) {
        const struct rate *x = &a->rate[q];
        const struct column *r = &a->p.column[x->rate], *y = &a->p.column[x->property];
        for (uint32_t k = 0; x->closed == pass && c->r->correct != 0.0 && k < r->ncomp; k++, n++)
            if (to)
                to[n] = (struct closing_part){r, y, k, 0, 0};
    }
    c->n_corrected = n;
    for (size_t i = 0; i < a->p.n_column; i++) {
        const struct column *w = &a->p.column[i];
        if (!is_rate(a, (int)i) || !pass_writes(c->p, c->p->dst.array, (int)i))
            continue;
        for (uint32_t k = 0; k < w->ncomp; k++, n++)
            if (to)
                to[n] = (struct closing_part){w, NULL, k, 0, 0};
    }
    c->n_watched = n - c->n_corrected;
    for (size_t i = 0; i < plan->n_reduction; i++) {
        const struct reduction *d = &plan->reduction[i];
        if (d->pass != pass || !closing_reduces(c->p, d))
            continue;
        if (to)
            to[n] = (struct closing_part){&a->p.column[d->column], NULL, 0, i, d->declared->op};
        n++;
    }
    c->n_reduced = n - c->n_watched - c->n_corrected;
}

int closing_begin(struct closing *c, struct run *r, const struct pass *p, size_t chunks,
                  struct error *e)
{
    *c = (struct closing){.r = r, .p = p, .n_chunk = chunks};
    find_parts(c, NULL);
    const size_t n = c->n_corrected + c->n_watched + c->n_reduced;
    c->part = malloc((n + 1) * sizeof *c->part);
    c->extreme = malloc((chunks * c->n_reduced + 1) * sizeof *c->extreme);
    if (!c->part || !c->extreme)
        return error_memory(e, "a pass", chunks * c->n_reduced * sizeof *c->extreme);
    find_parts(c, c->part);
    return 0;
}

int closing_ask(struct run *r, const struct pass *p, struct error *e)
{
    const struct plan_array *a = &r->plan->array[p->dst.array];
    struct closing c = {.r = r, .p = p};
    int status = 0;
    find_parts(&c, NULL);
    if (c.n_corrected == 0)
        return 0;
    c.part = malloc((c.n_corrected + c.n_watched + c.n_reduced) * sizeof *c.part);
    if (!c.part)
        return error_memory(e, "a pass", c.n_corrected * sizeof *c.part);
    find_parts(&c, c.part);
    for (size_t k = 0; !status && k < c.n_corrected; k++)
        status = run_refresh_ask(r, p->dst.array, (int)(c.part[k].y - a->p.column), e);
    free(c.part);
    return status;
}

void closing_free(struct closing *c)
{
    free(c->part);
    free(c->extreme);
}

size_t closing_room(const struct closing *c, size_t most)
{
    return (c->n_corrected * most * sizeof(float) + 63) / 64 * 64;
}

void closing_open(const struct closing *c, void *room, size_t first, size_t n)
{
    for (size_t k = 0; k < c->n_corrected; k++) {
        const struct column *r = c->part[k].c;
        memcpy((float *)room + k * n, (const float *)r->data + c->part[k].k * r->plane + first,
               n * sizeof(float));
    }
}

CLONES static void add_to_low(float *restrict low, double a, const float *restrict rate,
                              const float *restrict rate0, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        low[i] = (float)((double)low[i] + a * ((double)rate[i] - (double)rate0[i]));
}

static void correct(const struct closing_part *q, double a, const float *rate0, size_t first,
                    size_t n)
{
    add_to_low(q->y->low + q->k * q->y->plane + first, a,
               (const float *)q->c->data + q->k * q->c->plane + first, rate0, n);
}

static bool any_bad(const struct closing_part *q, size_t first, size_t n)
{
    const size_t at = q->k * q->c->plane + first;
    return q->c->size == sizeof(float) ? any_not_finite4((const float *)q->c->data + at, n)
                                       : any_not_finite((const double *)q->c->data + at, n);
}

void closing_close(struct closing *c, const void *room, size_t chunk, size_t first, size_t n)
{
    const struct closing_part *q = c->part + c->n_corrected;
    int bad = 0;
    for (size_t k = 0; k < c->n_watched; k++)
        bad |= any_bad(q++, first, n);
    for (size_t k = 0; k < c->n_reduced; k++, q++)
        c->extreme[chunk * c->n_reduced + k] = reduce_range(q->c, NULL, q->op, first, first + n);
    for (size_t k = 0; k < c->n_corrected; k++)
        correct(&c->part[k], c->r->correct, (const float *)room + k * n, first, n);
    if (bad) {
#pragma omp atomic write
        c->bad = 1;
    }
}

void closing_end(struct closing *c)
{
    const struct closing_part *q = c->part + c->n_corrected + c->n_watched;
    for (size_t k = 0; k < c->n_reduced; k++, q++) {
        double all = q->op == SPH_REDUCE_MIN ? INFINITY : -INFINITY;
        for (size_t i = 0; i < c->n_chunk; i++)
            all = reduction_merge(q->op, all, c->extreme[i * c->n_reduced + k]);
        c->r->reduced[q->reduction] = all;
    }
    if (c->bad)
        c->r->suspect = true;
}
