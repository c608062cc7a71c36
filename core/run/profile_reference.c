/* run/profile_reference.c -- what a profile is held against: an exact solution or a table at the places of its
 * rows. Reads the plan, touches no particle of the run. */
#include "plan/measured.h"
#include "run/report.h"
#include <sph/tables.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void place_of(const struct scene_profile *p, size_t j, double x[3])
{
    memcpy(x, p->bins ? p->sample.about.center : p->sample.point + 3 * j, 3 * sizeof *x);
    if (!p->bins)
        return;
    const double middle = profile_middle(p, j);
    if (p->along == ALONG_R)
        x[p->sample.about.axis == 0 ? 1 : 0] += middle;
    else
        x[p->along] = middle;
}

static void from_table(const struct run *r, size_t index, size_t n, double *value)
{
    const struct scene_profile *p = &r->plan->scene->profile[index];
    const struct scene_compare *c = &p->reference;
    const struct table *t = &r->plan->profile_table[index];
    const double *along = t->column[plan_table_along(t, c->along)].value;
    const sph_table rows = {.n_rows = t->n};
    for (size_t j = 0; j < n; j++) {
        double x[3];
        place_of(p, j, x);
        const double at =
            c->along == ALONG_R ? scene_radius(&c->about, r->plan->dim, x) : x[c->along];
        for (size_t k = 0; k < p->sample.n_of; k++) {
            size_t column;
            if (plan_profile_gives(r->plan, index, k, &column) && at >= along[0] &&
                at <= along[t->n - 1])
                value[j * p->sample.n_of + k] =
                    sph_table_linear(&rows, along, t->column[column].value, at);
        }
    }
}

/* The places as an array of particles that has what the solution gives. */
static int places(const struct run *r, const struct use *use, const struct scene_profile *p,
                  size_t n, struct particles *out, struct error *e)
{
    if (particles_init(out, "reference", r->plan->dim, e))
        return -1;
    int status = 0;
    for (uint32_t q = 0; q < use->item->props.count && !status; q++) {
        const sph_prop *prop = list_at(&use->item->props, q);
        status = particles_add(out, prop->name, "", "", prop->type, e) < 0 ? -1 : 0;
    }
    if (!status)
        status = particles_resize(out, n, 0, e);
    const int position = status ? -1 : particles_find(out, "x");
    for (size_t j = 0; j < n && position >= 0; j++) {
        double x[3];
        place_of(p, j, x);
        for (uint32_t c = 0; c < (uint32_t)r->plan->dim; c++)
            column_set(&out->column[position], c, j, x[c]);
    }
    return status;
}

static int from_exact(const struct run *r, size_t index, size_t n, double *value, struct error *e)
{
    const struct scene_profile *p = &r->plan->scene->profile[index];
    const struct use *use = &r->plan->profile_exact[index];
    const uint32_t count = use->item->props.count;
    struct particles at = {0};
    sph_column *column = calloc(count + 1, sizeof *column);
    int status = column ? places(r, use, p, n, &at, e) : error_memory(e, "a profile", n);
    for (uint32_t q = 0; q < count && !status; q++) {
        const sph_prop *prop = list_at(&use->item->props, q);
        column[q] = particles_column(&at, particles_find(&at, prop->name));
    }
    if (!status)
        status = exact_run(r, use, column, n, e);
    for (size_t k = 0; k < p->sample.n_of && !status; k++) {
        struct measured m;
        bool missing;
        size_t unused;
        if (!plan_profile_gives(r->plan, index, k, &unused) ||
            measured_find(&at, p->sample.of[k], &m, &missing))
            continue;
        for (size_t j = 0; j < n; j++) {
            double x[3];
            place_of(p, j, x);
            value[j * p->sample.n_of + k] = measured_value(&at, &m, &p->sample.about, j, x, 0);
        }
    }
    particles_fini(&at);
    free(column);
    return status;
}

int profile_reference(const struct run *r, size_t index, size_t n, double *value, struct error *e)
{
    const struct scene_profile *p = &r->plan->scene->profile[index];
    for (size_t k = 0; k < n * p->sample.n_of; k++)
        value[k] = NAN;
    if (!p->reference.table)
        return from_exact(r, index, n, value, e);
    from_table(r, index, n, value);
    return 0;
}
