/* run/profiles.c -- means over bins of a coordinate. Reads particles, touches nothing. */
#include "plan/measured.h"
#include "run/region.h"
#include "run/report.h"
#include "run/sums.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A particle's bin, or p->bins if it is in none. */
static size_t bin_of(const struct scene_profile *p, int dim, const double x[3])
{
    const double at = p->along == ALONG_R ? scene_radius(&p->sample.about, dim, x) : x[p->along];
    const double q = (at - p->min) / (p->max - p->min) * (double)p->bins;
    if (!(q >= 0.0 && at <= p->max))
        return p->bins;
    return q < (double)p->bins ? (size_t)q : p->bins - 1;
}

/* Sums of one going through the particles, of each bin. First of V f, how many there are, and of V; then, with
 * means known, of the squares about them. */
struct binned {
    const struct run *r;
    const struct scene_profile *p;
    bool squares;
    double *row; /* [bins][2 n_of + 1]: see profile_bins */
    struct sums sum;
};

/* Of a bin: those of n_of properties, then these. */
enum { NUMBER, VOLUME, MORE };

static size_t place(const struct binned *q, size_t bin, size_t k)
{
    return bin * (q->p->sample.n_of + MORE) + k;
}

/* One array's part of the sums. */
static void add_array(struct binned *q, const struct plan_array *a, const struct measured *m,
                      const bool *inside)
{
    const struct scene_profile *p = q->p;
    const struct particles *all = &a->p;
    const size_t n_of = p->sample.n_of, width = 2 * n_of + 1;
    const int rho = particles_find(all, "rho");
    for (size_t i = 0; i < all->n; i++) {
        double x[3];
        measured_place(all, a->position, i, x);
        const size_t b = inside[i] ? bin_of(p, all->dim, x) : p->bins;
        const double density = column_get(&all->column[rho], 0, i);
        if (b == p->bins || !(density > 0.0))
            continue;
        const double v = column_get(&all->column[a->mass], 0, i) / density;
        for (size_t k = 0; k < n_of; k++) {
            const double f = measured_value(all, &m[k], &p->sample.about, i, x, 0);
            const double d = q->squares ? f - q->row[b * width + 2 * k] : 0.0;
            sums_add(&q->sum, place(q, b, k), q->squares ? v * d * d : v * f);
        }
        if (!q->squares)
            sums_add(&q->sum, place(q, b, n_of + NUMBER), 1.0);
        sums_add(&q->sum, place(q, b, n_of + VOLUME), v);
    }
}

static void divide(const struct binned *q)
{
    const size_t n_of = q->p->sample.n_of, width = 2 * n_of + 1;
    for (size_t b = 0; b < q->p->bins; b++) {
        const double *sum = q->sum.value + place(q, b, 0), volume = sum[n_of + VOLUME];
        double *to = q->row + b * width;
        for (size_t k = 0; k < n_of; k++) {
            const double mean = volume > 0.0 ? sum[k] / volume : NAN;
            to[2 * k + q->squares] = q->squares ? sqrt(mean) : mean;
        }
        if (!q->squares)
            to[2 * n_of] = sum[n_of + NUMBER];
    }
}

static int add_named(struct binned *q, const char *name, struct error *e)
{
    const struct run *r = q->r;
    const struct scene_profile *p = q->p;
    const struct plan_array *a = NULL;
    bool missing;
    for (size_t k = 0; k < r->plan->n_array; k++)
        if (strcmp(r->plan->array[k].p.name, name) == 0)
            a = &r->plan->array[k];
    struct measured *m = calloc(p->sample.n_of + 1, sizeof *m);
    bool *inside = calloc(a->p.n + 1, sizeof *inside);
    int status = m && inside ? 0 : error_memory(e, "a profile", a->p.n);
    for (size_t k = 0; k < p->sample.n_of && !status; k++)
        measured_find(&a->p, p->sample.of[k], &m[k], &missing);
    if (!status)
        status = region_select(a, p->where, inside, e);
    if (!status)
        add_array(q, a, m, inside);
    free(m);
    free(inside);
    return status;
}

int profile_bins(const struct run *r, const struct scene_profile *p, double *row, struct error *e)
{
    const size_t n = p->bins * (p->sample.n_of + MORE);
    int status = 0;
    for (int squares = 0; squares < 2 && !status; squares++) {
        struct binned q = {.r = r, .p = p, .squares = squares, .row = row};
        status = sums_open(&q.sum, r, n, e);
        for (size_t a = 0; a < p->sample.n_array && !status; a++)
            status = add_named(&q, p->sample.array[a], e);
        if (!status)
            status = sums_share(&q.sum, r, e);
        if (!status)
            divide(&q);
        sums_close(&q.sum);
    }
    return status;
}
