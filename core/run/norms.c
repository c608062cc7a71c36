/* run/norms.c -- norms over particles and over time. Reads, touches nothing. */
#include "run/norms.h"
#include "run/domain.h"
#include "run/foremost.h"
#include "run/sums.h"
#include <math.h>
#include <stdlib.h>

int deviation_init(struct deviation *d, size_t n, struct error *e)
{
    d->inside = calloc(n + 1, sizeof *d->inside);
    d->d2 = calloc(n + 1, sizeof *d->d2);
    d->s2 = calloc(n + 1, sizeof *d->s2);
    return d->inside && d->d2 && d->s2 ? 0 : error_memory(e, "a comparison", n * sizeof *d->d2);
}

void deviation_fini(struct deviation *d)
{
    free(d->inside);
    free(d->d2);
    free(d->s2);
    *d = (struct deviation){0};
}

enum { VOLUME, SCALE, SCALE2, L1, L2, SUMS };

/* Whether particle i is farther off than the worst so far. Of equals it is the first, or where bits may not depend
 * on how particles stand that of the smallest id. */
static bool is_worse(const struct run *r, const struct plan_array *a, const double *d2, size_t i,
                     size_t worst)
{
    const int64_t *id = a->p.column[a->id].data;
    if (worst == SIZE_MAX || d2[i] > d2[worst])
        return true;
    if (!r->plan->strict)
        return false;
    if (isnan(d2[worst]) && !isnan(d2[i]))
        return true;
    return !isnan(d2[i]) == !isnan(d2[worst]) && !(d2[i] < d2[worst]) && id[i] < id[worst];
}

/* Where the largest of all is. */
static int find_worst(const struct run *r, const struct plan_array *a, const struct deviation *d,
                      size_t worst, double at[3], struct error *e)
{
    const bool any = worst != SIZE_MAX;
    struct foremost f = {.key = NAN};
    if (any) {
        f.key = isnan(d->d2[worst]) ? -1.0 : d->d2[worst];
        f.id = ((const int64_t *)a->p.column[a->id].data)[worst];
    }
    for (int c = 0; c < 3; c++)
        at[c] =
            any && c < a->p.dim ? column_get(&a->p.column[a->position], (uint32_t)c, worst) : NAN;
    return foremost_find(r, &f, at, 3 * sizeof *at, e);
}

static int share(const struct run *r, const struct plan_array *a, const struct deviation *d,
                 size_t worst, struct sums *sum, struct summary_error *out, struct error *e)
{
    static const uint32_t op = SPH_REDUCE_MAX;
    if (sums_share(sum, r, e) || run_share_count(r, &out->n, e) ||
        run_share_numbers(r, &out->linf, &op, 1, e) || find_worst(r, a, d, worst, out->linf_at, e))
        return -1;
    out->l1 = sum->value[L1] / sum->value[VOLUME];
    out->l1_rel = sum->value[L1] / sum->value[SCALE];
    out->l2 = sqrt(sum->value[L2] / sum->value[VOLUME]);
    out->l2_rel = sqrt(sum->value[L2] / sum->value[SCALE2]);
    if (out->n == 0)
        out->linf = NAN;
    return 0;
}

int norms_of(const struct run *r, const struct plan_array *a, const struct deviation *d,
             struct summary_error *out, struct error *e)
{
    const int rho = particles_find(&a->p, "rho");
    size_t worst = SIZE_MAX;
    struct sums sum;
    int status = sums_open(&sum, r, SUMS, e);
    out->linf = 0.0;
    for (size_t i = 0; !status && i < a->p.n; i++) {
        if (!d->inside[i])
            continue;
        const double density = rho < 0 ? 1.0 : column_get(&a->p.column[rho], 0, i);
        const double v = rho < 0 ? 1.0 : column_get(&a->p.column[a->mass], 0, i) / density;
        sums_add(&sum, VOLUME, v);
        sums_add(&sum, SCALE, v * sqrt(d->s2[i]));
        sums_add(&sum, SCALE2, v * d->s2[i]);
        sums_add(&sum, L1, v * sqrt(d->d2[i]));
        sums_add(&sum, L2, v * d->d2[i]);
        out->linf = fmax(out->linf, sqrt(d->d2[i]));
        if (is_worse(r, a, d->d2, i, worst))
            worst = i;
        out->n++;
    }
    if (!status)
        status = share(r, a, d, worst, &sum, out, e);
    sums_close(&sum);
    return status;
}

/* -- Over time --------------------------------------------------------------------------------- */

static double time_of(const struct course *f, size_t i)
{
    return f->time[i] * f->scale_time;
}

/* At t, within the course, between rows *at and *at + 1, which only ever rise. */
static double value_at(const struct course *f, double t, size_t *at)
{
    while (*at + 2 < f->n && time_of(f, *at + 1) <= t)
        ++*at;
    const double t0 = time_of(f, *at), t1 = time_of(f, *at + 1);
    const double w = t >= t1 ? 1.0 : (t - t0) / (t1 - t0);
    const double a = f->value[*at], b = f->value[*at + 1];
    return f->scale * (w >= 1.0 ? b : w > 0.0 ? a + (b - a) * w : a);
}

/* The moments of both within the common time, rising, each once; the first and last are its ends. */
static size_t moments_of(const struct course *f, const struct course *g, double begin, double end,
                         double *t)
{
    size_t i = 0, k = 0, n = 0;
    t[n++] = begin;
    while (i < f->n || k < g->n) {
        const bool first = k == g->n || (i < f->n && time_of(f, i) <= time_of(g, k));
        const double next = first ? time_of(f, i++) : time_of(g, k++);
        if (next > t[n - 1] && next < end)
            t[n++] = next;
    }
    t[n++] = end;
    return n;
}

int course_compare(const struct course *f, const struct course *g, struct course_norms *out,
                   struct error *e)
{
    *out = (struct course_norms){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    if (f->n < 2 || g->n < 2)
        return 0;
    out->begin = fmax(time_of(f, 0), time_of(g, 0));
    out->end = fmin(time_of(f, f->n - 1), time_of(g, g->n - 1));
    if (!(out->begin < out->end))
        return 0;
    double *t = malloc((f->n + g->n + 2) * sizeof *t);
    if (!t)
        return error_memory(e, "a course in time", (f->n + g->n + 2) * sizeof *t);
    const size_t n = moments_of(f, g, out->begin, out->end, t);
    double span = 0.0, d1 = 0.0, d2 = 0.0, s1 = 0.0, s2 = 0.0, most = 0.0, d0 = NAN, r0 = NAN;
    size_t i = 0, k = 0;
    for (size_t q = 0; q < n; q++) {
        const double r = value_at(g, t[q], &k), d = value_at(f, t[q], &i) - r;
        if (q && !isnan(d) && !isnan(d0)) {
            const double half = 0.5 * (t[q] - t[q - 1]);
            span += 2.0 * half;
            d1 += half * (fabs(d) + fabs(d0));
            d2 += half * (d * d + d0 * d0);
            s1 += half * (fabs(r) + fabs(r0));
            s2 += half * (r * r + r0 * r0);
            most = fmax(most, fmax(fabs(d), fabs(d0)));
        }
        d0 = d;
        r0 = r;
    }
    free(t);
    if (!(span > 0.0))
        return 0;
    out->l1 = d1 / span;
    out->l1_rel = d1 / s1;
    out->l2 = sqrt(d2 / span);
    out->l2_rel = sqrt(d2 / s2);
    out->linf = most;
    return 0;
}
