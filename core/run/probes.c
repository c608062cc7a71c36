/* run/probes.c -- the numbers that a scene asks for of all its particles. Reads them, touches nothing. */
#include "plan/measured.h"
#include "run/region.h"
#include "run/report.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHELLS_MOST 1e7

/* An array's particles, and what is asked of them. */
struct probed {
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

/* From outside inwards: the radius at which the shells' means reach the level, between two shells' middles. */
static double crossing(const struct probed *q, struct error *e)
{
    const struct scene_probe *p = q->p;
    const size_t particles = q->a->p.n;
    double far = 0.0;
    for (size_t i = 0; i < particles; i++)
        far = q->inside[i] ? fmax(far, radius(q, i)) : far;
    if (!(far / p->shell < SHELLS_MOST)) {
        error_set(
            e, EXIT_RUN,
            "probe \"%s\": shells of width %g up to a particle at r = %g are too many; at most "
            "%.0f are possible",
            p->name, p->shell, far, SHELLS_MOST);
        return NAN;
    }
    const size_t n = (size_t)(far / p->shell) + 1;
    double *sum = calloc(2 * n, sizeof *sum), *count = sum ? sum + n : NULL, found = NAN;
    if (!sum) {
        error_memory(e, "shells", 2 * n * sizeof *sum);
        return NAN;
    }
    for (size_t i = 0; i < particles; i++) {
        const double at = radius(q, i) / p->shell;
        if (!q->inside[i] || !(at < (double)n))
            continue;
        const size_t k = (size_t)at;
        sum[k] += value_of(q, i);
        count[k] += 1.0;
    }
    double outer = NAN, outer_r = NAN;
    for (size_t k = n; k-- > 0;) {
        if (count[k] == 0.0)
            continue;
        double mean = sum[k] / count[k], middle = ((double)k + 0.5) * p->shell;
        if (mean >= p->level) {
            found = isnan(outer) ? middle
                                 : middle + (outer_r - middle) * (mean - p->level) / (mean - outer);
            break;
        }
        outer = mean;
        outer_r = middle;
    }
    free(sum);
    return found;
}

static double number(const struct probed *q)
{
    const enum probe_kind kind = q->p->kind;
    double out = kind == PROBE_MIN ? INFINITY : kind == PROBE_MAX ? -INFINITY : 0.0;
    double n = 0.0;
    for (size_t i = 0; i < q->a->p.n; i++) {
        if (!q->inside[i])
            continue;
        const double value = value_of(q, i);
        out = kind == PROBE_MIN   ? fmin(out, value)
              : kind == PROBE_MAX ? fmax(out, value)
                                  : out + value;
        n += 1.0;
    }
    if (kind == PROBE_SUM)
        return out;
    return n == 0.0 ? NAN : kind == PROBE_MEAN ? out / n : out;
}

int probe_take(const struct run *r, size_t index, double *out, struct error *e)
{
    const struct scene_probe *p = &r->plan->scene->probe[index];
    struct probed q = {.p = p};
    struct error inner = {0};
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
        *out = p->kind == PROBE_CROSSING ? crossing(&q, &inner) : number(&q);
    free(inside);
    return !status && inner.text[0]
               ? error_set(e, (enum exit_code)inner.exit_code, "%s", inner.text)
               : status;
}
