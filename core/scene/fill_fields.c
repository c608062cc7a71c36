/* scene/fill_fields.c -- the initial values of particles: fields, columns of the user's own,
 * what a file gave; and from them mass and smoothing length. */
#include "base/text.h"
#include "scene/expression.h"
#include "scene/fill_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct scene_field *fill_field(const struct scene_array *a, size_t k, const char *name)
{
    for (size_t i = 0; i < a->n_fill_field[k]; i++)
        if (!strcmp(a->fill_field[k][i].name, name))
            return &a->fill_field[k][i];
    for (size_t i = 0; i < a->n_field; i++)
        if (!strcmp(a->field[i].name, name))
            return &a->field[i];
    return NULL;
}

static int fail_value(const struct scene *s, const char *name, const cJSON *node, double value,
                      const double *x, struct error *e)
{
    char where[80];
    if (s->dim == 1)
        snprintf(where, sizeof where, "x = %.6g", x[0]);
    else if (s->dim == 2)
        snprintf(where, sizeof where, "(%.6g, %.6g)", x[0], x[1]);
    else
        snprintf(where, sizeof where, "(%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
    return document_fail(s->doc, node, e, "\"%s\" gives %s = %s at %s", node->valuestring, name,
                         isnan(value) ? "NaN" : "infinity", where);
}

int field_values(const struct scene *s, const char *name, const cJSON *node, uint32_t part,
                 const double *const x[3], const double *spacing, size_t n, double *out,
                 struct error *e)
{
    const cJSON *item = cJSON_IsArray(node) ? cJSON_GetArrayItem(node, (int)part) : node;
    struct expression *expression;
    struct error inner = {0};
    if (cJSON_IsNumber(item)) {
        for (size_t i = 0; i < n; i++)
            out[i] = item->valuedouble;
        return 0;
    }
    if (expression_new(&expression, item->valuestring, scene_variables, SCENE_VARIABLES, &inner) <
        0)
        return document_fail(s->doc, item, e, "%s", inner.text);
    int status = 0;
    for (size_t i = 0; i < n && !status; i++) {
        double at[3] = {0, 0, 0}, values[SCENE_VARIABLES];
        for (int c = 0; c < s->dim; c++)
            at[c] = x[c][i];
        scene_values(at, s->dim, spacing[i], values);
        out[i] = expression_at(expression, values);
        if (!isfinite(out[i]))
            status = fail_value(s, name, item, out[i], at, e);
    }
    expression_free(expression);
    return status;
}

/* -- Columns --------------------------------------------------------------------------------- */

/* Positions and spacing of particles [first, ...) of p. */
struct view {
    const double *x[3];
    double *spacing;
};

static struct view view_of(const struct particles *p, size_t first)
{
    struct view v = {.spacing = particles_real(p, "h", 0) + first};
    for (int c = 0; c < p->dim; c++)
        v.x[c] = particles_real(p, "x", (uint32_t)c) + first;
    return v;
}

/* Puts values into component `part` of column c; whole numbers where the column holds them. */
static int store(struct particles *p, int c, uint32_t part, size_t first, size_t n,
                 const double *value)
{
    struct column *column = &p->column[c];
    size_t at = (size_t)part * column->plane + first;
    if (column->type == SPH_INT32) {
        int32_t *out = (int32_t *)column->data + at;
        for (size_t i = 0; i < n; i++) {
            if (!(fabs(value[i]) < 2147483648.))
                return -1;
            out[i] = (int32_t)lround(value[i]);
        }
    } else if (column->type == SPH_INT64) {
        int64_t *out = (int64_t *)column->data + at;
        for (size_t i = 0; i < n; i++) {
            if (!(fabs(value[i]) < 9e15))
                return -1;
            out[i] = llround(value[i]);
        }
    } else {
        memcpy((double *)column->data + at, value, n * sizeof *value);
    }
    return 0;
}

/* The field at `node` into all components of column c. */
static int set_column(struct particles *p, const struct scene *s, int c, const char *name,
                      const cJSON *node, size_t first, size_t n, struct error *e)
{
    struct view v = view_of(p, first);
    uint32_t ncomp = p->column[c].ncomp;
    int given = cJSON_IsArray(node) ? cJSON_GetArraySize(node) : 1;
    if ((uint32_t)given != ncomp)
        return document_fail(s->doc, node, e, "%d component%s; \"%s\" has %u in %d dimension%s",
                             given, given == 1 ? "" : "s", name, ncomp, s->dim,
                             s->dim == 1 ? "" : "s");
    double *value = malloc((n + 1) * sizeof *value);
    if (!value)
        return error_memory(e, "an initial field", n * sizeof *value);
    int status = 0;
    for (uint32_t part = 0; part < ncomp && !status; part++) {
        status = field_values(s, name, node, part, v.x, v.spacing, n, value, e);
        if (!status && store(p, c, part, first, n, value) < 0)
            status = document_fail(s->doc, node, e,
                                   "a value of \"%s\" is too large for a whole number", name);
    }
    free(value);
    return status;
}

/* A field that names no column: an error, unless it is "rho", which m will use. */
static int no_column(const struct particles *p, const struct scene *s,
                     const struct scene_field *field, struct error *e)
{
    const char *known[256];
    char hint[512];
    size_t n = 0;
    if (!strcmp(field->name, "rho"))
        return 0;
    for (size_t i = 0; i < p->n_column && n < 255; i++)
        if (strcmp(p->column[i].name, "x") != 0 && strcmp(p->column[i].name, "id") != 0)
            known[n++] = p->column[i].name;
    if (particles_find(p, "rho") < 0)
        known[n++] = "rho";
    return document_fail_key(s->doc, field->node, e, "unknown field \"%.60s\"%s", field->name,
                             text_suggest(hint, sizeof hint, field->name, known, n));
}

/* -- Mass and smoothing length --------------------------------------------------------------- */

/* Where a message about mass or density points. */
static const cJSON *node_of(const struct scene_array *a, size_t k, const char *name)
{
    const struct scene_field *field = fill_field(a, k, name);
    return field ? field->node : a->fill[k].node;
}

/* Which of the core's properties this fill gives. */
struct given {
    bool rho, m, h;
};

/* m, and rho where only m is given. The h column still holds the spacing. */
static int set_mass(struct particles *p, const struct scene *s, size_t a, size_t k, size_t first,
                    size_t n, struct given g, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    struct view v = view_of(p, first);
    double *m = particles_real(p, "m", 0) + first;
    double *rho = particles_real(p, "rho", 0);
    const struct scene_field *field = fill_field(array, k, "rho");
    double mass = array->fill[k].mass;
    rho = rho ? rho + first : NULL;
    if (!g.m && !g.rho && !(mass > 0))
        return document_fail(s->doc, array->fill[k].node, e,
                             "the particles' mass is unknown: give the field \"rho\" or \"m\"");
    if (!g.m && g.rho && !rho && /* no such column: m takes the values */
        field_values(s, "rho", field->node, 0, v.x, v.spacing, n, m, e) < 0)
        return -1;
    for (size_t i = 0; i < n; i++) {
        double volume = pow(v.spacing[i], s->dim);
        if (!g.m) {
            double density = !g.rho ? 1 : rho ? rho[i] : m[i];
            if (!(density > 0))
                return document_fail(s->doc, node_of(array, k, "rho"), e,
                                     "the density is %.6g; give a positive one", density);
            m[i] = mass > 0 ? mass : density * volume;
        }
        if (!(m[i] > 0))
            return document_fail(s->doc, node_of(array, k, "m"), e,
                                 "a particle's mass is %.6g; give a positive one", m[i]);
        if (!g.rho && rho)
            rho[i] = m[i] / volume;
    }
    return 0;
}

/* The spacing of particles out of a file, which knows none: from m and rho, or from h. */
static int find_spacing(struct particles *p, const struct scene *s, size_t a, size_t k,
                        size_t first, size_t n, struct given g, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    double *spacing = particles_real(p, "h", 0) + first;
    const double *m = particles_real(p, "m", 0), *rho = particles_real(p, "rho", 0);
    for (size_t i = 0; i < n; i++) {
        if (!isnan(spacing[i]) && !g.h)
            continue;
        if (g.m && g.rho && rho)
            spacing[i] = pow(m[first + i] / rho[first + i], 1. / s->dim);
        else if (g.h)
            spacing[i] /= array->h_factor;
        if (!(spacing[i] > 0) || !isfinite(spacing[i]))
            return document_fail(s->doc, array->fill[k].node, e,
                                 "the particles' spacing is unknown: give \"spacing\", or "
                                 "m and rho, or h, in the file");
    }
    return 0;
}

/* From the spacing in the h column to the smoothing length. */
static int set_length(struct particles *p, const struct scene *s, size_t a, size_t k, size_t first,
                      size_t n, const double *file_h, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    const struct scene_field *field = fill_field(array, k, "h");
    double *h = particles_real(p, "h", 0) + first;
    if (field) {
        if (set_column(p, s, particles_find(p, "h"), "h", field->node, first, n, e) < 0)
            return -1;
    } else if (file_h) {
        memcpy(h, file_h, n * sizeof *h);
    } else {
        for (size_t i = 0; i < n; i++)
            h[i] *= array->h_factor;
    }
    for (size_t i = 0; i < n; i++)
        if (!(h[i] > 0))
            return document_fail(s->doc, node_of(array, k, "h"), e,
                                 "a smoothing length is %.6g; give a positive one", h[i]);
    return 0;
}

/* -- All of a fill --------------------------------------------------------------------------- */

/* The file's column "v.x" into ours. Columns that are none of ours: see below. */
static int set_from_table(struct particles *p, const struct scene *s, const struct scene_fill *f,
                          const struct table *t, size_t first, bool *given, struct error *e)
{
    for (size_t k = 0; k < t->n_column; k++) {
        char name[64], hint[512];
        const char *known[256];
        snprintf(name, sizeof name, "%s", t->column[k].name);
        if (strlen(name) == 1 && name[0] >= 'x' && name[0] < 'x' + 3)
            continue; /* positions are in place */
        if (!strcmp(name, "id") || !strcmp(name, "array") || !strcmp(name, "-") ||
            !strcmp(name, "h"))
            continue;
        char *dot = strrchr(name, '.');
        uint32_t part = 0;
        if (dot && dot[1] && !dot[2]) {
            part = (uint32_t)(dot[1] >= 'x' ? dot[1] - 'x' : dot[1] - '0');
            *dot = '\0';
        }
        int c = particles_find(p, name);
        if (c >= 0 && part < p->column[c].ncomp) {
            if (store(p, c, part, first, t->n, t->column[k].value) < 0)
                return document_fail(s->doc, json_get(f->node, "file"), e,
                                     "a value of \"%s\" is too large for a whole number", name);
            given[c] = true;
            continue;
        }
        if (t->snapshot || (c >= 0 && part < 3)) /* a component that these dimensions lack */
            continue;
        size_t n = 0;
        for (size_t i = 0; i < p->n_column && n < 256; i++)
            known[n++] = p->column[i].name;
        return document_fail(s->doc, json_get(f->node, "file"), e,
                             "the file's column \"%.60s\" is no property%s; "
                             "\"rename\": {\"%.60s\": \"-\"} leaves it out",
                             t->column[k].name, text_suggest(hint, sizeof hint, name, known, n),
                             t->column[k].name);
    }
    return 0;
}

static int set_fields(struct particles *p, const struct scene *s, size_t a, size_t k, size_t first,
                      size_t n, bool *given, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    for (size_t i = 0; i < array->n_field + array->n_fill_field[k]; i++) {
        const struct scene_field *field =
            i < array->n_field ? &array->field[i] : &array->fill_field[k][i - array->n_field];
        if (field != fill_field(array, k, field->name) || !strcmp(field->name, "h"))
            continue; /* overridden; or set last */
        int c = particles_find(p, field->name);
        if (c < 0 || !strcmp(field->name, "id")) {
            if (no_column(p, s, field, e) < 0)
                return -1;
            continue;
        }
        if (set_column(p, s, c, field->name, field->node, first, n, e) < 0)
            return -1;
        given[c] = true;
    }
    for (size_t i = 0; i < array->n_column; i++) {
        int c = particles_find(p, array->column[i].name);
        if (c < 0 || given[c]) /* by a field, or restored from a file */
            continue;
        if (set_column(p, s, c, array->column[i].name, array->column[i].node, first, n, e) < 0)
            return -1;
        given[c] = true;
    }
    return 0;
}

int fill_fields(struct particles *p, const struct scene *s, size_t a, size_t k, size_t first,
                size_t n, const struct table *t, bool *given, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    const double *file_h = NULL;
    if (t && set_from_table(p, s, &array->fill[k], t, first, given, e) < 0)
        return -1;
    if (t && table_find(t, "h") >= 0)
        file_h = t->column[table_find(t, "h")].value;
    if (set_fields(p, s, a, k, first, n, given, e) < 0)
        return -1;
    struct given g = {
        .rho = fill_field(array, k, "rho") || (t && table_find(t, "rho") >= 0),
        .m = fill_field(array, k, "m") || (t && table_find(t, "m") >= 0),
    };
    if (t) {
        double *h = particles_real(p, "h", 0) + first;
        for (size_t i = 0; i < n; i++)
            if (isnan(h[i]) && file_h) {
                h[i] = file_h[i];
                g.h = true;
            }
        if (find_spacing(p, s, a, k, first, n, g, e) < 0)
            return -1;
    }
    if (set_mass(p, s, a, k, first, n, g, e) < 0 || set_length(p, s, a, k, first, n, file_h, e) < 0)
        return -1;
    if (file_h || fill_field(array, k, "h"))
        given[particles_find(p, "h")] = true;
    return 0;
}
