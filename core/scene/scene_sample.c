/* scene/scene_sample.c -- the parts that "compare", "probes" and "profiles" share: when, where, of what, about
 * which center. Turns JSON into structures, touches nothing else. */
#include "base/text.h"
#include "scene/scene_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

int scene_where(struct scene *s, const cJSON *node, const char **out, struct error *e)
{
    const cJSON *where = json_get(node, "where");
    if (!where)
        return 0;
    if (scene_check_expression(s, where, SCENE_REGION_VARIABLES, e) < 0)
        return -1;
    *out = where->valuestring;
    return 0;
}

int scene_list(struct scene *s, const cJSON *node, const char *what, size_t size, void **out,
               struct error *e)
{
    if (!node)
        return 0;
    if (!cJSON_IsArray(node))
        return document_fail(s->doc, node, e, "give an array of %s", what);
    *out = scene_alloc(s, (size_t)cJSON_GetArraySize(node), size, e);
    return *out ? 0 : -1;
}

/* -- When -------------------------------------------------------------------------------------- */

static int check_moment(const struct scene *s, const cJSON *node, double time, struct error *e)
{
    if (time < s->time.begin || time > s->time.end)
        return document_fail(s->doc, node, e, "the run goes from %.15g to %.15g; %.15g is outside",
                             s->time.begin, s->time.end, time);
    return 0;
}

/* A number or rising ones. */
static int compile_at(struct scene *s, const cJSON *node, struct scene_moments *out,
                      struct error *e)
{
    const size_t n = cJSON_IsArray(node) ? (size_t)cJSON_GetArraySize(node) : 1;
    const cJSON *item = cJSON_IsArray(node) ? node->child : node;
    double *at = scene_alloc(s, n, sizeof *at, e);
    char brief[JSON_BRIEF];
    if (!at)
        return -1;
    for (size_t i = 0; i < n; i++, item = item->next) {
        if (!cJSON_IsNumber(item))
            return document_fail(s->doc, item, e, "%s is not a time; give a number",
                                 json_brief(item, brief));
        at[i] = item->valuedouble;
        if (check_moment(s, item, at[i], e))
            return -1;
        if (i && at[i] <= at[i - 1])
            return document_fail(s->doc, item, e, "times must rise");
    }
    out->at = at;
    out->n_at = n;
    return 0;
}

int scene_moments(struct scene *s, const cJSON *node, bool with_at, struct scene_moments *out,
                  struct error *e)
{
    long long steps = 0;
    *out = (struct scene_moments){.every = INFINITY};
    if (json_get(node, "steps") && json_get(node, "every"))
        return document_fail(s->doc, node, e, "give \"steps\" or \"every\", not both");
    if (json_positive(s->doc, node, "every", false, "time interval", &out->every, e) < 0)
        return -1;
    if (with_at)
        return json_get(node, "at") ? compile_at(s, json_get(node, "at"), out, e) : 0;
    if (json_integer(s->doc, node, "steps", false, 1, 1ll << 52, &steps, e) < 0)
        return -1;
    out->steps = (uint64_t)steps;
    return 0;
}

int scene_time_of(struct scene *s, const cJSON *node, double *out, struct error *e)
{
    if (json_number(s->doc, node, "time", false, out, e) < 0)
        return -1;
    return isnan(*out) ? 0 : check_moment(s, json_get(node, "time"), *out, e);
}

/* -- About ------------------------------------------------------------------------------------- */

int scene_about(struct scene *s, const cJSON *node, struct scene_about *out, struct error *e)
{
    static const char *const axes[] = {"x", "y", "z"};
    size_t axis = 3;
    *out = (struct scene_about){.axis = -1};
    if (json_vector(s->doc, node, "center", false, s->dim, out->center, e) < 0 ||
        scene_word(s, node, "axis", "axis", axes, COUNT(axes), &axis, e) < 0)
        return -1;
    if (axis < 3 && s->dim < 3)
        return document_fail(s->doc, json_get(node, "axis"), e,
                             "an axis is for 3 dimensions; the scene has %d", s->dim);
    out->axis = axis < 3 ? (int)axis : -1;
    return 0;
}

double scene_radius(const struct scene_about *about, int dim, const double *x)
{
    double r2 = 0.0;
    for (int c = 0; c < dim; c++)
        if (c != about->axis)
            r2 += (x[c] - about->center[c]) * (x[c] - about->center[c]);
    return sqrt(r2);
}

int scene_along(struct scene *s, const cJSON *node, enum along *out, struct error *e)
{
    static const char *const words[] = {"x", "y", "z", "r"};
    size_t word = ALONG_X;
    if (scene_word(s, node, "along", "coordinate", words, COUNT(words), &word, e) < 0)
        return -1;
    if (word < ALONG_R && (int)word >= s->dim)
        return document_fail(s->doc, json_get(node, "along"), e, "there is no %s in %d dimension%s",
                             words[word], s->dim, s->dim == 1 ? "" : "s");
    *out = (enum along)word;
    return 0;
}

/* -- Points ------------------------------------------------------------------------------------ */

int scene_sample(struct scene *s, const cJSON *node, struct scene_sample *out, struct error *e)
{
    if (!json_get(node, "array"))
        return document_fail(s->doc, node, e, "the key \"array\" is missing");
    if (!json_get(node, "of"))
        return document_fail(s->doc, node, e, "the key \"of\" is missing");
    if (scene_arrays(s, node, "array", &out->array, &out->n_array, e) < 0 ||
        scene_strings(s, node, "of", &out->of, &out->n_of, e) < 0 ||
        json_bool(s->doc, node, "plain", false, &out->plain, e) < 0 ||
        scene_about(s, node, &out->about, e) < 0)
        return -1;
    if (out->n_array == 0 || out->n_of == 0)
        return document_fail(s->doc, json_get(node, out->n_of ? "array" : "of"), e,
                             "the list is empty");
    for (size_t i = 0; i < out->n_array; i++)
        for (size_t k = 0; k < i; k++)
            if (!strcmp(out->array[i], out->array[k]))
                return document_fail(s->doc, json_get(node, "array"), e,
                                     "\"%s\" stands there twice", out->array[i]);
    for (size_t i = 0; i < out->n_of; i++)
        for (size_t k = 0; k < i; k++)
            if (!strcmp(out->of[i], out->of[k]))
                return document_fail(s->doc, json_get(node, "of"), e, "\"%s\" stands there twice",
                                     out->of[i]);
    return 0;
}

/* Particles stay within the domain: nothing is to be seen beyond it. */
static int check_point(const struct scene *s, const cJSON *node, const double *x, struct error *e)
{
    for (int c = 0; s->box.bounded && c < s->dim; c++)
        if (x[c] < s->box.min[c] || x[c] > s->box.max[c])
            return document_fail(s->doc, node, e,
                                 "the point lies outside of the domain: %c = %.15g is not within "
                                 "%.15g to %.15g",
                                 "xyz"[c], x[c], s -> box.min[c], s->box.max[c]);
    return 0;
}

int scene_points(struct scene *s, const cJSON *node, struct scene_sample *out, struct error *e)
{
    const cJSON *at = json_get(node, "at");
    const bool list = cJSON_IsArray(at) && cJSON_IsArray(at->child);
    const size_t n = list ? (size_t)cJSON_GetArraySize(at) : 1;
    double *point = scene_alloc(s, 3 * n, sizeof *point, e);
    if (!point)
        return -1;
    if (!list && (json_vector(s->doc, node, "at", true, s->dim, point, e) < 0 ||
                  check_point(s, at, point, e)))
        return -1;
    size_t i = 0;
    for (const cJSON *item = list ? at->child : NULL; item; item = item->next, i++) {
        if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != s->dim)
            return document_fail(s->doc, item, e, "a point is an array of %d number%s", s->dim,
                                 s->dim == 1 ? "" : "s");
        const cJSON *number = item->child;
        for (int c = 0; c < s->dim; c++, number = number->next) {
            if (!cJSON_IsNumber(number))
                return document_fail(s->doc, number, e, "a coordinate is a number");
            point[3 * i + (size_t)c] = number->valuedouble;
        }
        if (check_point(s, item, point + 3 * i, e))
            return -1;
    }
    out->point = point;
    out->n_point = n;
    return 0;
}

#define LINE_MOST 1000000

int scene_line(struct scene *s, const cJSON *node, struct scene_sample *out, struct error *e)
{
    double end[2][3] = {{0}};
    long long n = 101;
    if (json_vector(s->doc, node, "from", true, s->dim, end[0], e) < 0 ||
        json_vector(s->doc, node, "to", true, s->dim, end[1], e) < 0 ||
        json_integer(s->doc, node, "points", false, 2, LINE_MOST, &n, e) < 0 ||
        check_point(s, json_get(node, "from"), end[0], e) ||
        check_point(s, json_get(node, "to"), end[1], e))
        return -1;
    double *point = scene_alloc(s, 3 * (size_t)n, sizeof *point, e);
    if (!point)
        return -1;
    for (size_t i = 0; i < (size_t)n; i++)
        for (size_t c = 0; c < 3; c++)
            point[3 * i + c] = end[0][c] + (end[1][c] - end[0][c]) * ((double)i / (double)(n - 1));
    out->point = point;
    out->n_point = (size_t)n;
    return 0;
}

/* -- References and names ---------------------------------------------------------------------- */

int scene_reference(struct scene *s, const cJSON *node, const struct scene_moments *when,
                    struct scene_reference *out, struct error *e)
{
    static const char *const keys[] = {"table", "time", "value", "of", "scale_time", "scale"};
    const cJSON *reference = json_get(node, "reference");
    *out = (struct scene_reference){.scale_time = 1.0, .scale = 1.0};
    if (!reference)
        return 0;
    if (json_keys(s->doc, reference, keys, COUNT(keys), e) < 0)
        return -1;
    out->table = json_get(reference, "table");
    if (!out->table)
        return document_fail(s->doc, reference, e, "the key \"table\" is missing");
    if (!moments_any(when))
        return document_fail(s->doc, reference, e,
                             "a reference is a course in time: give \"every\" or \"steps\"");
    if (json_string(s->doc, reference, "time", false, &out->time, e) < 0 ||
        json_string(s->doc, reference, "value", false, &out->value, e) < 0 ||
        json_string(s->doc, reference, "of", false, &out->of, e) < 0 ||
        json_positive(s->doc, reference, "scale_time", false, "scale", &out->scale_time, e) < 0)
        return -1;
    return json_number(s->doc, reference, "scale", false, &out->scale, e);
}

static char file_letter(char c)
{
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return plain || c == '-' || c == '.' || (unsigned char)c >= 0x80 ? c : '_';
}

bool scene_same_file(const char *a, const char *b)
{
    for (; *a && file_letter(*a) == file_letter(*b); a++)
        b++;
    return !*a && !*b;
}

char *scene_file_part(const char *name)
{
    char *out = text_format("%s", name);
    for (char *c = out; c && *c; c++)
        *c = file_letter(*c);
    return out;
}
