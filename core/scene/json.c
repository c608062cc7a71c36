/* scene/json.c -- a document: reading it, its tree (by cJSON), and messages that point into it.
 * Typed access to its values is in json_get.c, changes by --set in json_set.c. */
#include "scene/json.h"
#include "base/text.h"
#include "scene/json_private.h"
#include "scene/json_scan.h"
#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int place_add(struct document *d, const cJSON *node, size_t value, size_t key, size_t set)
{
    if (d->n_place == d->place_capacity) {
        size_t capacity = d->place_capacity ? 2 * d->place_capacity : 64;
        struct place *grown = realloc(d->place, capacity * sizeof *grown);
        if (!grown)
            return -1;
        d->place = grown;
        d->place_capacity = capacity;
    }
    d->place[d->n_place++] = (struct place){node, NULL, value, key, set};
    return 0;
}

static const struct place *place_of(const struct document *d, const cJSON *node)
{
    for (size_t i = 0; i < d->n_place; i++)
        if (d->place[i].node == node)
            return d->place[i].original ? place_of(d, d->place[i].original) : &d->place[i];
    return NULL;
}

/* -- Pointers -------------------------------------------------------------------------------- */

struct writer {
    char *out;
    size_t size, n;
};

static void put(struct writer *w, char c)
{
    if (w->n + 1 < w->size)
        w->out[w->n++] = c;
    w->out[w->n] = '\0';
}

static void put_key(struct writer *w, const char *key)
{
    put(w, '/');
    for (; *key; key++) {
        if (*key == '~' || *key == '/') {
            put(w, '~');
            put(w, *key == '~' ? '0' : '1');
        } else {
            put(w, (unsigned char)*key < 0x20 ? '?' : *key);
        }
    }
}

/* Writes the path from `from` to `node`, if it is there. */
static bool pointer_from(const cJSON *from, const cJSON *node, struct writer *w)
{
    if (from == node)
        return true;
    size_t length = w->n, i = 0;
    for (const cJSON *child = from->child; child; child = child->next, i++) {
        char index[24];
        snprintf(index, sizeof index, "%zu", i);
        put_key(w, cJSON_IsObject(from) && child->string ? child->string : index);
        if (pointer_from(child, node, w))
            return true;
        w->n = length;
        w->out[length] = '\0';
    }
    return false;
}

const char *document_pointer(const struct document *d, const cJSON *node, char *out, size_t size)
{
    struct writer w = {out, size, 0};
    if (!size)
        return out;
    out[0] = '\0';
    const struct place *place = place_of(d, node);
    if (place)
        node = place->node;
    if (d->root && node)
        pointer_from(d->root, node, &w);
    return out;
}

/* -- Messages -------------------------------------------------------------------------------- */

void document_line(const struct document *d, size_t offset, size_t *line, size_t *column)
{
    scan_line(d->text, offset < d->length ? offset : d->length, line, column);
}

__attribute__((format(printf, 5, 0))) static int fail_at(const struct document *d,
                                                         const cJSON *node, bool at_key,
                                                         struct error *e, const char *format,
                                                         va_list list)
{
    char message[640], pointer[256], where[320];
    const struct place *place = place_of(d, node);
    vsnprintf(message, sizeof message, format, list);
    document_pointer(d, node, pointer, sizeof pointer - 1);
    if (pointer[0])
        strcat(pointer, ":");
    if (place && place->set != SIZE_MAX) {
        snprintf(where, sizeof where, "--set %s", d->set[place->set]);
    } else if (place) {
        size_t line, column;
        document_line(d, at_key ? place->key : place->value, &line, &column);
        snprintf(where, sizeof where, "%s:%zu:%zu", d->path, line, column);
    } else {
        snprintf(where, sizeof where, "%s", d->path);
    }
    return error_set(e, EXIT_USAGE, "%s: %s%s%s", where, pointer, pointer[0] ? " " : "", message);
}

int document_fail(const struct document *d, const cJSON *node, struct error *e, const char *format,
                  ...)
{
    va_list list;
    va_start(list, format);
    int status = fail_at(d, node, false, e, format, list);
    va_end(list);
    return status;
}

int document_fail_key(const struct document *d, const cJSON *node, struct error *e,
                      const char *format, ...)
{
    va_list list;
    va_start(list, format);
    int status = fail_at(d, node, true, e, format, list);
    va_end(list);
    return status;
}

/* -- Parsing --------------------------------------------------------------------------------- */

/* The tree and the scanner's spots, both in the order of the text. */
static int join_spots(struct document *d, const cJSON *node, const struct scan *scan, size_t *next)
{
    if (*next >= scan->n_spot)
        return -1;
    const struct spot *spot = &scan->spot[(*next)++];
    if (place_add(d, node, spot->value, spot->key, SIZE_MAX) < 0)
        return -1;
    for (const cJSON *child = node->child; child; child = child->next)
        if (join_spots(d, child, scan, next) < 0)
            return -1;
    return 0;
}

static int by_key(const void *a, const void *b)
{
    const cJSON *x = *(const cJSON *const *)a, *y = *(const cJSON *const *)b;
    return strcmp(x->string, y->string);
}

/* A key that stands twice in this object: the later one, or NULL. */
static int find_twin(const cJSON *object, const cJSON **twin)
{
    size_t n = 0, i = 0;
    *twin = NULL;
    for (const cJSON *child = object->child; child; child = child->next)
        n++;
    if (n < 2)
        return 0;
    const cJSON **member = calloc(n, sizeof *member);
    if (!member)
        return -1;
    for (const cJSON *child = object->child; child; child = child->next)
        member[i++] = child;
    qsort(member, n, sizeof *member, by_key);
    for (i = 1; i < n && !*twin; i++)
        if (!strcmp(member[i - 1]->string, member[i]->string) &&
            strncmp(member[i]->string, "//", 2) != 0)
            *twin = member[i];
    free(member);
    return 0;
}

static int check_twins(const struct document *d, const cJSON *node, struct error *e)
{
    const cJSON *twin = NULL;
    if (cJSON_IsObject(node) && find_twin(node, &twin) < 0)
        return error_memory(e, "the keys of an object", 0);
    if (twin) {
        const cJSON *first = NULL, *last = NULL;
        for (const cJSON *child = node->child; child; child = child->next)
            if (!strcmp(child->string, twin->string)) {
                first = first ? first : child;
                last = child;
            }
        size_t line, column;
        document_line(d, place_of(d, first)->key, &line, &column);
        return document_fail_key(d, last, e,
                                 "the key stands in this object already, in line %zu, column %zu",
                                 line, column);
    }
    for (const cJSON *child = node->child; child; child = child->next)
        if (check_twins(d, child, e) < 0)
            return -1;
    return 0;
}

static void remove_comments(struct document *d, cJSON *node)
{
    for (cJSON *child = node->child, *next; child; child = next) {
        next = child->next;
        if (cJSON_IsObject(node) && child->string && !strncmp(child->string, "//", 2))
            cJSON_AddItemToArray(d->removed, cJSON_DetachItemViaPointer(node, child));
        else
            remove_comments(d, child);
    }
}

static int build(struct document *d, const struct scan *scan, struct error *e)
{
    size_t next = 0;
    d->root = cJSON_ParseWithLength(d->text, d->length);
    d->removed = cJSON_CreateArray();
    d->aliases = cJSON_CreateArray();
    if (!d->root || !d->removed || !d->aliases || join_spots(d, d->root, scan, &next) < 0)
        return error_memory(e, d->path, d->length);
    if (!cJSON_IsObject(d->root))
        return document_fail(d, d->root, e, "a scene is an object: {\"dimensions\": 2, ...}");
    if (check_twins(d, d->root, e) < 0)
        return -1;
    remove_comments(d, d->root);
    return 0;
}

int document_parse(struct document *d, const char *path, const char *text, size_t n,
                   struct error *e)
{
    struct scan scan;
    *d = (struct document){.path = text_format("%s", path), .length = n};
    d->text = malloc(n + 1);
    if (!d->path || !d->text) {
        document_free(d);
        return error_memory(e, path, n);
    }
    if (n)
        memcpy(d->text, text, n);
    d->text[n] = '\0';
    int status = scan_text(&scan, d->text, n);
    if (status < 0) {
        size_t line, column;
        document_line(d, scan.error_at, &line, &column);
        error_set(e, EXIT_USAGE, "%s:%zu:%zu: %s", path, line, column, scan.error);
    } else {
        status = build(d, &scan, e);
    }
    scan_fini(&scan);
    if (status < 0)
        document_free(d);
    return status;
}

void document_free(struct document *d)
{
    cJSON_Delete(d->aliases);
    cJSON_Delete(d->root);
    cJSON_Delete(d->removed);
    for (size_t i = 0; i < d->n_set; i++)
        free(d->set[i]);
    free(d->set);
    free(d->place);
    free(d->text);
    free(d->path);
    *d = (struct document){0};
}

/* -- Files ----------------------------------------------------------------------------------- */

/* All of a stream, at most DOCUMENT_BYTES and one: the caller sees what is too long. */
static char *read_all(FILE *file, size_t *length)
{
    size_t capacity = (size_t)1 << 16, n = 0;
    char *text = malloc(capacity);
    while (text) {
        n += fread(text + n, 1, capacity - n, file);
        if (n < capacity || n > DOCUMENT_BYTES)
            break;
        capacity *= 2;
        char *grown = realloc(text, capacity);
        if (!grown)
            free(text);
        text = grown;
    }
    *length = n;
    return text;
}

int document_load(struct document *d, const char *path, struct error *e)
{
    struct stat about;
    *d = (struct document){0};
    if (stat(path, &about) < 0)
        return error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(errno));
    if (S_ISDIR(about.st_mode))
        return error_set(e, EXIT_USAGE, "%s: is a folder; give a scene's file", path);
    FILE *file = fopen(path, "rb");
    if (!file)
        return error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(errno));
    size_t n;
    errno = 0;
    char *text = read_all(file, &n);
    int problem = ferror(file) ? errno : 0;
    fclose(file);
    int status;
    if (!text)
        status = error_memory(e, path, n);
    else if (problem)
        status = error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(problem));
    else if (n > DOCUMENT_BYTES)
        status = error_set(e, EXIT_USAGE, "%s: is larger than %zu MiB; a scene is a short text",
                           path, DOCUMENT_BYTES >> 20);
    else
        status = document_parse(d, path, text, n, e);
    free(text);
    return status;
}
