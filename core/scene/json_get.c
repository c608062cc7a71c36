/* scene/json_get.c -- typed access to a document's values, with messages that say what stands there
 * and what should. */
#include "base/text.h"
#include "scene/json.h"
#include "scene/json_private.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

const cJSON *json_get(const cJSON *object, const char *key)
{
    return cJSON_GetObjectItemCaseSensitive(object, key);
}

const char *json_brief(const cJSON *node, char out[JSON_BRIEF])
{
    if (cJSON_IsNumber(node)) {
        snprintf(out, JSON_BRIEF, "%.15g", node->valuedouble);
    } else if (cJSON_IsString(node)) {
        size_t n = 0, limit = JSON_BRIEF - 8;
        const char *s = node->valuestring;
        out[n++] = '"';
        while (*s && n < limit) {
            out[n++] = (unsigned char)*s < 0x20 || *s == 0x7f ? ' ' : *s;
            s++;
        }
        if (*s) { /* cut before the character that does not fit */
            while (n > 1 && ((unsigned char)*s & 0xc0) == 0x80) {
                n--;
                s--;
            }
            memcpy(out + n, "...", 3);
            n += 3;
        }
        out[n++] = '"';
        out[n] = '\0';
    } else {
        const char *word = cJSON_IsObject(node)  ? "an object"
                           : cJSON_IsArray(node) ? "an array"
                           : cJSON_IsTrue(node)  ? "true"
                           : cJSON_IsFalse(node) ? "false"
                                                 : "null";
        snprintf(out, JSON_BRIEF, "%s", word);
    }
    return out;
}

/* The member in *node (NULL if absent and not required). */
static int member(const struct document *d, const cJSON *object, const char *key, bool required,
                  const cJSON **node, struct error *e)
{
    *node = json_get(object, key);
    if (!*node && required)
        return document_fail(d, object, e, "the key \"%s\" is missing", key);
    return 0;
}

static int fail_type(const struct document *d, const cJSON *node, const char *what, struct error *e)
{
    char brief[JSON_BRIEF];
    return document_fail(d, node, e, "%s is not %s", json_brief(node, brief), what);
}

int json_number(const struct document *d, const cJSON *object, const char *key, bool required,
                double *out, struct error *e)
{
    const cJSON *node;
    if (member(d, object, key, required, &node, e) < 0)
        return -1;
    if (!node)
        return 0;
    if (!cJSON_IsNumber(node) || !isfinite(node->valuedouble))
        return fail_type(d, node, "a number", e);
    *out = node->valuedouble;
    return 0;
}

int json_positive(const struct document *d, const cJSON *object, const char *key, bool required,
                  const char *what, double *out, struct error *e)
{
    double value = NAN;
    char brief[JSON_BRIEF];
    if (json_number(d, object, key, required, &value, e) < 0)
        return -1;
    if (value <= 0)
        return document_fail(d, json_get(object, key), e, "%s is not a %s; give a positive number",
                             json_brief(json_get(object, key), brief), what);
    if (!isnan(value))
        *out = value;
    return 0;
}

int json_integer(const struct document *d, const cJSON *object, const char *key, bool required,
                 long long min, long long max, long long *out, struct error *e)
{
    const cJSON *node;
    char brief[JSON_BRIEF];
    if (member(d, object, key, required, &node, e) < 0)
        return -1;
    if (!node)
        return 0;
    /* 2^53: beyond it a double holds no longer every whole number. */
    if (!cJSON_IsNumber(node) || node->valuedouble != floor(node->valuedouble) ||
        fabs(node->valuedouble) > 9007199254740992.0)
        return fail_type(d, node, "a whole number", e);
    long long value = (long long)node->valuedouble;
    if (value < min)
        return document_fail(d, node, e, "%s is too small; give a whole number of at least %lld",
                             json_brief(node, brief), min);
    if (value > max)
        return document_fail(d, node, e, "%s is too large; give a whole number of at most %lld",
                             json_brief(node, brief), max);
    *out = value;
    return 0;
}

int json_string(const struct document *d, const cJSON *object, const char *key, bool required,
                const char **out, struct error *e)
{
    const cJSON *node;
    if (member(d, object, key, required, &node, e) < 0)
        return -1;
    if (!node)
        return 0;
    if (!cJSON_IsString(node))
        return fail_type(d, node, "text in double quotes", e);
    if (!node->valuestring[0])
        return document_fail(d, node, e, "the text is empty");
    *out = node->valuestring;
    return 0;
}

int json_bool(const struct document *d, const cJSON *object, const char *key, bool required,
              bool *out, struct error *e)
{
    const cJSON *node;
    if (member(d, object, key, required, &node, e) < 0)
        return -1;
    if (!node)
        return 0;
    if (!cJSON_IsBool(node))
        return fail_type(d, node, "true or false", e);
    *out = cJSON_IsTrue(node);
    return 0;
}

int json_vector(const struct document *d, const cJSON *object, const char *key, bool required,
                int dim, double out[3], struct error *e)
{
    const cJSON *node, *item;
    double value[3] = {0, 0, 0};
    if (member(d, object, key, required, &node, e) < 0)
        return -1;
    if (!node)
        return 0;
    if (!cJSON_IsArray(node))
        return fail_type(d, node, "an array of numbers", e);
    int n = cJSON_GetArraySize(node), i = 0;
    if (dim > 0 && n != dim)
        return document_fail(d, node, e, "%d number%s in %d dimension%s; give %d", n,
                             n == 1 ? "" : "s", dim, dim == 1 ? "" : "s", dim);
    if (n < 1 || n > 3)
        return document_fail(d, node, e, "%d numbers; give 1 to 3", n);
    cJSON_ArrayForEach(item, node)
    {
        if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
            return fail_type(d, item, "a number", e);
        value[i++] = item->valuedouble;
    }
    memcpy(out, value, sizeof value);
    return 0;
}

int json_keys(const struct document *d, const cJSON *object, const char *const *known, size_t n,
              struct error *e)
{
    char hint[512], word[64];
    if (!cJSON_IsObject(object))
        return fail_type(d, object, "an object", e);
    for (const cJSON *child = object->child; child; child = child->next) {
        size_t i = 0;
        while (i < n && strcmp(child->string, known[i]) != 0)
            i++;
        if (i < n)
            continue;
        cJSON name = {.type = cJSON_String, .valuestring = child->string};
        char brief[JSON_BRIEF];
        snprintf(word, sizeof word, "%s", child->string);
        return document_fail_key(d, child, e, "unknown key %s%s", json_brief(&name, brief),
                                 text_suggest(hint, sizeof hint, word, known, n));
    }
    return 0;
}

/* A reference to `node` under its own key: shares the value and the children. */
static cJSON *reference(struct document *d, const cJSON *node)
{
    cJSON *copy = cJSON_CreateNull();
    if (!copy)
        return NULL;
    char *key = text_format("%s", node->string);
    if (!key || place_add(d, copy, 0, 0, SIZE_MAX) < 0) {
        cJSON_free(key);
        cJSON_Delete(copy);
        return NULL;
    }
    d->place[d->n_place - 1].original = node;
    copy->type = node->type | cJSON_IsReference;
    copy->valuestring = node->valuestring;
    copy->valueint = node->valueint;
    copy->valuedouble = node->valuedouble;
    copy->child = node->child;
    copy->string = key;
    return copy;
}

char *document_relative(const struct document *d, const char *file)
{
    const char *slash = strrchr(d->path, '/');
    if (file[0] == '/' || !slash)
        return text_format("%s", file);
    return text_format("%.*s/%s", (int)(slash - d->path), d->path, file);
}

const cJSON *document_rest(struct document *d, const cJSON *object, const char *const *known,
                           size_t n)
{
    cJSON *rest = cJSON_CreateObject();
    if (!rest || place_add(d, rest, 0, 0, SIZE_MAX) < 0) {
        cJSON_Delete(rest);
        return NULL;
    }
    d->place[d->n_place - 1].original = object;
    cJSON_AddItemToArray(d->aliases, rest);
    for (const cJSON *child = object->child; child; child = child->next) {
        size_t i = 0;
        while (i < n && strcmp(child->string, known[i]) != 0)
            i++;
        if (i < n)
            continue;
        cJSON *copy = reference(d, child);
        if (!copy)
            return NULL;
        cJSON_AddItemToArray(rest, copy); /* keeps the key that it has */
    }
    return rest;
}
