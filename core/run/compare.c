/* run/compare.c -- error norms against the exact solutions that the scene names. */
#include "base/text.h"
#include "run/region.h"
#include "run/report.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void norms(const struct plan_array *a, const struct column *f, const sph_column *exact,
                  const bool *inside, struct summary_error *out)
{
    int rho = particles_find(&a->p, "rho");
    double volume = 0.0, scale = 0.0;
    for (size_t i = 0; i < a->p.n; i++) {
        if (!inside[i])
            continue;
        double density = rho < 0 ? 1.0 : region_value(&a->p.column[rho], 0, i);
        double v = rho < 0 ? 1.0 : region_value(&a->p.column[a->mass], 0, i) / density;
        double d2 = 0.0, s2 = 0.0;
        for (uint32_t c = 0; c < f->ncomp; c++) {
            double star = ((const double *)exact->data)[c * exact->plane + i];
            d2 += (region_value(f, c, i) - star) * (region_value(f, c, i) - star);
            s2 += star * star;
        }
        volume += v;
        scale += v * sqrt(s2);
        out->l1 += v * sqrt(d2);
        out->l2 += v * d2;
        out->linf = fmax(out->linf, sqrt(d2));
        out->n++;
    }
    out->l1_rel = out->l1 / scale;
    out->l1 /= volume;
    out->l2 = sqrt(out->l2 / volume);
}

static bool wanted(const struct scene_compare *c, const char *name)
{
    for (size_t k = 0; k < c->n_fields; k++)
        if (strcmp(c->fields[k], name) == 0)
            return true;
    return c->n_fields == 0;
}

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

static int add_error(struct summary_error **out, size_t *n, const struct plan_array *a,
                     const struct column *f, const char *reference, const sph_column *exact,
                     const bool *inside, struct error *e)
{
    struct summary_error *bigger = realloc(*out, (*n + 1) * sizeof *bigger);
    if (!bigger)
        return error_memory(e, "errors", (*n + 1) * sizeof *bigger);
    *out = bigger;
    bigger[*n] = (struct summary_error){.reference = reference};
    bigger[*n].field = text_format("%s.%s", a->p.name, f->name);
    if (!bigger[*n].field)
        return error_memory(e, "errors", 1);
    norms(a, f, exact, inside, &bigger[*n]);
    *n += 1;
    return 0;
}

static int compare(const struct run *r, size_t index, struct summary_error **out, size_t *n,
                   struct error *e)
{
    const struct plan *plan = r->plan;
    const struct scene_compare *c = &plan->scene->compare[index];
    const struct use *use = &plan->exact[index];
    const struct plan_array *a = NULL;
    for (size_t k = 0; k < plan->n_array; k++)
        if (strcmp(plan->array[k].p.name, c->array) == 0)
            a = &plan->array[k];
    if (!a || a->p.n == 0)
        return 0;
    uint32_t count = use->item->props.count;
    sph_column *column = calloc(count + 1, sizeof *column);
    bool *inside = calloc(a->p.n, sizeof *inside);
    int status = column && inside ? 0 : error_memory(e, "a comparison", a->p.n);
    if (!status)
        status = exact_columns(a, use->item, column, e) || region_select(a, c->where, inside, e)
                     ? -1
                     : 0;
    if (!status) {
        sph_batch b = use_batch(plan, use, column, count, a->p.n);
        b.time = r->time;
        b.step = r->step;
        sph_status s = entry_exact(use->entry)->run(&b);
        char why[512];
        if (s != SPH_OK) {
            registry_reason(plan->registry, s, why, sizeof why);
            status = error_set(e, EXIT_RUN, "exact solution \"%s\": %s", c->exact, why);
        }
    }
    for (uint32_t k = 0; column && k < count; k++) {
        const sph_prop *prop = list_at(&use->item->props, k);
        const int f = particles_find(&a->p, prop->name);
        if ((prop->access & SPH_DST_WRITE) && !status && f >= 0 && wanted(c, prop->name))
            status = add_error(out, n, a, &a->p.column[f], c->exact, &column[k], inside, e);
        if (f < 0 || column[k].data != a->p.column[f].data)
            free(column[k].data);
    }
    free(column);
    free(inside);
    return status;
}

int report_errors(const struct run *r, struct summary_error **out, size_t *n, struct error *e)
{
    *out = NULL;
    *n = 0;
    for (size_t i = 0; i < r->plan->scene->n_compare; i++)
        if (compare(r, i, out, n, e))
            return -1;
    return 0;
}

void report_errors_free(struct summary_error *errors, size_t n)
{
    for (size_t i = 0; i < n; i++)
        free((void *)(uintptr_t)errors[i].field);
    free(errors);
}
