/* run/profiles.c -- means over bins of a coordinate. Reads particles, touches nothing. */
#include "plan/measured.h"
#include "run/region.h"
#include "run/report.h"
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

/* One array's part of the sums; with `squares`, once these are means, of the sums of squares about
 * them. */
static void add_array(const struct scene_profile *p, const struct plan_array *a,
                      const struct measured *m, const bool *inside, bool squares, double *row,
                      double *volume)
{
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
        double *to = row + b * width;
        for (size_t k = 0; k < n_of; k++) {
            const double f = measured_value(all, &m[k], &p->sample.about, i, x, 0);
            if (squares)
                to[2 * k + 1] += v * (f - to[2 * k]) * (f - to[2 * k]);
            else
                to[2 * k] += v * f;
        }
        if (!squares) {
            to[2 * n_of] += 1.0;
            volume[b] += v;
        }
    }
}

static void divide(const struct scene_profile *p, bool squares, const double *volume, double *row)
{
    const size_t width = 2 * p->sample.n_of + 1;
    for (size_t b = 0; b < p->bins; b++)
        for (size_t k = 0; k < p->sample.n_of; k++) {
            double *to = row + b * width + 2 * k + (squares ? 1 : 0);
            *to = volume[b] > 0.0 ? *to / volume[b] : NAN;
            *to = squares ? sqrt(*to) : *to;
        }
}

static int add_named(const struct run *r, const struct scene_profile *p, const char *name,
                     bool squares, double *row, double *volume, struct error *e)
{
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
        add_array(p, a, m, inside, squares, row, volume);
    free(m);
    free(inside);
    return status;
}

int profile_bins(const struct run *r, const struct scene_profile *p, double *row, struct error *e)
{
    double *volume = calloc(p->bins, sizeof *volume);
    int status = volume ? 0 : error_memory(e, "a profile", p->bins * sizeof *volume);
    memset(row, 0, p->bins * (2 * p->sample.n_of + 1) * sizeof *row);
    for (int squares = 0; squares < 2 && !status; squares++) {
        for (size_t a = 0; a < p->sample.n_array && !status; a++)
            status = add_named(r, p, p->sample.array[a], squares, row, volume, e);
        if (!status)
            divide(p, squares, volume, row);
    }
    free(volume);
    return status;
}
