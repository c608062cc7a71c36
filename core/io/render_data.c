/* render_data.c -- which particles are drawn, with what value and how large. Draws nothing. */
#include "config.h"

#include "io/render_parts.h"

#include "base/text.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLE ((size_t)100000)

/* -- The field --------------------------------------------------------------------------------- */

struct field {
    const struct snapshot_column *column;
    int component; /* -1: the length of all */
};

/* "x", "xy" or a number: which component of so many; -1 if none. */
static int component_index(const char *name, uint32_t ncomp, int dim)
{
    const uint32_t d = (uint32_t)dim;
    if (isdigit((unsigned char)*name)) {
        char *end;
        const unsigned long k = strtoul(name, &end, 10);
        return !*end && k < ncomp ? (int)k : -1;
    }
    if (name[0] < 'x' || name[0] > 'z' || (name[1] && (name[1] < 'x' || name[1] > 'z')))
        return -1;
    const uint32_t a = (uint32_t)(name[0] - 'x');
    if (!name[1])
        return ncomp <= 3 && a < ncomp ? (int)a : -1;
    const uint32_t b = (uint32_t)(name[1] - 'x');
    if (name[2] || a >= d || b >= d)
        return -1;
    if (ncomp == d * d)
        return (int)(a * d + b);
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    return ncomp == d * (d + 1) / 2 ? (int)(low * d - low * (low + 1) / 2 + high) : -1;
}

static int field_unknown(const struct snapshot *s, const char *name, struct error *e)
{
    const char **known = calloc(s->n_column + 1, sizeof *known);
    char hint[512];
    if (!known)
        return error_memory(e, "names", s->n_column * sizeof *known);
    for (size_t i = 0; i < s->n_column; i++)
        known[i] = s->column[i].name;
    error_set(e, EXIT_USAGE, "the snapshot has no field \"%s\"%s", name,
              s->n_column ? text_suggest(hint, sizeof hint, name, known, s->n_column) : "");
    free(known);
    return -1;
}

static int field_find(struct field *f, const struct snapshot *s, const char *name, struct error *e)
{
    *f = (struct field){NULL, -1};
    if (!name) {
        f->column = snapshot_find(s, "rho");
        if (!f->column && s->n_column == 0)
            return error_set(e, EXIT_USAGE, "the snapshot has no field to draw");
        if (!f->column)
            f->column = &s->column[0];
        return 0;
    }
    f->column = snapshot_find(s, name);
    const char *dot = strrchr(name, '.');
    if (f->column || !dot || (size_t)(dot - name) > 200)
        return f->column ? 0 : field_unknown(s, name, e);
    char stem[256];
    snprintf(stem, sizeof stem, "%.*s", (int)(dot - name), name);
    f->column = snapshot_find(s, stem);
    if (!f->column)
        return field_unknown(s, name, e);
    f->component = component_index(dot + 1, f->column->ncomp, s->dim);
    if (f->component < 0)
        return error_set(e, EXIT_USAGE, "field \"%s\" has no component \"%s\"", stem, dot + 1);
    return 0;
}

static double field_value(const struct field *f, size_t i)
{
    const uint32_t n = f->column->ncomp;
    const double *value = f->column->value + i * n;
    if (f->component >= 0)
        return value[f->component];
    if (n == 1)
        return value[0];
    double sum = 0;
    for (uint32_t k = 0; k < n; k++)
        sum += value[k] * value[k];
    return sqrt(sum);
}

/* "density ρ [kg/m²]" */
static void field_label(char *out, size_t size, const struct field *f, const struct snapshot *s)
{
    const char *doc = f->column->doc, *name = pretty_name(f->column->name);
    char unit[64], symbol[280];
    if (f->component >= 0 && f->column->ncomp <= 3)
        snprintf(symbol, sizeof symbol, "%.240s.%c", name, 'x' + f->component);
    else if (f->component >= 0)
        snprintf(symbol, sizeof symbol, "%.240s.%d", name, f->component);
    else
        snprintf(symbol, sizeof symbol, f->column->ncomp > 1 ? "|%.240s|" : "%.240s", name);
    const bool described = *doc && strlen(doc) <= 30 && strcmp(doc, f->column->name) != 0;
    pretty_unit(unit, sizeof unit, f->column->unit, s->dim);
    const bool has_unit = *unit && strcmp(s->units, "none") != 0;
    snprintf(out, size, "%s%s%.80s%s%s%s", described ? doc : "", described ? " " : "", symbol,
             has_unit ? " [" : "", has_unit ? unit : "", has_unit ? "]" : "");
}

/* -- Where ------------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct extent {
    double min, max;           /* of all */
    double near_min, near_max; /* without the few that fled */
};

/* Of coordinate k of the particles listed. */
static int extent_of(struct extent *x, const struct picture_data *d, int k, struct error *e)
{
    const size_t stride = d->n / SAMPLE + 1, room = d->n / stride + 1;
    double *sample = malloc(room * sizeof *sample);
    size_t n = 0;
    if (!sample)
        return error_memory(e, "a picture", room * sizeof *sample);
    *x = (struct extent){INFINITY, -INFINITY, 0, 0};
    for (size_t i = 0; i < d->n; i++) {
        const double at = d->s->x[3 * d->index[i] + (size_t)k];
        x->min = fmin(x->min, at);
        x->max = fmax(x->max, at);
        if (i % stride == 0)
            sample[n++] = at;
    }
    qsort(sample, n, sizeof *sample, compare);
    const double low = sample[n / 200], high = sample[n - 1 - n / 200], slack = 0.5 * (high - low);
    x->near_min = fmax(x->min, low - slack);
    x->near_max = fmin(x->max, high + slack);
    free(sample);
    return 0;
}

/* The side of a particle's volume by mass and density; NaN if they do not say. */
static double own_size(const struct snapshot_column *m, const struct snapshot_column *rho, size_t i,
                       int dim)
{
    const double volume = m && rho ? m->value[i] / rho->value[i] : (double)NAN;
    return volume > 0 && isfinite(volume) ? pow(volume, 1.0 / dim) : (double)NAN;
}

/* Sizes of the particles listed: their own, or what is left to them if they filled the extent. */
static void sizes_set(struct picture_data *d, const struct extent x[3])
{
    const struct snapshot_column *m = snapshot_find(d->s, "m"), *rho = snapshot_find(d->s, "rho");
    double volume = 1, widest = 0;
    if ((m && m->ncomp != 1) || (rho && rho->ncomp != 1))
        m = rho = NULL;
    for (int k = 0; k < d->s->dim; k++)
        widest = fmax(widest, x[k].near_max - x[k].near_min);
    if (widest == 0)
        widest = 1;
    for (int k = 0; k < d->s->dim; k++)
        volume *= fmax(x[k].near_max - x[k].near_min, 1e-3 * widest);
    const double even = pow(volume / (double)d->n, 1.0 / d->s->dim);
    for (size_t i = 0; i < d->n; i++) {
        const double size = own_size(m, rho, d->index[i], d->s->dim);
        d->size[i] = isnan(size) ? even : fmin(size, widest);
    }
}

/* The region shown: as asked for, or what the particles fill. */
static int region_set(struct picture_data *d, const struct render_options *o,
                      const struct extent x[3], struct error *e)
{
    double size = 0;
    for (size_t i = 0; i < d->n; i++)
        size += d->size[i] / (double)d->n;
    const double range[2] = {x[0].near_max - x[0].near_min, x[1].near_max - x[1].near_min};
    for (int k = 0; k < 2; k++) {
        double margin = fmax(0.6 * size, 0.02 * range[k]);
        if (!(margin > 0))
            margin = range[1 - k] > 0 ? 0.5 * range[1 - k] : 0.5;
        d->min[k] = isnan(o->region_min[k]) ? x[k].near_min - margin : o->region_min[k];
        d->max[k] = isnan(o->region_max[k]) ? x[k].near_max + margin : o->region_max[k];
        if (!(d->max[k] > d->min[k]) || !isfinite(d->max[k] - d->min[k]))
            return error_set(e, EXIT_USAGE, "the region to draw, %g to %g in %c, is empty",
                             d->min[k], d->max[k], 'x' + k);
    }
    return 0;
}

/* Whether particle i of the list can be seen. */
static bool is_seen(const struct picture_data *d, const struct render_options *o, size_t i)
{
    const double *x = d->s->x + 3 * d->index[i], reach = RENDER_REACH * d->size[i];
    if (x[0] + reach < d->min[0] || x[0] - reach > d->max[0])
        return false;
    if (d->s->dim == 1)
        return true;
    if (x[1] + reach < d->min[1] || x[1] - reach > d->max[1])
        return false;
    if (d->s->dim == 2)
        return true;
    return d->section ? fabs(x[2] - d->plane) < reach : x[2] >= o->slice[0] && x[2] <= o->slice[1];
}

static int slice_set(struct picture_data *d, const struct render_options *o, const struct extent *z,
                     struct error *e)
{
    if (isnan(o->slice[0]) || isnan(o->slice[1])) {
        d->section = true;
        d->plane = z->min < 0 && z->max > 0 ? 0 : 0.5 * (z->min + z->max);
        return 0;
    }
    if (!(o->slice[1] >= o->slice[0]))
        return error_set(e, EXIT_USAGE, "the slice to draw, z = %g to %g, is empty", o->slice[0],
                         o->slice[1]);
    d->plane = 0.5 * (o->slice[0] + o->slice[1]);
    return 0;
}

/* -- Which particles --------------------------------------------------------------------------- */

/* All of the array that are anywhere. */
static int list_all(struct picture_data *d, const char *array, struct error *e)
{
    const struct snapshot *s = d->s;
    int32_t wanted = -1;
    for (size_t a = 0; array && a < s->n_array && wanted < 0; a++)
        if (strcmp(s->array_name[a], array) == 0)
            wanted = (int32_t)a;
    if (array && wanted < 0) {
        char hint[512];
        return error_set(
            e, EXIT_USAGE, "the snapshot has no array \"%s\"%s", array,
            text_suggest(hint, sizeof hint, array, (const char *const *)s->array_name, s->n_array));
    }
    d->index = malloc((s->n + 1) * sizeof *d->index);
    d->value = malloc((s->n + 1) * sizeof *d->value);
    d->size = malloc((s->n + 1) * sizeof *d->size);
    if (!d->index || !d->value || !d->size)
        return error_memory(e, "a picture", s->n * 3 * sizeof *d->value);
    for (size_t i = 0; i < s->n; i++)
        if ((wanted < 0 || s->array[i] == wanted) &&
            isfinite(s->x[3 * i] + s->x[3 * i + 1] + s->x[3 * i + 2]))
            d->index[d->n++] = i;
    return d->n ? 0 : error_set(e, EXIT_USAGE, "there is nothing to draw: no particles");
}

static int list_seen(struct picture_data *d, const struct render_options *o, const struct field *f,
                     struct error *e)
{
    size_t n = 0;
    for (size_t i = 0; i < d->n; i++)
        if (is_seen(d, o, i)) {
            d->index[n] = d->index[i];
            d->size[n] = d->size[i];
            d->value[n] = field_value(f, d->index[i]);
            n++;
        }
    d->n = n;
    return n ? 0 : error_set(e, EXIT_USAGE, "there is nothing to draw: no particles in the region");
}

/* Low and high: as asked for, or of the values. */
static int range_set(struct picture_data *d, const struct render_options *o, bool diverging,
                     const char *field, struct error *e)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < d->n; i++)
        if (isfinite(d->value[i]) && (!d->log || d->value[i] > 0)) {
            low = fmin(low, d->value[i]);
            high = fmax(high, d->value[i]);
        }
    if (!(high >= low))
        return error_set(e, EXIT_USAGE, "there is nothing to draw: \"%s\" has no value%s", field,
                         d->log ? " above zero, as a logarithmic scale needs" : "");
    if (diverging && !d->log && low < 0 && high > 0) {
        const double widest = fmax(-low, high);
        d->low = -widest;
        d->high = widest;
    } else {
        d->low = low;
        d->high = high;
    }
    if (!isnan(o->min))
        d->low = o->min;
    if (!isnan(o->max))
        d->high = o->max;
    if (d->low > d->high || (d->log && !(d->low > 0)) || !isfinite(d->high - d->low))
        return error_set(e, EXIT_USAGE, "the range to draw, %g to %g, is %s", d->low, d->high,
                         d->log && !(d->low > 0) ? "not above zero, as a logarithmic scale needs"
                                                 : "empty");
    /* Equal but for rounding is equal: noise is not to fill the colours. */
    if (d->high - d->low <= 1e-12 * fmax(fabs(d->low), fabs(d->high))) {
        const double slack = d->low == 0 ? 0.5 : 0.05 * fabs(d->low);
        d->low -= slack;
        d->high += slack;
    }
    d->below = low < d->low;
    d->above = high > d->high;
    return 0;
}

int picture_data_make(struct picture_data *d, const struct snapshot *s,
                      const struct render_options *o, bool diverging, struct error *e)
{
    struct field f;
    struct extent x[3];
    *d = (struct picture_data){.s = s, .log = o->log_scale != 0};
    if (field_find(&f, s, o->field, e) || list_all(d, o->array, e))
        goto fail;
    for (int k = 0; k < 3; k++)
        if (extent_of(&x[k], d, k, e))
            goto fail;
    sizes_set(d, x);
    if (region_set(d, o, x, e) || (s->dim == 3 && slice_set(d, o, &x[2], e)) ||
        list_seen(d, o, &f, e) || range_set(d, o, diverging, f.column->name, e))
        goto fail;
    field_label(d->label, sizeof d->label, &f, s);
    return 0;
fail:
    picture_data_free(d);
    return -1;
}

void picture_data_free(struct picture_data *d)
{
    free(d->index);
    free(d->value);
    free(d->size);
    *d = (struct picture_data){0};
}

double picture_scale(const struct picture_data *d, double value)
{
    if (d->log)
        return value > 0 ? log(value / d->low) / log(d->high / d->low) : (double)NAN;
    return (value - d->low) / (d->high - d->low);
}
