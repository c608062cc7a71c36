/* scene/shape.c -- solid geometry as a tree. Knows JSON and numbers, nothing of particles. */
#include "scene/shape.h"
#include "base/text.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum shape_kind {
    SHAPE_BOX,
    SHAPE_SPHERE,
    SHAPE_CYLINDER,
    SHAPE_HALF_SPACE,
    SHAPE_UNION,
    SHAPE_INTERSECTION,
    SHAPE_DIFFERENCE,
    SHAPE_KINDS
};

static const char *const kind_names[SHAPE_KINDS] = {
    "box", "sphere", "cylinder", "half-space", "union", "intersection", "difference"};

struct shape {
    enum shape_kind kind;
    int dim;
    double a[3], b[3]; /* box: min, max; sphere: center; cylinder: center, unit axis; half-space:
                        * point, unit normal */
    double radius, length;
    struct shape **part;
    size_t n_part;
};

static int compile_box(struct shape *s, const struct document *d, const cJSON *node,
                       struct error *e)
{
    static const char *const keys[] = {"min", "max"};
    if (json_keys(d, node, keys, 2, e) < 0 ||
        json_vector(d, node, "min", true, s->dim, s->a, e) < 0 ||
        json_vector(d, node, "max", true, s->dim, s->b, e) < 0)
        return -1;
    for (int i = 0; i < s->dim; i++)
        if (s->a[i] >= s->b[i])
            return document_fail(d, node, e,
                                 "the box is empty: along %c, min %.15g is not below max %.15g",
                                 "xyz"[i], s -> a[i], s -> b[i]);
    return 0;
}

static int compile_sphere(struct shape *s, const struct document *d, const cJSON *node,
                          struct error *e)
{
    static const char *const keys[] = {"center", "radius"};
    if (json_keys(d, node, keys, 2, e) < 0 ||
        json_vector(d, node, "center", true, s->dim, s->a, e) < 0)
        return -1;
    return json_positive(d, node, "radius", true, "radius", &s->radius, e);
}

/* Makes member `key`, read into v, a unit vector. */
static int unit_vector(const struct document *d, const cJSON *node, const char *key, double v[3],
                       struct error *e)
{
    double length = hypot(hypot(v[0], v[1]), v[2]);
    if (!(length > 0) || !isfinite(length))
        return document_fail(d, json_get(node, key), e, "this vector has no direction");
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return 0;
}

static int compile_cylinder(struct shape *s, const struct document *d, const cJSON *node,
                            struct error *e)
{
    static const char *const keys[] = {"center", "axis", "radius", "length"};
    if (s->dim != 3)
        return document_fail_key(
            d, node, e, "a cylinder needs 3 dimensions; in %d give a sphere or a box", s->dim);
    if (json_keys(d, node, keys, 4, e) < 0 ||
        json_vector(d, node, "center", true, s->dim, s->a, e) < 0 ||
        json_vector(d, node, "axis", true, s->dim, s->b, e) < 0 ||
        json_positive(d, node, "radius", true, "radius", &s->radius, e) < 0 ||
        json_positive(d, node, "length", true, "length", &s->length, e) < 0)
        return -1;
    return unit_vector(d, node, "axis", s->b, e);
}

static int compile_half_space(struct shape *s, const struct document *d, const cJSON *node,
                              struct error *e)
{
    static const char *const keys[] = {"point", "normal"};
    if (json_keys(d, node, keys, 2, e) < 0 ||
        json_vector(d, node, "point", true, s->dim, s->a, e) < 0 ||
        json_vector(d, node, "normal", true, s->dim, s->b, e) < 0)
        return -1;
    return unit_vector(d, node, "normal", s->b, e);
}

static int compile_parts(struct shape *s, const struct document *d, const cJSON *node,
                         struct error *e)
{
    const cJSON *item;
    int n = cJSON_GetArraySize(node);
    if (!cJSON_IsArray(node) || n < 1)
        return document_fail(d, node, e, "give an array of at least one shape");
    s->part = calloc((size_t)n, sizeof(struct shape *));
    if (!s->part)
        return error_memory(e, "a shape", (size_t)n * sizeof(struct shape *));
    cJSON_ArrayForEach(item, node)
    {
        if (shape_compile(&s->part[s->n_part], d, item, s->dim, e) < 0)
            return -1;
        s->n_part++;
    }
    return 0;
}

static int compile_kind(struct shape *s, const struct document *d, const cJSON *node,
                        struct error *e)
{
    switch (s->kind) {
    case SHAPE_BOX:
        return compile_box(s, d, node, e);
    case SHAPE_SPHERE:
        return compile_sphere(s, d, node, e);
    case SHAPE_CYLINDER:
        return compile_cylinder(s, d, node, e);
    case SHAPE_HALF_SPACE:
        return compile_half_space(s, d, node, e);
    default:
        return compile_parts(s, d, node, e);
    }
}

int shape_compile(struct shape **out, const struct document *d, const cJSON *node, int dim,
                  struct error *e)
{
    char brief[JSON_BRIEF], hint[256];
    *out = NULL;
    if (!cJSON_IsObject(node))
        return document_fail(d, node, e, "%s is not a shape; give {\"box\": {...}} or another",
                             json_brief(node, brief));
    const cJSON *child = node->child;
    if (!child || child->next)
        return document_fail(
            d, node, e, "a shape has one key, not %d: %s", cJSON_GetArraySize(node),
            "box, sphere, cylinder, half-space, union, intersection or difference");
    size_t kind = 0;
    while (kind < SHAPE_KINDS && strcmp(child->string, kind_names[kind]) != 0)
        kind++;
    if (kind == SHAPE_KINDS) {
        cJSON name = {.type = cJSON_String, .valuestring = child->string};
        return document_fail_key(
            d, child, e, "unknown shape %s%s", json_brief(&name, brief),
            text_suggest(hint, sizeof hint, child->string, kind_names, SHAPE_KINDS));
    }
    struct shape *s = calloc(1, sizeof *s);
    if (!s)
        return error_memory(e, "a shape", sizeof *s);
    s->kind = (enum shape_kind)kind;
    s->dim = dim;
    if (compile_kind(s, d, child, e) < 0) {
        shape_free(s);
        return -1;
    }
    *out = s;
    return 0;
}

void shape_free(struct shape *s)
{
    if (!s)
        return;
    for (size_t i = 0; i < s->n_part; i++)
        shape_free(s->part[i]);
    free(s->part);
    free(s);
}

/* -- Inside ---------------------------------------------------------------------------------- */

/* A face with this outward normal is a lower one: its first component that is not 0 is negative. */
static bool is_lower(const double normal[3])
{
    for (int i = 0; i < 3; i++)
        if (normal[i] != 0)
            return normal[i] < 0;
    return false;
}

static bool inside_box(const struct shape *s, const double x[3])
{
    for (int i = 0; i < s->dim; i++)
        if (!(x[i] >= s->a[i] && x[i] < s->b[i]))
            return false;
    return true;
}

static bool inside_sphere(const struct shape *s, const double x[3])
{
    double r2 = 0;
    if (s->dim == 1)
        return x[0] >= s->a[0] - s->radius && x[0] < s->a[0] + s->radius;
    for (int i = 0; i < s->dim; i++)
        r2 += (x[i] - s->a[i]) * (x[i] - s->a[i]);
    return r2 < s->radius * s->radius;
}

static bool inside_cylinder(const struct shape *s, const double x[3])
{
    double along = 0, r2 = 0;
    for (int i = 0; i < 3; i++)
        along += (x[i] - s->a[i]) * s->b[i];
    for (int i = 0; i < 3; i++) {
        double across = x[i] - s->a[i] - along * s->b[i];
        r2 += across * across;
    }
    double half = .5 * s->length;
    bool lower = is_lower(s->b); /* the axis is the outward normal of the face at +half */
    bool within = lower ? along > -half && along <= half : along >= -half && along < half;
    return within && r2 < s->radius * s->radius;
}

static bool inside_half_space(const struct shape *s, const double x[3])
{
    double height = 0;
    for (int i = 0; i < s->dim; i++)
        height += (x[i] - s->a[i]) * s->b[i];
    return height < 0 || (height == 0 && is_lower(s->b));
}

bool shape_inside(const struct shape *s, const double x[3])
{
    switch (s->kind) {
    case SHAPE_BOX:
        return inside_box(s, x);
    case SHAPE_SPHERE:
        return inside_sphere(s, x);
    case SHAPE_CYLINDER:
        return inside_cylinder(s, x);
    case SHAPE_HALF_SPACE:
        return inside_half_space(s, x);
    case SHAPE_UNION:
        for (size_t i = 0; i < s->n_part; i++)
            if (shape_inside(s->part[i], x))
                return true;
        return false;
    case SHAPE_INTERSECTION:
        for (size_t i = 0; i < s->n_part; i++)
            if (!shape_inside(s->part[i], x))
                return false;
        return true;
    default: /* difference */
        for (size_t i = 1; i < s->n_part; i++)
            if (shape_inside(s->part[i], x))
                return false;
        return shape_inside(s->part[0], x);
    }
}

/* -- Bounds ---------------------------------------------------------------------------------- */

/* Of a shape that is not a combination; min and max come in infinite. */
static void bounds_simple(const struct shape *s, double min[3], double max[3])
{
    for (int i = 0; i < s->dim; i++) {
        double reach = s->radius;
        if (s->kind == SHAPE_BOX) {
            min[i] = s->a[i];
            max[i] = s->b[i];
            continue;
        }
        if (s->kind == SHAPE_HALF_SPACE) { /* bounded only where the normal lies along an axis */
            if (s->b[i] == 1)
                max[i] = s->a[i];
            else if (s->b[i] == -1)
                min[i] = s->a[i];
            continue;
        }
        if (s->kind == SHAPE_CYLINDER) {
            double along = s->b[i];
            reach = .5 * s->length * fabs(along) + s->radius * sqrt(fmax(0, 1 - along * along));
        }
        min[i] = s->a[i] - reach;
        max[i] = s->a[i] + reach;
    }
}

static void bounds(const struct shape *s, double min[3], double max[3])
{
    for (int i = 0; i < 3; i++) {
        min[i] = i < s->dim ? -INFINITY : 0;
        max[i] = i < s->dim ? INFINITY : 0;
    }
    if (!s->n_part) {
        bounds_simple(s, min, max);
        return;
    }
    bounds(s->part[0], min, max);
    if (s->kind == SHAPE_DIFFERENCE)
        return;
    for (size_t k = 1; k < s->n_part; k++) {
        double low[3], high[3];
        bounds(s->part[k], low, high);
        for (int i = 0; i < s->dim; i++) {
            bool hull = s->kind == SHAPE_UNION;
            min[i] = hull ? fmin(min[i], low[i]) : fmax(min[i], low[i]);
            max[i] = hull ? fmax(max[i], high[i]) : fmin(max[i], high[i]);
        }
    }
}

bool shape_bounds(const struct shape *s, double min[3], double max[3])
{
    bool finite = true;
    bounds(s, min, max);
    for (int i = 0; i < s->dim; i++)
        finite = finite && isfinite(min[i]) && isfinite(max[i]);
    return finite;
}

bool shape_is_box(const struct shape *s)
{
    return s->kind == SHAPE_BOX;
}
