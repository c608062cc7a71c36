/* run/advance.c -- one step of the integrator's table, on the columns that the plan's rate table names. */
#include "run/run.h"
#include <omp.h>
#include <stdio.h>

/* Fewer elements than this are done before a second thread has woken. */
#define PARALLEL_FROM 50000

static double *plane(const struct particles *p, int column, uint32_t c)
{
    return (double *)p->column[column].data + (size_t)c * p->column[column].plane;
}

static int saved(const struct particles *p, int column)
{
    char name[128];
    snprintf(name, sizeof name, "%s.0", p->column[column].name);
    return particles_find(p, name);
}

/* y = base + a * (r - r0); base is y itself or what was saved of it, r0 may be NULL. */
static void combine(const struct run *r, double *y, const double *base, double a,
                    const double *rate, const double *rate0, size_t n)
{
    const long end = (long)n;
    if (rate0) {
#pragma omp parallel for num_threads(r->threads) if (end > PARALLEL_FROM)
        for (long i = 0; i < end; i++)
            y[i] = base[i] + a * (rate[i] - rate0[i]);
    } else {
#pragma omp parallel for num_threads(r->threads) if (end > PARALLEL_FROM)
        for (long i = 0; i < end; i++)
            y[i] = base[i] + a * rate[i];
    }
}

static void copy(double *to, const double *from, size_t n)
{
    for (size_t i = 0; i < n; i++)
        to[i] = from[i];
}

static void apply(const struct run *r, const struct op *op, const struct plan_array *a,
                  const struct rate *q)
{
    const struct particles *p = &a->p;
    bool drifts = q->kind == SPH_DRIFT;
    double dt = op->a * r->dt;
    for (uint32_t c = 0; c < p->column[q->property].ncomp; c++) {
        double *y = plane(p, q->property, c), *rate = plane(p, q->rate, c);
        switch (op->kind) {
        case OP_KICK:
        case OP_DRIFT:
            if (drifts == (op->kind == OP_DRIFT))
                combine(r, y, y, dt, rate, NULL, p->n);
            break;
        case OP_SAVE_STATE:
            copy(plane(p, saved(p, q->property), c), y, p->n);
            break;
        case OP_SAVE_RATES:
            if (!drifts)
                copy(plane(p, saved(p, q->rate), c), rate, p->n);
            break;
        case OP_CORRECT:
            if (!drifts)
                combine(r, y, y, dt, rate, plane(p, saved(p, q->rate), c), p->n);
            break;
        case OP_FINISH_DRIFT:
        case OP_FINISH_KICK:
            if (drifts == (op->kind == OP_FINISH_DRIFT))
                combine(r, y, plane(p, saved(p, q->property), c), dt, rate, NULL, p->n);
            break;
        case OP_EVALUATE:
            break;
        }
    }
}

int run_advance(struct run *r, struct error *e)
{
    const double begin = r->time;
    for (size_t k = 0; k < r->plan->integrator->n_op; k++) {
        const struct op *op = &r->plan->integrator->op[k];
        if (op->kind == OP_EVALUATE) {
            r->time = begin + op->a * r->dt;
            if (run_passes(r, MOMENT_EVALUATE, e))
                return -1;
            continue;
        }
        double t = omp_get_wtime();
        for (size_t a = 0; a < r->plan->n_array; a++) {
            struct plan_array *pa = &r->plan->array[a];
            for (size_t q = 0; q < pa->n_rate; q++) {
                apply(r, op, pa, &pa->rate[q]);
                r->stale[a][pa->rate[q].property] = pa->p.n_ghost > 0;
            }
        }
        r->lists_suspect = true;
        r->cost.integrate += omp_get_wtime() - t;
    }
    r->time = begin + r->dt;
    return run_passes(r, MOMENT_FINISH, e) ? -1 : run_population(r, e);
}
