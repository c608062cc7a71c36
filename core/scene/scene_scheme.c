/* scene/scene_scheme.c -- "scheme": its name, its parameters, and the edits of its recipe. */
#include "base/text.h"
#include "scene/scene_private.h"
#include <string.h>

static const char *const edit_keys[] = {"insert", "delete", "replace",   "with", "operation",
                                        "before", "after",  "function",  "of",   "at",
                                        "to",     "from",   "expression"};

int scene_arrays(struct scene *s, const cJSON *node, const char *key, const char ***out, size_t *n,
                 struct error *e)
{
    char brief[JSON_BRIEF], hint[512];
    const char *names[64];
    if (scene_strings(s, node, key, out, n, e) < 0)
        return -1;
    size_t known = s->n_array < COUNT(names) ? s->n_array : COUNT(names);
    for (size_t i = 0; i < known; i++)
        names[i] = s->array[i].name;
    const cJSON *list = json_get(node, key);
    const cJSON *item = cJSON_IsArray(list) ? list->child : list;
    if (list && *n == 0)
        return document_fail(s->doc, list, e,
                             "no array is named; leave \"%s\" out where all are meant", key);
    for (size_t k = 0; k < *n; k++, item = item->next) {
        size_t i = 0;
        while (i < s->n_array && strcmp(s->array[i].name, (*out)[k]) != 0)
            i++;
        if (i == s->n_array)
            return document_fail(s->doc, item, e, "unknown array %s%s", json_brief(item, brief),
                                 text_suggest(hint, sizeof hint, (*out)[k], names, known));
    }
    return 0;
}

/* Where a new step goes: before or after another, or to the end. */
static int compile_anchor(struct scene *s, const cJSON *node, struct scene_edit *x, struct error *e)
{
    const char *before = NULL, *after = NULL;
    if (json_string(s->doc, node, "before", false, &before, e) < 0 ||
        json_string(s->doc, node, "after", false, &after, e) < 0)
        return -1;
    if (before && after)
        return document_fail(s->doc, node, e, "give \"before\" or \"after\", not both");
    x->anchor = before ? before : after;
    x->kind = before ? EDIT_INSERT_BEFORE : after ? EDIT_INSERT_AFTER : EDIT_APPEND;
    return 0;
}

static int compile_operation(struct scene *s, const cJSON *node, struct scene_edit *x,
                             struct error *e)
{
    static const char *const words[] = {"assignment", "summation", "integration"};
    size_t word = 0;
    if (scene_word(s, node, "operation", "operation", words, COUNT(words), &word, e) < 0 ||
        json_string(s->doc, node, "function", false, &x->function, e) < 0 ||
        json_string(s->doc, node, "expression", false, &x->expression, e) < 0 ||
        json_string(s->doc, node, "of", x->expression != NULL, &x->of, e) < 0)
        return -1;
    x->operation = words[word];
    if (!x->function == !x->expression)
        return document_fail(s->doc, node, e, "give one of \"function\" and \"expression\"");
    if (x->expression && word != 0)
        return document_fail(s->doc, json_get(node, "expression"), e,
                             "an expression is assigned; a %s needs a function", words[word]);
    return compile_anchor(s, node, x, e);
}

static int compile_verb(struct scene *s, const cJSON *node, struct scene_edit *x, struct error *e)
{
    if (json_get(node, "delete")) {
        static const char *const keys[] = {"delete"};
        x->kind = EDIT_DELETE;
        if (json_keys(s->doc, node, keys, 1, e) < 0)
            return -1;
        return json_string(s->doc, node, "delete", true, &x->anchor, e);
    }
    if (json_get(node, "replace")) {
        x->kind = EDIT_REPLACE;
        if (json_string(s->doc, node, "replace", true, &x->anchor, e) < 0)
            return -1;
        return json_string(s->doc, node, "with", true, &x->function, e);
    }
    if (json_get(node, "insert")) {
        if (json_string(s->doc, node, "insert", true, &x->function, e) < 0 ||
            json_string(s->doc, node, "of", false, &x->of, e) < 0)
            return -1;
        return compile_anchor(s, node, x, e);
    }
    return compile_operation(s, node, x, e);
}

/* Keys that the verb does not know, among those that some verb does. */
static int check_keys(struct scene *s, const cJSON *node, const char *verb, struct error *e)
{
    static const struct {
        const char *verb, *key;
    } wrong[] = {{"replace", "before"},     {"replace", "after"}, {"replace", "function"},
                 {"replace", "expression"}, {"insert", "with"},   {"insert", "function"},
                 {"insert", "expression"},  {"operation", "with"}};
    for (size_t i = 0; i < COUNT(wrong); i++) {
        const cJSON *child = json_get(node, wrong[i].key);
        if (child && !strcmp(wrong[i].verb, verb))
            return document_fail_key(s->doc, child, e, "\"%s\" does not go with \"%s\"",
                                     wrong[i].key, verb);
    }
    return 0;
}

static int compile_edit(struct scene *s, const cJSON *node, struct scene_edit *x, struct error *e)
{
    static const char *const verbs[] = {"insert", "delete", "replace", "operation"};
    static const char *const moments[] = {"start", "evaluate", "finish"};
    const char *verb = NULL;
    size_t n = 0, moment = 1;
    x->node = node;
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e, "an edit is an object");
    for (size_t i = 0; i < COUNT(verbs); i++)
        if (json_get(node, verbs[i])) {
            verb = verbs[i];
            n++;
        }
    if (n != 1)
        return document_fail(
            s->doc, node, e,
            "an edit has one of \"insert\", \"delete\", \"replace\" and \"operation\"");
    if (check_keys(s, node, verb, e) < 0 || compile_verb(s, node, x, e) < 0 ||
        scene_word(s, node, "at", "moment", moments, COUNT(moments), &moment, e) < 0 ||
        scene_arrays(s, node, "to", &x->to, &x->n_to, e) < 0 ||
        scene_arrays(s, node, "from", &x->from, &x->n_from, e) < 0)
        return -1;
    x->at = moments[moment];
    x->params = document_rest(s->doc, node, edit_keys, COUNT(edit_keys));
    return x->params ? 0 : error_memory(e, "an edit", 0);
}

int scene_scheme(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"name", "edit", "fuse"};
    const cJSON *item;
    char brief[JSON_BRIEF];
    s->scheme.node = node;
    s->scheme.fuse = true;
    if (!node)
        return document_fail(s->doc, s->doc->root, e, "the key \"scheme\" is missing");
    if (!cJSON_IsObject(node) && !cJSON_IsString(node))
        return document_fail(s->doc, node, e,
                             "%s is not a scheme; give its name, or an object with \"name\"",
                             json_brief(node, brief));
    s->scheme.params = document_rest(s->doc, node, keys, COUNT(keys));
    if (!s->scheme.params)
        return error_memory(e, "the scheme", 0);
    if (cJSON_IsString(node))
        return json_string(s->doc, s->doc->root, "scheme", true, &s->scheme.name, e);
    /* Without a name the recipe is what "edit" puts together. */
    const cJSON *edit = json_get(node, "edit");
    if (json_bool(s->doc, node, "fuse", false, &s->scheme.fuse, e) < 0 ||
        json_string(s->doc, node, "name", edit == NULL, &s->scheme.name, e) < 0)
        return -1;
    if (!edit)
        return 0;
    if (!cJSON_IsArray(edit))
        return document_fail(s->doc, edit, e, "give an array of edits");
    s->scheme.edit = scene_alloc(s, (size_t)cJSON_GetArraySize(edit), sizeof *s->scheme.edit, e);
    if (!s->scheme.edit)
        return -1;
    cJSON_ArrayForEach(item, edit)
    {
        if (compile_edit(s, item, &s->scheme.edit[s->scheme.n_edit], e) < 0)
            return -1;
        s->scheme.n_edit++;
    }
    return 0;
}
