/* run/compare.c -- error norms against the exact solutions and the tables that the scene names. */
#include "base/text.h"
#include "plan/measured.h"
#include "run/domain.h"
#include "run/norms.h"
#include "run/region.h"
#include "run/report.h"
#include <sph/tables.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Columns for the exact solution's batch: the array's own where it reads doubles, fresh ones where it
 * writes, or reads what is held in floats. */
static int exact_columns(const struct plan_array *a, const sph_item *item, sph_column *column,
                         struct error *e)
{
    for (uint32_t k = 0; k < item->props.count; k++) {
        const sph_prop *prop = list_at(&item->props, k);
        const bool reads = !(prop->access & SPH_DST_WRITE);
        const int c = particles_find(&a->p, prop->name);
        if (reads && c < 0)
            return error_set(e, EXIT_USAGE, "%s needs \"%s\", which array \"%s\" has not",
                             item->name, prop->name, a->p.name);
        if (reads && a->p.column[c].size == property_size(prop->type)) {
            column[k] = particles_column(&a->p, c);
            continue;
        }
        size_t plane = (a->p.n + PARTICLES_PAD) / 8 * 8;
        uint32_t ncomp = property_ncomp(prop->type, a->p.dim);
        void *data = aligned_alloc(64, plane * ncomp * sizeof(double));
        if (!data)
            return error_memory(e, "an exact solution", plane * ncomp * sizeof(double));
        memset(data, 0, plane * ncomp * sizeof(double));
        column[k] = (sph_column){data, plane, prop->type, ncomp};
        for (uint32_t q = 0; reads && q < ncomp; q++)
            for (size_t i = 0; i < a->p.n; i++)
                ((double *)data)[q * plane + i] = column_get(&a->p.column[c], q, i);
    }
    return 0;
}

static int add_error(const struct run *r, struct summary_error **out, size_t *n,
                     const struct plan_array *a, const char *field, const char *reference,
                     const struct deviation *d, uint64_t outside, struct error *e)
{
    struct summary_error *bigger = realloc(*out, (*n + 1) * sizeof *bigger);
    if (!bigger)
        return error_memory(e, "errors", (*n + 1) * sizeof *bigger);
    *out = bigger;
    bigger[*n] = (struct summary_error){
        .reference = reference, .array = a->p.name, .outside = outside, .time = NAN};
    bigger[*n].field = text_format("%s.%s", a->p.name, field);
    if (!bigger[*n].field)
        return error_memory(e, "errors", 1);
    *n += 1;
    return norms_of(r, a, d, &bigger[*n - 1], e);
}

/* -- Exact solutions --------------------------------------------------------------------------- */

/* Of all components of a column, or of one (k). */
static void deviate(const struct plan_array *a, const struct column *f, const sph_column *exact,
                    const struct measured *m, struct deviation *d)
{
    const bool one = m && m->kind == MEASURED_COMPONENT;
    for (size_t i = 0; i < a->p.n; i++) {
        d->d2[i] = d->s2[i] = 0.0;
        for (uint32_t c = one ? m->k : 0; c < (one ? m->k + 1 : f->ncomp); c++) {
            const double star = ((const double *)exact->data)[c * exact->plane + i];
            const double difference = column_get(f, c, i) - star;
            d->d2[i] += difference * difference;
            d->s2[i] += star * star;
        }
    }
}

/* The fields that the scene asks for of one property that the solution gives; all of it if it asks for none. */
static int add_exact(const struct run *r, const struct scene_compare *c, const struct plan_array *a,
                     int column, const sph_column *exact, struct deviation *d,
                     struct summary_error **out, size_t *n, struct error *e)
{
    struct measured m;
    bool missing;
    const struct column *f = &a->p.column[column];
    if (c->n_fields == 0) {
        deviate(a, f, exact, NULL, d);
        return add_error(r, out, n, a, f->name, c->exact, d, 0, e);
    }
    for (size_t k = 0; k < c->n_fields; k++) {
        if (measured_find(&a->p, c->fields[k], &m, &missing) || m.column != column)
            continue;
        deviate(a, f, exact, &m, d);
        if (add_error(r, out, n, a, c->fields[k], c->exact, d, 0, e))
            return -1;
    }
    return 0;
}

int exact_run(const struct run *r, const struct use *use, const sph_column *column, size_t n,
              struct error *e)
{
    sph_batch b = use_batch(r->plan, use, column, use->item->props.count, n);
    char why[512];
    b.time = r->time;
    b.step = r->step;
    const sph_status s = entry_exact(use->entry)->run(&b);
    if (s == SPH_OK)
        return 0;
    registry_reason(r->plan->registry, s, why, sizeof why);
    return error_set(e, EXIT_RUN, "exact solution \"%s\": %s", use->item->name, why);
}

static int compare_exact(const struct run *r, size_t index, const struct plan_array *a,
                         struct deviation *d, struct summary_error **out, size_t *n,
                         struct error *e)
{
    const struct scene_compare *c = &r->plan->scene->compare[index];
    const struct use *use = &r->plan->exact[index];
    const uint32_t count = use->item->props.count;
    sph_column *column = calloc(count + 1, sizeof *column);
    if (!column)
        return error_memory(e, "a comparison", a->p.n);
    int status = exact_columns(a, use->item, column, e);
    if (!status && a->p.n)
        status = exact_run(r, use, column, a->p.n, e);
    for (uint32_t k = 0; k < count; k++) {
        const sph_prop *prop = list_at(&use->item->props, k);
        const int f = particles_find(&a->p, prop->name);
        if ((prop->access & SPH_DST_WRITE) && !status && f >= 0)
            status = add_exact(r, c, a, f, &column[k], d, out, n, e);
        if (f < 0 || column[k].data != a->p.column[f].data)
            free(column[k].data);
    }
    free(column);
    return status;
}

/* -- Tables ------------------------------------------------------------------------------------ */

/* Particles beyond the table's ends do not count; how many are there. */
static uint64_t leave_outside(const struct plan_array *a, const struct scene_compare *c,
                              const struct table_column *along, size_t rows, double *at,
                              bool *inside)
{
    uint64_t outside = 0;
    for (size_t i = 0; i < a->p.n; i++) {
        double x[3];
        measured_place(&a->p, a->position, i, x);
        at[i] = c->along == ALONG_R ? scene_radius(&c->about, a->p.dim, x) : x[c->along];
        const bool within = at[i] >= along->value[0] && at[i] <= along->value[rows - 1];
        outside += inside[i] && !within;
        inside[i] = inside[i] && within;
    }
    return outside;
}

static int add_table(const struct run *r, const struct scene_compare *c, const struct plan_array *a,
                     const struct table *t, const double *at, uint64_t outside, const char *field,
                     const char *column, struct deviation *d, struct summary_error **out, size_t *n,
                     struct error *e)
{
    struct measured m;
    bool missing;
    const int value = table_find(t, column);
    const sph_table rows = {.n_rows = t->n};
    if (value < 0 || measured_find(&a->p, field, &m, &missing))
        return 0;
    for (size_t i = 0; i < a->p.n; i++) {
        double x[3];
        measured_place(&a->p, a->position, i, x);
        const double star = sph_table_linear(&rows, t->column[plan_table_along(t, c->along)].value,
                                             t->column[value].value, at[i]);
        const double difference = measured_value(&a->p, &m, &c->about, i, x, 0) - star;
        d->d2[i] = difference * difference;
        d->s2[i] = star * star;
    }
    return add_error(r, out, n, a, field, plan_table_source(c->table), d, outside, e);
}

static int compare_table(const struct run *r, size_t index, const struct plan_array *a,
                         struct deviation *d, struct summary_error **out, size_t *n,
                         struct error *e)
{
    const struct scene_compare *c = &r->plan->scene->compare[index];
    const struct table *t = &r->plan->compare_table[index];
    const size_t along = plan_table_along(t, c->along);
    double *at = malloc((a->p.n + 1) * sizeof *at);
    if (!at)
        return error_memory(e, "a comparison", a->p.n * sizeof *at);
    uint64_t outside = leave_outside(a, c, &t->column[along], t->n, at, d->inside);
    int status = run_share_count(r, &outside, e);
    for (size_t k = 0; k < c->n_fields && !status; k++)
        status = add_table(r, c, a, t, at, outside, c->fields[k], c->columns[k], d, out, n, e);
    for (size_t k = 0; k < t->n_column && !c->n_fields && !status; k++)
        if (k != along)
            status = add_table(r, c, a, t, at, outside, t->column[k].name, t->column[k].name, d,
                               out, n, e);
    free(at);
    return status;
}

/* -- Either ------------------------------------------------------------------------------------ */

int compare_take(const struct run *r, size_t index, struct summary_error **out, size_t *n,
                 struct error *e)
{
    const struct plan *plan = r->plan;
    const struct scene_compare *c = &plan->scene->compare[index];
    const struct plan_array *a = NULL;
    struct deviation d = {0};
    for (size_t k = 0; k < plan->n_array; k++)
        if (strcmp(plan->array[k].p.name, c->array) == 0)
            a = &plan->array[k];
    uint64_t there = a ? a->p.n : 0;
    if (run_share_count(r, &there, e))
        return -1;
    if (there == 0)
        return 0;
    int status = deviation_init(&d, a->p.n, e);
    if (!status)
        status = region_select(a, c->where, d.inside, e);
    if (!status)
        status = (c->table ? compare_table : compare_exact)(r, index, a, &d, out, n, e);
    deviation_fini(&d);
    return status;
}

void compare_free(struct summary_error *errors, size_t n)
{
    for (size_t i = 0; i < n; i++)
        free((void *)(uintptr_t)errors[i].field);
    free(errors);
}
