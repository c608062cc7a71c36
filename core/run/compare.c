/* run/compare.c -- error norms against the exact solutions that the scene names. */
#include "base/text.h"
#include "run/report.h"
#include "scene/expression.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double at(const struct column *column, uint32_t c, size_t i)
{
    return ((const double *)column->data)[c * column->plane + i];
}

/* inside[i]: particle i lies in the region `where` (NULL: everywhere). */
static int select_region(const struct plan_array *a, const char *where, bool *inside, struct error *e)
{
    static const char *const name[] = {"x", "y", "z", "r"};
    struct expression *x = NULL;
    if (where && expression_new(&x, where, name, 4, e))
        return -1;
    for (size_t i = 0; i < a->p.n; i++) {
        double v[4] = {0.0, 0.0, 0.0, 0.0};
        for (int c = 0; c < a->p.dim; c++) {
            v[c] = at(&a->p.column[a->position], (uint32_t)c, i);
            v[3] += v[c] * v[c];
        }
        v[3] = sqrt(v[3]);
        inside[i] = !x || expression_at(x, v) != 0.0;
    }
    expression_free(x);
    return 0;
}

static void norms(const struct plan_array *a, const struct column *f, const sph_column *exact,
                  const bool *inside, struct summary_error *out)
{
    int rho = particles_find(&a->p, "rho");
    double volume = 0.0, scale = 0.0;
    for (size_t i = 0; i < a->p.n; i++) {
        if (!inside[i])
            continue;
        double density = rho < 0 ? 1.0 : at(&a->p.column[rho], 0, i);
        double v = rho < 0 ? 1.0 : at(&a->p.column[a->mass], 0, i) / density;
        double d2 = 0.0, s2 = 0.0;
        for (uint32_t c = 0; c < f->ncomp; c++) {
            double star = ((const double *)exact->data)[c * exact->plane + i];
            d2 += (at(f, c, i) - star) * (at(f, c, i) - star);
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

/* Columns for the exact solution's batch: the array's own where it reads, fresh ones where it writes. */
static int exact_columns(const struct plan_array *a, const sph_item *item, sph_column *column, struct error *e)
{
    for (uint32_t k = 0; k < item->props.count; k++) {
        const sph_prop *prop = list_at(&item->props, k);
        if (!(prop->access & SPH_DST_WRITE)) {
            int c = particles_find(&a->p, prop->name);
            if (c < 0)
                return error_set(e, EXIT_USAGE, "%s needs \"%s\", which array \"%s\" has not", item->name,
                                 prop->name, a->p.name);
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
    }
    return 0;
}

static int add_error(struct summary_error **out, size_t *n, const struct plan_array *a, const struct column *f,
                     const char *reference, const sph_column *exact, const bool *inside, struct error *e)
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

static int compare(const struct run *r, size_t index, struct summary_error **out, size_t *n, struct error *e)
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
        status = exact_columns(a, use->item, column, e) || select_region(a, c->where, inside, e) ? -1 : 0;
    if (!status) {
        sph_batch b = {.size = sizeof b, .dim = (uint32_t)plan->dim, .real = SPH_F64, .lanes = SPH_LANES,
                       .count = a->p.n, .n_dst = a->p.n, .dst = column, .n_columns = count,
                       .n_params = use->item->params.count, .param = use->config.value,
                       .state = use->state, .time = r->time, .step = r->step,
                       .host = &plan->registry->host};
        sph_status s = entry_exact(use->entry)->run(&b);
        char why[512];
        if (s != SPH_OK) {
            registry_reason(plan->registry, s, why, sizeof why);
            status = error_set(e, EXIT_RUN, "exact solution \"%s\": %s", c->exact, why);
        }
    }
    for (uint32_t k = 0; column && k < count; k++) {
        const sph_prop *prop = list_at(&use->item->props, k);
        if (!(prop->access & SPH_DST_WRITE))
            continue;
        int f = particles_find(&a->p, prop->name);
        if (!status && f >= 0 && wanted(c, prop->name))
            status = add_error(out, n, a, &a->p.column[f], c->exact, &column[k], inside, e);
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

/* -- probes ------------------------------------------------------------------------------------- */

/* "v.x" is a component, "v" of a vector its length, "rho" a scalar. */
static double probed(const struct plan_array *a, const char *of, size_t i)
{
    char plain[64] = "";
    size_t length = strcspn(of, ".");
    if (length < sizeof plain)
        memcpy(plain, of, length);
    int f = particles_find(&a->p, plain);
    if (f < 0)
        return NAN;
    const struct column *column = &a->p.column[f];
    if (column->size != sizeof(double) || column->type == SPH_INT64)
        return (double)((const int32_t *)column->data)[i];
    if (of[length] == '.') {
        uint32_t c = (uint32_t)(of[length + 1] - 'x');
        return c < column->ncomp ? at(column, c, i) : NAN;
    }
    if (column->ncomp == 1)
        return at(column, 0, i);
    double s = 0.0;
    for (uint32_t c = 0; c < column->ncomp; c++)
        s += at(column, c, i) * at(column, c, i);
    return sqrt(s);
}

static double radius(const struct plan_array *a, size_t i)
{
    double r2 = 0.0;
    for (int c = 0; c < a->p.dim; c++)
        r2 += at(&a->p.column[a->position], (uint32_t)c, i) * at(&a->p.column[a->position], (uint32_t)c, i);
    return sqrt(r2);
}

/* From outside inwards: the radius at which the shells' means reach the level, between two shells' middles. */
static double crossing(const struct plan_array *a, const struct scene_probe *p, const bool *inside, struct error *e)
{
    double far = 0.0;
    for (size_t i = 0; i < a->p.n; i++)
        far = inside[i] ? fmax(far, radius(a, i)) : far;
    size_t n = (size_t)(far / p->shell) + 1;
    if (n > 10000000) {
        error_set(e, EXIT_RUN, "probe \"%s\": too many shells", p->name);
        return NAN;
    }
    double *sum = calloc(2 * n, sizeof *sum), *count = sum ? sum + n : NULL, found = NAN;
    if (!sum) {
        error_memory(e, "shells", 2 * n * sizeof *sum);
        return NAN;
    }
    for (size_t i = 0; i < a->p.n; i++) {
        size_t k = (size_t)(radius(a, i) / p->shell);
        if (!inside[i] || k >= n)
            continue;
        sum[k] += probed(a, p->of, i);
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

static double probe(const struct plan_array *a, const struct scene_probe *p, const bool *inside, struct error *e)
{
    if (p->kind == PROBE_CROSSING)
        return crossing(a, p, inside, e);
    double out = p->kind == PROBE_MIN ? INFINITY : p->kind == PROBE_MAX ? -INFINITY : 0.0;
    double n = 0.0;
    for (size_t i = 0; i < a->p.n; i++) {
        if (!inside[i])
            continue;
        double value = probed(a, p->of, i);
        out = p->kind == PROBE_MIN   ? fmin(out, value)
              : p->kind == PROBE_MAX ? fmax(out, value)
                                     : out + value;
        n += 1.0;
    }
    return n == 0.0 ? NAN : p->kind == PROBE_MEAN ? out / n : out;
}

int report_probes(const struct run *r, struct summary_probe **out, size_t *n, struct error *e)
{
    const struct scene *s = r->plan->scene;
    *n = 0;
    *out = calloc(s->n_probe + 1, sizeof **out);
    if (!*out)
        return error_memory(e, "probes", s->n_probe * sizeof **out);
    for (size_t i = 0; i < s->n_probe; i++) {
        const struct scene_probe *p = &s->probe[i];
        const struct plan_array *a = NULL;
        for (size_t k = 0; k < r->plan->n_array; k++)
            if (strcmp(r->plan->array[k].p.name, p->array) == 0)
                a = &r->plan->array[k];
        if (!a)
            continue;
        bool *inside = calloc(a->p.n + 1, sizeof *inside);
        if (!inside)
            return error_memory(e, "a probe", a->p.n);
        if (select_region(a, p->where, inside, e)) {
            free(inside);
            return -1;
        }
        (*out)[*n] = (struct summary_probe){p->name, probe(a, p, inside, e), p->expected};
        *n += 1;
        free(inside);
    }
    return 0;
}
