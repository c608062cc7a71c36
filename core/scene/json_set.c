/* scene/json_set.c -- changes to a document from the command line: "time.end=0.1". A node that is
 * replaced is kept aside until the document is freed: places are known by address. */
#include "base/text.h"
#include "scene/json.h"
#include "scene/json_private.h"
#include "scene/json_scan.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* JSON; or else, unless it begins as only JSON does, the text itself. */
static cJSON *parse_value(const char *text, const char *assignment, struct error *e)
{
    struct scan scan;
    cJSON *value = NULL;
    int status = scan_text(&scan, text, strlen(text));
    if (!text[0])
        error_set(e, EXIT_USAGE, "--set %s: a value is missing behind \"=\"", assignment);
    else if (!status && (value = cJSON_Parse(text)) == NULL)
        error_memory(e, "the value of --set", strlen(text));
    else if (status && (strchr("{[\"", text[0]) || strstr(scan.error, "too large") ||
                        text_invalid_utf8(text, strlen(text)) != (size_t)-1))
        error_set(e, EXIT_USAGE, "--set %s: the value's character %zu: %s", assignment,
                  scan.error_at + 1, scan.error);
    else if (status && (value = cJSON_CreateString(text)) == NULL)
        error_memory(e, "the value of --set", strlen(text));
    scan_fini(&scan);
    return value;
}

static int note_all(struct document *d, const cJSON *node, size_t set)
{
    if (place_add(d, node, 0, 0, set) < 0)
        return -1;
    for (const cJSON *child = node->child; child; child = child->next)
        if (note_all(d, child, set) < 0)
            return -1;
    return 0;
}

/* Index of an array's element from its name; the one after the last may be made. */
static int array_index(const cJSON *array, const char *name, int *index, const char *assignment,
                       struct error *e)
{
    int n = cJSON_GetArraySize(array);
    char *end;
    long value = strtol(name, &end, 10);
    if (end == name || *end || name[0] == '-' || value > n)
        return error_set(e, EXIT_USAGE,
                         "--set %s: \"%s\" is not an index of this array; give 0 to %d", assignment,
                         name, n);
    *index = (int)value;
    return 0;
}

/* Puts `value` under `name` into `parent`, in the place of what stood there. */
static int put_value(struct document *d, cJSON *parent, const char *name, cJSON *value,
                     const char *assignment, struct error *e)
{
    if (cJSON_IsArray(parent)) {
        int index;
        if (array_index(parent, name, &index, assignment, e) < 0)
            return -1;
        cJSON *old = cJSON_DetachItemFromArray(parent, index);
        if (old)
            cJSON_AddItemToArray(d->removed, old);
        if (!cJSON_InsertItemInArray(parent, index, value))
            return error_memory(e, "--set", 0);
        return 0;
    }
    cJSON *old = cJSON_DetachItemFromObjectCaseSensitive(parent, name);
    if (old)
        cJSON_AddItemToArray(d->removed, old);
    if (!cJSON_AddItemToObject(parent, name, value))
        return error_memory(e, "--set", 0);
    return 0;
}

/* The child `name` of *at, made if missing. */
static int step(struct document *d, cJSON **at, const char *name, const char *assignment,
                struct error *e)
{
    cJSON *child = NULL;
    if (cJSON_IsArray(*at)) {
        int index;
        if (array_index(*at, name, &index, assignment, e) < 0)
            return -1;
        child = cJSON_GetArrayItem(*at, index);
    } else {
        child = cJSON_GetObjectItemCaseSensitive(*at, name);
    }
    if (!child) {
        child = cJSON_CreateObject();
        if (!child || put_value(d, *at, name, child, assignment, e) < 0) {
            cJSON_Delete(child);
            return -1;
        }
        if (place_add(d, child, 0, 0, d->n_set - 1) < 0)
            return error_memory(e, "--set", 0);
    }
    if (!cJSON_IsObject(child) && !cJSON_IsArray(child)) {
        char brief[JSON_BRIEF];
        return error_set(e, EXIT_USAGE, "--set %s: \"%s\" is %s, which has no members", assignment,
                         name, json_brief(child, brief));
    }
    *at = child;
    return 0;
}

/* Walks down `path` (cut at its dots) and puts the value at its end. The value is taken over. */
static int assign(struct document *d, char *path, cJSON *value, const char *assignment,
                  struct error *e)
{
    cJSON *at = d->root;
    char *name = path, *dot;
    int depth = 1;
    while ((dot = strchr(name, '.')) != NULL) {
        *dot = '\0';
        if (!name[0] || ++depth > DOCUMENT_DEPTH) {
            cJSON_Delete(value);
            return error_set(e, EXIT_USAGE, "--set %s: %s", assignment,
                             name[0] ? "nested too deeply" : "a name is missing before a dot");
        }
        if (step(d, &at, name, assignment, e) < 0) {
            cJSON_Delete(value);
            return -1;
        }
        name = dot + 1;
    }
    int status = -1;
    if (!name[0])
        error_set(e, EXIT_USAGE, "--set %s: a name is missing before \"=\"", assignment);
    else
        status = put_value(d, at, name, value, assignment, e);
    if (status < 0)
        cJSON_Delete(value);
    else if (note_all(d, value, d->n_set - 1) < 0)
        status = error_memory(e, "--set", 0);
    return status;
}

int document_set(struct document *d, const char *assignment, struct error *e)
{
    const char *equals = strchr(assignment, '=');
    if (!equals || equals == assignment)
        return error_set(e, EXIT_USAGE, "--set %s: give PATH=VALUE, as in --set time.end=0.1",
                         assignment);
    cJSON *value = parse_value(equals + 1, assignment, e);
    if (!value)
        return -1;
    char **grown = realloc(d->set, (d->n_set + 1) * sizeof *grown);
    char *path = text_format("%.*s", (int)(equals - assignment), assignment);
    char *copy = text_format("%s", assignment);
    if (grown)
        d->set = grown;
    if (!grown || !path || !copy) {
        free(path);
        free(copy);
        cJSON_Delete(value);
        return error_memory(e, "--set", strlen(assignment));
    }
    d->set[d->n_set++] = copy;
    int status = assign(d, path, value, assignment, e);
    free(path);
    return status;
}
