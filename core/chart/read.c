/* chart/read.c -- the chart file: its scene, what all its runs share, what their error is, its limits.
 * Axes are read in read_axes.c, pictures and peers in read_pictures.c. */
#include "chart/chart.h"

#include "base/text.h"
#include "chart/row.h"
#include <stdlib.h>
#include <string.h>

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

int chart_array(const struct chart *c, const cJSON *node, const char *what, size_t *n,
                struct error *e)
{
    char brief[JSON_BRIEF];
    *n = 0;
    if (!node)
        return 0;
    if (!cJSON_IsArray(node))
        return document_fail(&c->doc, node, e, "%s is not a list of %s", json_brief(node, brief),
                             what);
    *n = (size_t)cJSON_GetArraySize(node);
    return 0;
}

int chart_read_set(const struct chart *c, const cJSON *object, char ***set, size_t *n,
                   struct error *e)
{
    char brief[JSON_BRIEF];
    if (!object)
        return 0;
    if (!cJSON_IsObject(object))
        return document_fail(&c->doc, object, e, "%s is not an object of paths and values",
                             json_brief(object, brief));
    const size_t more = (size_t)cJSON_GetArraySize(object);
    char **grown = realloc(*set, (*n + more + 1) * sizeof *grown);
    if (!grown)
        return error_memory(e, "a chart", more * sizeof *grown);
    *set = grown;
    for (const cJSON *child = object->child; child; child = child->next) {
        if (!child->string[0] || strchr(child->string, '='))
            return document_fail_key(
                &c->doc, child, e, "\"%s\" is no path; give one as in \"time.end\"", child->string);
        char *value = cJSON_PrintUnformatted(child);
        char *text = value ? text_format("%s=%s", child->string, value) : NULL;
        cJSON_free(value);
        if (!text)
            return error_memory(e, "a chart", strlen(child->string));
        (*set)[(*n)++] = text;
    }
    return 0;
}

/* -- The scene --------------------------------------------------------------------------------- */

static int read_scene(struct chart *c, struct error *e)
{
    const char *file = NULL;
    if (json_string(&c->doc, c->doc.root, "scene", true, &file, e))
        return -1;
    c->scene_path = document_relative(&c->doc, file);
    if (!c->scene_path)
        return error_memory(e, "a path", strlen(file));
    struct error inner = {0};
    if (document_load(&c->scene, c->scene_path, &inner))
        return document_fail(&c->doc, json_get(c->doc.root, "scene"), e, "the scene: %s",
                             inner.text);
    return 0;
}

static int read_load(struct chart *c, struct error *e)
{
    const cJSON *list = json_get(c->doc.root, "load"), *item;
    size_t n;
    if (chart_array(c, list, "plugins", &n, e))
        return -1;
    c->load = calloc(n + 1, sizeof *c->load);
    if (!c->load)
        return error_memory(e, "a chart", n);
    cJSON_ArrayForEach(item, list)
    {
        char brief[JSON_BRIEF];
        if (!cJSON_IsString(item) || !item->valuestring[0])
            return document_fail(&c->doc, item, e, "%s is no plugin's name or path",
                                 json_brief(item, brief));
        char *plugin = strchr(item->valuestring, '/')
                           ? document_relative(&c->doc, item->valuestring)
                           : text_format("%s", item->valuestring);
        if (!plugin)
            return error_memory(e, "a path", 1);
        c->load[c->n_load++] = plugin;
    }
    return 0;
}

/* A path is tried on the scene here: one mistake is one sentence, not a failure of every run. */
static int try_sets(struct chart *c, struct error *e)
{
    struct document trial;
    if (document_parse(&trial, c->scene.path, c->scene.text, c->scene.length, e))
        return -1;
    const cJSON *set = json_get(c->doc.root, "set");
    int status = 0;
    for (size_t i = 0; i < c->n_set && !status; i++) {
        struct error inner = {0};
        if (document_set(&trial, c->set[i], &inner))
            status =
                document_fail_key(&c->doc, cJSON_GetArrayItem(set, (int)i), e, "%s", inner.text);
    }
    document_free(&trial);
    return status;
}

/* -- The error --------------------------------------------------------------------------------- */

static char *copy(const char *text)
{
    return text ? text_format("%s", text) : NULL;
}

static int read_error(struct chart *c, struct error *e)
{
    static const char *const keys[] = {"of", "norm", "path", "probe"};
    const struct document *d = &c->doc;
    const cJSON *node = json_get(d->root, "error");
    const char *of = NULL, *norm = "l1_rel", *path = NULL, *probe = NULL;
    if (!node)
        return document_fail(d, d->root, e,
                             "the key \"error\" is missing: which number is it? "
                             "{\"of\": \"ARRAY.FIELD\", \"norm\": \"l1_rel\"}");
    c->error.node = node;
    if (json_keys(d, node, keys, COUNT(keys), e) || json_string(d, node, "of", false, &of, e) ||
        json_string(d, node, "norm", false, &norm, e) ||
        json_string(d, node, "path", false, &path, e) ||
        json_string(d, node, "probe", false, &probe, e))
        return -1;
    if (!of + !path + !probe != 2)
        return document_fail(d, node, e, "give one of \"of\", \"path\" and \"probe\"");
    if (!of && json_get(node, "norm"))
        return document_fail_key(d, json_get(node, "norm"), e, "only \"of\" has a norm");
    char hint[128];
    bool known = false;
    for (size_t i = 0; i < ROW_NORMS; i++)
        known = known || strcmp(norm, row_norm_name[i]) == 0;
    if (!known)
        return document_fail(d, json_get(node, "norm"), e, "\"%s\" is no norm%s", norm,
                             text_suggest(hint, sizeof hint, norm, row_norm_name, ROW_NORMS));
    struct chart_measure *m = &c->error;
    m->of = copy(of);
    m->norm = of ? copy(norm) : NULL;
    m->path = copy(path);
    m->probe = copy(probe);
    m->column = of      ? text_format("%s.%s", of, norm)
                : probe ? text_format("probe.%s", probe)
                        : copy(path);
    m->title = of      ? text_format("%s of %s", norm, of)
               : probe ? text_format("error of %s", probe)
                       : copy(path);
    return m->column && m->title ? 0 : error_memory(e, "a chart", 1);
}

static int read_limits(struct chart *c, struct error *e)
{
    static const char *const keys[] = {"seconds"};
    const struct document *d = &c->doc;
    const cJSON *limit = json_get(d->root, "limit");
    c->seconds = c->unstable = c->drift = (double)INFINITY;
    if (limit && (json_keys(d, limit, keys, COUNT(keys), e) ||
                  json_positive(d, limit, "seconds", true, "time", &c->seconds, e)))
        return -1;
    return json_positive(d, d->root, "unstable", false, "error", &c->unstable, e) ||
                   json_positive(d, d->root, "drift", false, "drift", &c->drift, e)
               ? -1
               : 0;
}

/* -- All of it --------------------------------------------------------------------------------- */

int chart_read(struct chart *c, const char *path, const char *const *only, size_t n_only,
               struct error *e)
{
    static const char *const keys[] = {"$schema", "title",  "scene", "load",  "set",
                                       "axes",    "skip",   "error", "limit", "unstable",
                                       "drift",   "charts", "peers"};
    *c = (struct chart){0};
    if (document_load(&c->doc, path, e))
        return -1;
    const struct document *d = &c->doc;
    if (json_keys(d, d->root, keys, COUNT(keys), e) ||
        json_string(d, d->root, "title", false, &c->title, e) || read_scene(c, e) ||
        read_load(c, e) || chart_read_set(c, json_get(d->root, "set"), &c->set, &c->n_set, e) ||
        try_sets(c, e) || chart_read_axes(c, e) || read_error(c, e) || read_limits(c, e) ||
        chart_expand(c, only, n_only, e) || chart_read_pictures(c, e) || chart_read_peers(c, e))
        return -1;
    return 0;
}

static void free_texts(char **text, size_t n)
{
    for (size_t i = 0; i < n; i++)
        free(text[i]);
    free(text);
}

static void axis_free(struct chart_axis *a)
{
    for (size_t i = 0; i < a->n_value; i++) {
        free_texts(a->value[i].set, a->value[i].n_set);
        free(a->value[i].label);
        free(a->value[i].option);
    }
    free(a->value);
}

void chart_free(struct chart *c)
{
    chart_pictures_free(c);
    for (size_t i = 0; i < c->n_run; i++) {
        free(c->run[i].value);
        free(c->run[i].settings);
    }
    free(c->run);
    for (size_t i = 0; i < c->n_skip; i++)
        chart_choice_free(c, &c->skip[i]);
    free(c->skip);
    for (size_t i = 0; i < c->n_axis; i++)
        axis_free(&c->axis[i]);
    free(c->axis);
    free_texts(c->load, c->n_load);
    free_texts(c->set, c->n_set);
    free(c->scene_path);
    free(c->error.column);
    free(c->error.title);
    free(c->error.of);
    free(c->error.norm);
    free(c->error.path);
    free(c->error.probe);
    document_free(&c->scene);
    document_free(&c->doc);
    *c = (struct chart){0};
}
