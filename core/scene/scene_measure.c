/* scene/scene_measure.c -- "compare" and "probes": what is to be measured. */
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

/* Member "where", if given: an expression of a particle's position. */
static int compile_where(struct scene *s, const cJSON *node, const char **out, struct error *e)
{
    const cJSON *where = json_get(node, "where");
    if (!where)
        return 0;
    if (scene_check_expression(s, where, SCENE_REGION_VARIABLES, e) < 0)
        return -1;
    *out = where->valuestring;
    return 0;
}

/* The list under `node`: its length, and room for it; an absent one is empty. */
static int begin_list(struct scene *s, const cJSON *node, const char *what, size_t size, void **out,
                      struct error *e)
{
    if (!node)
        return 0;
    if (!cJSON_IsArray(node))
        return document_fail(s->doc, node, e, "give an array of %s", what);
    *out = scene_alloc(s, (size_t)cJSON_GetArraySize(node), size, e);
    return *out ? 0 : -1;
}

int scene_compares(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"array", "exact", "where", "fields"};
    const cJSON *item;
    void *list = NULL;
    if (begin_list(s, node, "comparisons", sizeof *s->compare, &list, e) < 0)
        return -1;
    s->compare = list;
    cJSON_ArrayForEach(item, node)
    {
        struct scene_compare *c = &s->compare[s->n_compare];
        c->node = item;
        if (!cJSON_IsObject(item))
            return document_fail(s->doc, item, e, "a comparison is an object");
        if (scene_array_name(s, item, "array", true, &c->array, e) < 0 ||
            json_string(s->doc, item, "exact", true, &c->exact, e) < 0 ||
            compile_where(s, item, &c->where, e) < 0 ||
            scene_strings(s, item, "fields", &c->fields, &c->n_fields, e) < 0)
            return -1;
        c->params = document_rest(s->doc, item, keys, COUNT(keys));
        if (!c->params)
            return error_memory(e, "a comparison", 0);
        s->n_compare++;
    }
    return 0;
}

static int compile_crossing(struct scene *s, const cJSON *node, struct scene_probe *p,
                            struct error *e)
{
    static const char *const keys[] = {"of", "shell", "level"};
    const cJSON *crossing = json_get(node, "crossing");
    p->kind = PROBE_CROSSING;
    if (json_keys(s->doc, crossing, keys, COUNT(keys), e) < 0 ||
        json_string(s->doc, crossing, "of", true, &p->of, e) < 0 ||
        json_positive(s->doc, crossing, "shell", true, "width", &p->shell, e) < 0)
        return -1;
    return json_number(s->doc, crossing, "level", true, &p->level, e);
}

static int compile_probe(struct scene *s, const cJSON *node, struct scene_probe *p, struct error *e)
{
    static const char *const keys[] = {"name", "array", "where", "expected",
                                       "mean", "min",   "max",   "crossing"};
    static const char *const kinds[] = {"mean", "min", "max", "crossing"};
    static const enum probe_kind kind_of[] = {PROBE_MEAN, PROBE_MIN, PROBE_MAX, PROBE_CROSSING};
    size_t n = 0, kind = 0;
    p->node = node;
    p->expected = NAN;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_string(s->doc, node, "name", true, &p->name, e) < 0 ||
        scene_array_name(s, node, "array", true, &p->array, e) < 0 ||
        compile_where(s, node, &p->where, e) < 0 ||
        json_number(s->doc, node, "expected", false, &p->expected, e) < 0)
        return -1;
    for (size_t i = 0; i < COUNT(kinds); i++)
        if (json_get(node, kinds[i])) {
            kind = i;
            n++;
        }
    if (n != 1)
        return document_fail(s->doc, node, e,
                             "a probe has one of \"mean\", \"min\", \"max\" and \"crossing\"");
    if (kind_of[kind] == PROBE_CROSSING)
        return compile_crossing(s, node, p, e);
    p->kind = kind_of[kind];
    return json_string(s->doc, node, kinds[kind], true, &p->of, e);
}

int scene_probes(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (begin_list(s, node, "probes", sizeof *s->probe, &list, e) < 0)
        return -1;
    s->probe = list;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_probe(s, item, &s->probe[s->n_probe], e) < 0)
            return -1;
        for (size_t i = 0; i < s->n_probe; i++)
            if (!strcmp(s->probe[i].name, s->probe[s->n_probe].name))
                return document_fail(s->doc, json_get(item, "name"), e,
                                     "an earlier probe has this name");
        s->n_probe++;
    }
    return 0;
}
