/* run/probes.c -- the numbers that a scene asks for of its particles at the end. */
#include "run/region.h"
#include "run/report.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    if (column->type == SPH_INT64)
        return (double)((const int64_t *)column->data)[i];
    if (column->type == SPH_INT32)
        return (double)((const int32_t *)column->data)[i];
    if (of[length] == '.') {
        uint32_t c = (uint32_t)(of[length + 1] - 'x');
        return c < column->ncomp ? region_value(column, c, i) : NAN;
    }
    if (column->ncomp == 1)
        return region_value(column, 0, i);
    double s = 0.0;
    for (uint32_t c = 0; c < column->ncomp; c++)
        s += region_value(column, c, i) * region_value(column, c, i);
    return sqrt(s);
}

static double radius(const struct plan_array *a, size_t i)
{
    double r2 = 0.0;
    for (int c = 0; c < a->p.dim; c++)
        r2 += region_value(&a->p.column[a->position], (uint32_t)c, i) *
              region_value(&a->p.column[a->position], (uint32_t)c, i);
    return sqrt(r2);
}

/* From outside inwards: the radius at which the shells' means reach the level, between two shells' middles. */
static double crossing(const struct plan_array *a, const struct scene_probe *p, const bool *inside,
                       struct error *e)
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

static double probe(const struct plan_array *a, const struct scene_probe *p, const bool *inside,
                    struct error *e)
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
        if (region_select(a, p->where, inside, e)) {
            free(inside);
            return -1;
        }
        (*out)[*n] = (struct summary_probe){p->name, probe(a, p, inside, e), p->expected};
        *n += 1;
        free(inside);
    }
    return 0;
}
