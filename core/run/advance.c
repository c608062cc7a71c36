/* run/advance.c -- one step of the integrator's table, on the columns that the plan's rate table names. What
 * stands between two evaluations is done chunk by chunk, while the chunk is in the cache. */
#include "run/run.h"
#include <omp.h>
#include <stdio.h>
#include <string.h>

#define CHUNK 2048
/* Fewer particles than this are done before a second thread has woken. */
#define PARALLEL_FROM 20000

static int saved(const struct particles *p, int column)
{
    char name[128];
    snprintf(name, sizeof name, "%s.0", p->column[column].name);
    return particles_find(p, name);
}

/* y = base + a * (r - r0) for every way in which y and the rates are held; r0 NULL: none. */
#define COMBINE(name, Y, RATE)                                                                     \
    static void name(Y *y, const Y *base, double a, const RATE *rate, const RATE *rate0, size_t n) \
    {                                                                                              \
        if (rate0)                                                                                 \
            for (size_t i = 0; i < n; i++)                                                         \
                y[i] = (Y)((double)base[i] + a * ((double)rate[i] - (double)rate0[i]));            \
        else                                                                                       \
            for (size_t i = 0; i < n; i++)                                                         \
                y[i] = (Y)((double)base[i] + a * (double)rate[i]);                                 \
    }
COMBINE(combine_double_double, double, double)
COMBINE(combine_double_float, double, float)
COMBINE(combine_float_double, float, double)
COMBINE(combine_float_float, float, float)

/* Where particle `first` of component k stands. */
static void *at(const struct column *c, uint32_t k, size_t first)
{
    return (char *)c->data + (k * c->plane + first) * c->size;
}

/* A chunk of a column. */
struct part {
    const struct particles *p;
    uint32_t k; /* component */
    size_t first, n;
};

static void combine(const struct part *q, int y, int base, double a, int rate, int rate0)
{
    const struct column *cy = &q->p->column[y], *cb = &q->p->column[base],
                        *cr = &q->p->column[rate];
    const struct column *c0 = rate0 < 0 ? NULL : &q->p->column[rate0];
    void *to = at(cy, q->k, q->first);
    const void *from = at(cb, q->k, q->first), *r = at(cr, q->k, q->first);
    const void *r0 = c0 ? at(c0, q->k, q->first) : NULL;
    if (cy->size == sizeof(double) && cr->size == sizeof(double))
        combine_double_double(to, from, a, r, r0, q->n);
    else if (cy->size == sizeof(double))
        combine_double_float(to, from, a, r, r0, q->n);
    else if (cr->size == sizeof(double))
        combine_float_double(to, from, a, r, r0, q->n);
    else
        combine_float_float(to, from, a, r, r0, q->n);
}

static void copy(const struct part *q, int to, int from)
{
    const struct column *c = &q->p->column[from];
    memcpy(at(&q->p->column[to], q->k, q->first), at(c, q->k, q->first), q->n * c->size);
}

static void apply(const struct op *op, double step, const struct part *part, const struct rate *q)
{
    const bool drifts = q->kind == SPH_DRIFT;
    const double dt = op->a * step;
    switch (op->kind) {
    case OP_KICK:
    case OP_DRIFT:
        if (drifts == (op->kind == OP_DRIFT))
            combine(part, q->property, q->property, dt, q->rate, -1);
        break;
    case OP_SAVE_STATE:
        copy(part, saved(part->p, q->property), q->property);
        break;
    case OP_SAVE_RATES:
        if (!drifts)
            copy(part, saved(part->p, q->rate), q->rate);
        break;
    case OP_CORRECT:
        if (!drifts)
            combine(part, q->property, q->property, dt, q->rate, saved(part->p, q->rate));
        break;
    case OP_FINISH_DRIFT:
    case OP_FINISH_KICK:
        if (drifts == (op->kind == OP_FINISH_DRIFT))
            combine(part, q->property, saved(part->p, q->property), dt, q->rate, -1);
        break;
    case OP_EVALUATE:
        break;
    }
}

/* Operations [from, to), none of them an evaluation, on the chunk at `first`. */
static void advance_chunk(const struct run *r, size_t from, size_t to, const struct plan_array *a,
                          size_t first)
{
    struct part part = {.p = &a->p, .first = first};
    part.n = a->p.n - first < CHUNK ? a->p.n - first : CHUNK;
    for (size_t k = from; k < to; k++)
        for (size_t q = 0; q < a->n_rate; q++)
            for (part.k = 0; part.k < a->p.column[a->rate[q].property].ncomp; part.k++)
                apply(&r->plan->integrator->op[k], r->dt, &part, &a->rate[q]);
}

static void advance(struct run *r, size_t from, size_t to)
{
    const double begin = omp_get_wtime();
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        const long n = (long)pa->p.n;
#pragma omp parallel for schedule(static) num_threads(r->threads) if (n > PARALLEL_FROM)
        for (long first = 0; first < n; first += CHUNK)
            advance_chunk(r, from, to, pa, (size_t)first);
        for (size_t q = 0; q < pa->n_rate; q++)
            run_changed(r, a, pa->rate[q].property);
    }
    r->lists_suspect = true;
    r->cost.integrate += omp_get_wtime() - begin;
}

int run_advance(struct run *r, struct error *e)
{
    const struct integrator *table = r->plan->integrator;
    const double begin = r->time;
    for (size_t k = 0, end; k < table->n_op; k = end) {
        for (end = k; end < table->n_op && table->op[end].kind != OP_EVALUATE;)
            end++;
        if (end > k)
            advance(r, k, end);
        if (end == table->n_op)
            break;
        r->time = begin + table->op[end].a * r->dt;
        if (run_passes(r, MOMENT_EVALUATE, e))
            return -1;
        end++;
    }
    r->time = begin + r->dt;
    return run_passes(r, MOMENT_FINISH, e) ? -1 : run_population(r, e);
}
