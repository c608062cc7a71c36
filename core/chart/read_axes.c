/* chart/read_axes.c -- the axes of a chart file, their values, and choices among them. */
#include "chart/chart.h"

#include "base/text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

double chart_number(const char *text)
{
    char *end;
    const double value = strtod(text, &end);
    return end > text && !*end && isfinite(value) ? value : (double)NAN;
}

/* -- Values ------------------------------------------------------------------------------------ */

/* A number or a text as people write it: .2, "kdk", true. */
static char *plain(const cJSON *node)
{
    if (cJSON_IsString(node))
        return text_format("%s", node->valuestring);
    char *json = cJSON_PrintUnformatted(node), *text = json ? text_format("%s", json) : NULL;
    cJSON_free(json);
    return text;
}

static bool is_plain(const cJSON *node)
{
    return cJSON_IsNumber(node) || cJSON_IsBool(node) ||
           (cJSON_IsString(node) && node->valuestring[0]);
}

static int put_set(struct chart_value *v, const char *path, const cJSON *node, struct error *e)
{
    char *json = cJSON_PrintUnformatted(node);
    v->set = calloc(1, sizeof *v->set);
    if (json && v->set)
        v->set[0] = text_format("%s=%s", path, json);
    cJSON_free(json);
    if (!v->set || !v->set[0])
        return error_memory(e, "a chart", 1);
    v->n_set = 1;
    return 0;
}

/* What `sph run` would refuse is refused here, once. */
static int put_option(const struct chart *c, const struct chart_axis *a, struct chart_value *v,
                      const cJSON *node, struct error *e)
{
    static const char *const precisions[] = {"double", "mixed", "single"};
    char hint[128], brief[JSON_BRIEF];
    v->option = plain(node);
    if (!v->option)
        return error_memory(e, "a chart", 1);
    if (strcmp(a->option, "threads") == 0) {
        const double n = cJSON_IsNumber(node) ? node->valuedouble : 0;
        if (!(n >= 1 && n <= 4096 && n <= floor(n)))
            return document_fail(&c->doc, node, e,
                                 "%s is no number of threads; give a whole number of at least 1",
                                 json_brief(node, brief));
    } else if (strcmp(a->option, "precision") == 0) {
        for (size_t i = 0; i < COUNT(precisions); i++)
            if (strcmp(v->option, precisions[i]) == 0)
                return 0;
        return document_fail(
            &c->doc, node, e, "%s is no precision%s", json_brief(node, brief),
            text_suggest(hint, sizeof hint, v->option, precisions, COUNT(precisions)));
    }
    return 0;
}

/* {"label": ..., "set": {...}}, or where the axis has a path or an option a plain value, or
 * {"label": ..., "value": ANY}. */
static int read_value(struct chart *c, const struct chart_axis *a, const char *path,
                      const cJSON *node, struct chart_value *v, struct error *e)
{
    static const char *const set_keys[] = {"label", "set"};
    static const char *const value_keys[] = {"label", "value"};
    const struct document *d = &c->doc;
    const bool sets = !path && !a->option;
    const cJSON *value = node, *label = node;
    char brief[JSON_BRIEF];
    if (cJSON_IsObject(node)) {
        if (json_keys(d, node, sets ? set_keys : value_keys, 2, e))
            return -1;
        label = json_get(node, "label");
        value = json_get(node, sets ? "set" : "value");
        if (!label || !value)
            return document_fail(d, node, e, "the key \"%s\" is missing",
                                 !label ? "label"
                                 : sets ? "set"
                                        : "value");
    } else if (sets) {
        return document_fail(d, node, e,
                             "%s: this axis has neither \"set\" nor \"option\", so each value is "
                             "{\"label\": ..., \"set\": {...}}",
                             json_brief(node, brief));
    }
    if (!is_plain(label))
        return document_fail(d, label, e, "%s is no label; give a number or a text%s",
                             json_brief(label, brief),
                             label == node ? ", or {\"label\": ..., \"value\": ...}" : "");
    if (a->option && !is_plain(value))
        return document_fail(d, value, e, "%s is no value of an option", json_brief(value, brief));
    v->label = plain(label);
    if (!v->label)
        return error_memory(e, "a chart", 1);
    text_one_line(v->label);
    v->number = chart_number(v->label);
    if (a->option)
        return put_option(c, a, v, value, e);
    return sets ? chart_read_set(c, value, &v->set, &v->n_set, e) : put_set(v, path, value, e);
}

/* The changes of a value, tried on the scene as the chart has it. */
static int try_value(const struct chart *c, const struct chart_value *v, const cJSON *node,
                     struct error *e)
{
    struct document trial;
    struct error inner = {0};
    if (document_parse(&trial, c->scene.path, c->scene.text, c->scene.length, e))
        return -1;
    int status = 0;
    for (size_t i = 0; i < c->n_set && !status; i++)
        status = document_set(&trial, c->set[i], &inner);
    for (size_t i = 0; i < v->n_set && !status; i++)
        status = document_set(&trial, v->set[i], &inner);
    document_free(&trial);
    return status ? document_fail(&c->doc, node, e, "%s", inner.text) : 0;
}

/* -- Axes -------------------------------------------------------------------------------------- */

static int read_values(struct chart *c, struct chart_axis *a, const char *path, const cJSON *list,
                       struct error *e)
{
    const cJSON *item;
    size_t n;
    if (chart_array(c, list, "values", &n, e))
        return -1;
    if (n == 0)
        return document_fail(&c->doc, list, e, "an axis without values makes no run");
    a->value = calloc(n, sizeof *a->value);
    if (!a->value)
        return error_memory(e, "a chart", n * sizeof *a->value);
    cJSON_ArrayForEach(item, list)
    {
        struct chart_value *v = &a->value[a->n_value++];
        if (read_value(c, a, path, item, v, e) || try_value(c, v, item, e))
            return -1;
        for (size_t i = 0; i + 1 < a->n_value; i++)
            if (strcmp(a->value[i].label, v->label) == 0)
                return document_fail(&c->doc, item, e, "the label \"%s\" stands twice on this axis",
                                     v->label);
    }
    return 0;
}

static int read_axis(struct chart *c, const cJSON *node, struct chart_axis *a, struct error *e)
{
    static const char *const keys[] = {"name", "set", "option", "values"};
    static const char *const options[] = {"precision", "threads", "device"};
    const struct document *d = &c->doc;
    const char *path = NULL;
    char hint[128];
    if (json_keys(d, node, keys, COUNT(keys), e) ||
        json_string(d, node, "name", true, &a->name, e) ||
        json_string(d, node, "set", false, &path, e) ||
        json_string(d, node, "option", false, &a->option, e))
        return -1;
    if (path && a->option)
        return document_fail_key(d, json_get(node, "option"), e,
                                 "an axis has \"set\" or \"option\", not both");
    if (path && strchr(path, '='))
        return document_fail(d, json_get(node, "set"), e,
                             "\"%s\" is no path; give one as in \"time.cfl\"", path);
    if (strchr(a->name, '='))
        return document_fail(d, json_get(node, "name"), e,
                             "\"%s\": a name has no \"=\", which --only uses", a->name);
    for (size_t i = 0; i < c->n_axis; i++)
        if (&c->axis[i] != a && strcmp(c->axis[i].name, a->name) == 0)
            return document_fail(d, json_get(node, "name"), e, "there is an axis \"%s\" already",
                                 a->name);
    bool known = !a->option;
    for (size_t i = 0; i < COUNT(options) && !known; i++)
        known = strcmp(a->option, options[i]) == 0;
    if (!known)
        return document_fail(d, json_get(node, "option"), e,
                             "\"%s\" is no option that a chart may vary%s", a->option,
                             text_suggest(hint, sizeof hint, a->option, options, COUNT(options)));
    if (!json_get(node, "values"))
        return document_fail(d, node, e, "the key \"values\" is missing");
    return read_values(c, a, path, json_get(node, "values"), e);
}

static int read_skip(struct chart *c, struct error *e)
{
    const cJSON *list = json_get(c->doc.root, "skip"), *item;
    size_t n;
    if (chart_array(c, list, "combinations", &n, e))
        return -1;
    c->skip = calloc(n + 1, sizeof *c->skip);
    if (!c->skip)
        return error_memory(e, "a chart", n);
    cJSON_ArrayForEach(item, list)
    {
        if (cJSON_IsObject(item) && !item->child)
            return document_fail(&c->doc, item, e, "a combination of nothing skips all runs");
        if (chart_read_choice(c, item, &c->skip[c->n_skip++], e))
            return -1;
    }
    return 0;
}

int chart_read_axes(struct chart *c, struct error *e)
{
    const cJSON *list = json_get(c->doc.root, "axes"), *item;
    size_t n;
    if (!list)
        return document_fail(&c->doc, c->doc.root, e, "the key \"axes\" is missing");
    if (chart_array(c, list, "axes", &n, e))
        return -1;
    if (n == 0)
        return document_fail(&c->doc, list, e, "a chart has at least one axis");
    c->axis = calloc(n, sizeof *c->axis);
    if (!c->axis)
        return error_memory(e, "a chart", n * sizeof *c->axis);
    cJSON_ArrayForEach(item, list)
    {
        c->n_axis++;
        if (read_axis(c, item, &c->axis[c->n_axis - 1], e))
            return -1;
    }
    return read_skip(c, e);
}

/* -- Choices ----------------------------------------------------------------------------------- */

int chart_axis_of(const struct chart *c, const cJSON *node, const char *name, size_t *axis,
                  struct error *e)
{
    char hint[512];
    for (*axis = 0; *axis < c->n_axis; ++*axis)
        if (strcmp(c->axis[*axis].name, name) == 0)
            return 0;
    const char **known = calloc(c->n_axis, sizeof *known);
    if (!known)
        return error_memory(e, "a message", 1);
    for (size_t i = 0; i < c->n_axis; i++)
        known[i] = c->axis[i].name;
    text_suggest(hint, sizeof hint, name, known, c->n_axis);
    free(known);
    if (!node)
        return error_set(e, EXIT_USAGE, "there is no axis \"%s\"%s", name, hint);
    return document_fail_key(&c->doc, node, e, "there is no axis \"%s\"%s", name, hint);
}

/* The value of an axis by its label; a number may be written in another way (.20 for .2). */
static int find_label(const struct chart_axis *a, const char *label, size_t *value)
{
    const double number = chart_number(label);
    for (*value = 0; *value < a->n_value; ++*value)
        if (strcmp(a->value[*value].label, label) == 0 ||
            fabs(a->value[*value].number - number) <= 0)
            return 0;
    return -1;
}

static const char *other_labels(const struct chart_axis *a, const char *label, char *hint,
                                size_t size)
{
    const char **known = calloc(a->n_value, sizeof *known);
    hint[0] = '\0';
    for (size_t i = 0; known && i < a->n_value; i++)
        known[i] = a->value[i].label;
    if (known)
        text_suggest(hint, size, label, known, a->n_value);
    free(known);
    return hint;
}

int chart_label_of(const struct chart *c, size_t axis, const cJSON *node, size_t *value,
                   struct error *e)
{
    const struct chart_axis *a = &c->axis[axis];
    char brief[JSON_BRIEF], hint[512];
    char *label = is_plain(node) ? plain(node) : NULL;
    int status = label ? find_label(a, label, value) : -1;
    if (status)
        document_fail(&c->doc, node, e, "%s is no label of axis \"%s\"%s", json_brief(node, brief),
                      a->name, label ? other_labels(a, label, hint, sizeof hint) : "");
    free(label);
    return status;
}

int chart_choice_make(const struct chart *c, struct chart_choice *choice, struct error *e)
{
    choice->has = calloc(c->n_axis, sizeof *choice->has);
    if (!choice->has)
        return error_memory(e, "a chart", c->n_axis);
    for (size_t i = 0; i < c->n_axis; i++) {
        choice->has[i] = malloc(c->axis[i].n_value);
        if (!choice->has[i])
            return error_memory(e, "a chart", c->axis[i].n_value);
        memset(choice->has[i], true, c->axis[i].n_value);
    }
    return 0;
}

void chart_choice_free(const struct chart *c, struct chart_choice *choice)
{
    for (size_t i = 0; choice->has && i < c->n_axis; i++)
        free(choice->has[i]);
    free(choice->has);
    choice->has = NULL;
}

bool chart_choice_has(const struct chart *c, const struct chart_choice *choice,
                      const struct chart_run *r)
{
    for (size_t i = 0; i < c->n_axis; i++)
        if (!choice->has[i][r->value[i]])
            return false;
    return true;
}

int chart_read_choice(struct chart *c, const cJSON *node, struct chart_choice *choice,
                      struct error *e)
{
    char brief[JSON_BRIEF];
    if (chart_choice_make(c, choice, e))
        return -1;
    if (node && !cJSON_IsObject(node))
        return document_fail(&c->doc, node, e, "%s is not an object of axes and labels",
                             json_brief(node, brief));
    for (const cJSON *child = node ? node->child : NULL; child; child = child->next) {
        size_t axis, value;
        if (chart_axis_of(c, child, child->string, &axis, e))
            return -1;
        memset(choice->has[axis], false, c->axis[axis].n_value);
        if (!cJSON_IsArray(child)) {
            if (chart_label_of(c, axis, child, &value, e))
                return -1;
            choice->has[axis][value] = true;
            continue;
        }
        for (const cJSON *item = child->child; item; item = item->next) {
            if (chart_label_of(c, axis, item, &value, e))
                return -1;
            choice->has[axis][value] = true;
        }
    }
    return 0;
}
