/* scene/scene_particles.c -- "particles": the arrays with their materials, fields and columns. */
#include "base/text.h"
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

/* The members of `node` as fields. */
static int compile_fields(struct scene *s, const cJSON *node, struct scene_field **out, size_t *n,
                          struct error *e)
{
    const cJSON *item;
    if (!node)
        return 0;
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e, "give an object: a value for each property");
    struct scene_field *field = scene_alloc(s, (size_t)cJSON_GetArraySize(node), sizeof *field, e);
    if (!field)
        return -1;
    size_t i = 0;
    cJSON_ArrayForEach(item, node)
    {
        if (scene_name(s, item, true, e) < 0 || scene_check_field(s, item, e) < 0)
            return -1;
        if (!strcmp(item->string, "x"))
            return document_fail_key(s->doc, item, e, "positions are given by \"fill\"");
        if (!strcmp(item->string, "v") &&
            (cJSON_IsArray(item) ? cJSON_GetArraySize(item) : 1) != s->dim)
            return document_fail(s->doc, item, e, "%d component%s of a vector in %d dimension%s",
                                 cJSON_IsArray(item) ? cJSON_GetArraySize(item) : 1,
                                 cJSON_IsArray(item) && cJSON_GetArraySize(item) != 1 ? "s" : "",
                                 s->dim, s->dim == 1 ? "" : "s");
        field[i++] = (struct scene_field){item->string, item};
    }
    *out = field;
    *n = i;
    return 0;
}

/* {"type": .., "value": ..}, or the value alone: an array makes a vector. */
static int compile_column(struct scene *s, const cJSON *node, struct scene_column *column,
                          struct error *e)
{
    static const char *const keys[] = {"type", "value"};
    static const char *const types[] = {"scalar", "vector", "int32"};
    static const uint32_t type_of[] = {SPH_SCALAR, SPH_VECTOR, SPH_INT32};
    static const char *const taken[] = {"x", "m", "h", "id", "array"};
    size_t type = 0;
    if (scene_name(s, node, false, e) < 0)
        return -1;
    for (size_t i = 0; i < COUNT(taken); i++)
        if (!strcmp(node->string, taken[i]))
            return document_fail_key(s->doc, node, e, "every array has the column \"%s\" already",
                                     taken[i]);
    column->name = node->string;
    column->node = node;
    if (cJSON_IsObject(node)) {
        if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
            scene_word(s, node, "type", "type", types, COUNT(types), &type, e) < 0)
            return -1;
        column->node = json_get(node, "value");
        if (!column->node)
            return document_fail(s->doc, node, e, "the key \"value\" is missing");
    } else {
        type = cJSON_IsArray(node) ? 1 : 0;
    }
    column->type = type_of[type];
    if (scene_check_field(s, column->node, e) < 0)
        return -1;
    int given = cJSON_IsArray(column->node) ? cJSON_GetArraySize(column->node) : 1;
    int wanted = column->type == SPH_VECTOR ? s->dim : 1;
    if (given != wanted)
        return document_fail(s->doc, column->node, e, "%d component%s; give %d", given,
                             given == 1 ? "" : "s", wanted);
    return 0;
}

static int compile_columns(struct scene *s, const cJSON *node, struct scene_array *a,
                           struct error *e)
{
    const cJSON *item;
    if (!node)
        return 0;
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e, "give an object: a value for each column");
    a->column = scene_alloc(s, (size_t)cJSON_GetArraySize(node), sizeof *a->column, e);
    if (!a->column)
        return -1;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_column(s, item, &a->column[a->n_column], e) < 0)
            return -1;
        a->n_column++;
    }
    return 0;
}

/* One fill, or an array of them. */
static int compile_fills(struct scene *s, const cJSON *node, struct scene_array *a, struct error *e)
{
    if (cJSON_IsArray(node) && !node->child)
        return document_fail(s->doc, node, e, "no fill: the array has no particles");
    size_t n = cJSON_IsArray(node) ? (size_t)cJSON_GetArraySize(node) : 1;
    a->fill = scene_alloc(s, n, sizeof *a->fill, e);
    a->fill_field = a->fill ? scene_alloc(s, n, sizeof *a->fill_field, e) : NULL;
    a->n_fill_field = a->fill_field ? scene_alloc(s, n, sizeof *a->n_fill_field, e) : NULL;
    if (!a->n_fill_field)
        return -1;
    const cJSON *item = cJSON_IsArray(node) ? node->child : node;
    for (size_t k = 0; k < n; k++, item = item->next) {
        if (scene_fill(s, item, &a->fill[k], e) < 0 ||
            compile_fields(s, json_get(item, "fields"), &a->fill_field[k], &a->n_fill_field[k], e) <
                0)
            return -1;
        a->n_fill++;
    }
    return 0;
}

static int compile_material_of(struct scene *s, const cJSON *node, struct scene_array *a,
                               struct error *e)
{
    const char *name = NULL, *names[64];
    char brief[JSON_BRIEF], hint[512];
    a->material = SIZE_MAX;
    if (json_string(s->doc, node, "material", false, &name, e) < 0)
        return -1;
    if (!name)
        return 0;
    for (size_t i = 0; i < s->n_material; i++)
        if (!strcmp(s->material[i].name, name)) {
            a->material = i;
            return 0;
        }
    size_t n = s->n_material < COUNT(names) ? s->n_material : COUNT(names);
    for (size_t i = 0; i < n; i++)
        names[i] = s->material[i].name;
    const cJSON *where = json_get(node, "material");
    return document_fail(s->doc, where, e, "unknown material %s%s", json_brief(where, brief),
                         n ? text_suggest(hint, sizeof hint, name, names, n)
                           : "; \"materials\" defines none");
}

static int compile_array(struct scene *s, const cJSON *node, struct scene_array *a, struct error *e)
{
    static const char *const keys[] = {"material", "fill", "fields", "columns", "h_over_dx"};
    a->name = node->string;
    a->node = node;
    a->h_factor = 1.3;
    if (scene_name(s, node, true, e) < 0 || json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        compile_material_of(s, node, a, e) < 0 ||
        json_positive(s->doc, node, "h_over_dx", false, "ratio of smoothing length to spacing",
                      &a->h_factor, e) < 0)
        return -1;
    const cJSON *fill = json_get(node, "fill");
    if (!fill)
        return document_fail(s->doc, node, e, "the key \"fill\" is missing");
    if (compile_fields(s, json_get(node, "fields"), &a->field, &a->n_field, e) < 0 ||
        compile_columns(s, json_get(node, "columns"), a, e) < 0)
        return -1;
    return compile_fills(s, fill, a, e);
}

int scene_particles(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    if (!node)
        return document_fail(s->doc, s->doc->root, e, "the key \"particles\" is missing");
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e, "give an object: a name for each array of particles");
    if (!node->child)
        return document_fail(s->doc, node, e, "the scene is empty: it has no array of particles");
    s->array = scene_alloc(s, (size_t)cJSON_GetArraySize(node), sizeof *s->array, e);
    if (!s->array)
        return -1;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_array(s, item, &s->array[s->n_array], e) < 0)
            return -1;
        s->n_array++;
    }
    return 0;
}
