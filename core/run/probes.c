/* run/probes.c -- the numbers that a scene asks for of all its particles. Reads them, touches nothing. */
#include "plan/measured.h"
#include "run/domain.h"
#include "run/region.h"
#include "run/report.h"
#include "run/sums.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHELLS_MOST 1e7
/* Exact sums are large: so many shells at a time. */
#define SHELLS_EXACT 10000

/* An array's particles, and what is asked of them. */
struct probed {
    const struct run *r;
    const struct plan_array *a;
    const struct scene_probe *p;
    struct measured m;
    const bool *inside;
};

static double value_of(const struct probed *q, size_t i)
{
    double x[3];
    measured_place(&q->a->p, q->a->position, i, x);
    return measured_value(&q->a->p, &q->m, &q->p->sample.about, i, x, 0);
}

static double radius(const struct probed *q, size_t i)
{
    double x[3];
    measured_place(&q->a->p, q->a->position, i, x);
    return scene_radius(&q->p->sample.about, q->a->p.dim, x);
}

/* Sums of the values in shells [low, high) of all ranks, then how many there are. */
static int add_shells(const struct probed *q, size_t low, size_t high, struct sums *sum,
                      struct error *e)
{
    for (size_t i = 0; i < q->a->p.n; i++) {
        const double at = radius(q, i) / q->p->shell;
        if (!q->inside[i] || !(at < (double)high) || (size_t)at < low)
            continue;
        sums_add(sum, (size_t)at - low, value_of(q, i));
        sums_add(sum, high - low + (size_t)at - low, 1.0);
    }
    return sums_share(sum, q->r, e);
}

/* Of the shells outside those that are looked at, the last with a particle. */
struct outer {
    double mean, r;
};

/* From outside inwards; NaN: not among these. */
static double find_level(const struct probed *q, const struct sums *sum, size_t low, size_t n,
                         struct outer *outer)
{
    const struct scene_probe *p = q->p;
    for (size_t k = n; k-- > 0;) {
        const double count = sum->value[n + k];
        if (count == 0.0)
            continue;
        const double mean = sum->value[k] / count, middle = ((double)(low + k) + 0.5) * p->shell;
        if (mean >= p->level)
            return isnan(outer->mean)
                       ? middle
                       : middle + (outer->r - middle) * (mean - p->level) / (mean - outer->mean);
        *outer = (struct outer){mean, middle};
    }
    return NAN;
}

/* The radius at which the shells' means reach the level, between two shells' middles. */
static int crossing(const struct probed *q, double *out, struct error *e)
{
    static const uint32_t op = SPH_REDUCE_MAX;
    const struct scene_probe *p = q->p;
    struct outer outer = {NAN, NAN};
    double far = 0.0;
    for (size_t i = 0; i < q->a->p.n; i++)
        far = q->inside[i] ? fmax(far, radius(q, i)) : far;
    if (run_share_numbers(q->r, &far, &op, 1, e))
        return -1;
    if (!(far / p->shell < SHELLS_MOST))
        return error_set(
            e, EXIT_RUN,
            "probe \"%s\": shells of width %g up to a particle at r = %g are too many; at most "
            "%.0f are possible",
            p->name, p->shell, far, SHELLS_MOST);
    const size_t n = (size_t)(far / p->shell) + 1, most = q->r->plan->strict ? SHELLS_EXACT : n;
    *out = NAN;
    for (size_t high = n, low; high > 0 && isnan(*out); high = low) {
        struct sums sum;
        low = high > most ? high - most : 0;
        int status = sums_open(&sum, q->r, 2 * (high - low), e);
        if (!status)
            status = add_shells(q, low, high, &sum, e);
        if (!status)
            *out = find_level(q, &sum, low, high - low, &outer);
        sums_close(&sum);
        if (status)
            return -1;
    }
    return 0;
}

static int number(const struct probed *q, double *out, struct error *e)
{
    const enum probe_kind kind = q->p->kind;
    const uint32_t op = kind == PROBE_MIN ? SPH_REDUCE_MIN : SPH_REDUCE_MAX;
    double extreme = kind == PROBE_MIN ? INFINITY : -INFINITY;
    uint64_t n = 0;
    struct sums sum;
    int status = sums_open(&sum, q->r, 1, e);
    for (size_t i = 0; !status && i < q->a->p.n; i++) {
        if (!q->inside[i])
            continue;
        const double value = value_of(q, i);
        if (kind == PROBE_MIN || kind == PROBE_MAX)
            extreme = kind == PROBE_MIN ? fmin(extreme, value) : fmax(extreme, value);
        else
            sums_add(&sum, 0, value);
        n++;
    }
    if (!status)
        status = sums_share(&sum, q->r, e) || run_share_count(q->r, &n, e) ||
                         run_share_numbers(q->r, &extreme, &op, 1, e)
                     ? -1
                     : 0;
    if (!status && kind != PROBE_MIN && kind != PROBE_MAX)
        *out = kind == PROBE_SUM ? sum.value[0] : n ? sum.value[0] / (double)n : NAN;
    else if (!status) /* a zero has no sign where bits may not depend on who comes first */
        *out = n == 0 ? NAN : q->r->plan->strict ? extreme + 0.0 : extreme;
    sums_close(&sum);
    return status;
}

int probe_take(const struct run *r, size_t index, double *out, struct error *e)
{
    const struct scene_probe *p = &r->plan->scene->probe[index];
    struct probed q = {.r = r, .p = p};
    bool missing;
    *out = NAN;
    for (size_t k = 0; k < r->plan->n_array; k++)
        if (strcmp(r->plan->array[k].p.name, p->array) == 0)
            q.a = &r->plan->array[k];
    if (!q.a || measured_find(&q.a->p, p->of, &q.m, &missing))
        return 0;
    bool *inside = calloc(q.a->p.n + 1, sizeof *inside);
    if (!inside)
        return error_memory(e, "a probe", q.a->p.n);
    q.inside = inside;
    int status = region_select(q.a, p->where, inside, e);
    if (!status)
        status = (p->kind == PROBE_CROSSING ? crossing : number)(&q, out, e);
    free(inside);
    return status;
}
