/* scene/json.h -- a JSON document that knows where its values stand in the text: cJSON for the
 * tree, a locator of our own for line and column, which cJSON does not keep. */
#ifndef SCENE_JSON_H
#define SCENE_JSON_H

#include "base/error.h"
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>

#define DOCUMENT_DEPTH 64
#define DOCUMENT_BYTES ((size_t)64 << 20)

struct place; /* where a node stands: private to json.c */

struct document {
    char *path; /* as the user gave it */
    char *text;
    size_t length;
    cJSON *root;
    char *
        *set; /* the --set arguments applied, for messages about values that are not in the text */
    size_t n_set;
    struct place *place;
    size_t n_place, place_capacity;
    cJSON *removed; /* nodes replaced and comments: kept, so that no address is used twice */
    cJSON *aliases; /* objects made by document_rest */
};

/* Reads and parses. Refuses, naming line and column: files that cannot be read, invalid UTF-8,
 * syntax errors, truncation, nesting deeper than DOCUMENT_DEPTH, duplicate keys, numbers that
 * are not finite, text after the end, over DOCUMENT_BYTES, a value that is not an object.
 * Members whose key begins with "//" are comments: they are left out of the tree. On failure
 * nothing is to be freed. */
int document_load(struct document *d, const char *path, struct error *e);
/* As above from memory (copied); `path` is for messages. */
int document_parse(struct document *d, const char *path, const char *text, size_t n,
                   struct error *e);
void document_free(struct document *d);

/* Applies "a.b.0.c=VALUE": VALUE is JSON, or else a bare word taken as a string; missing objects on
 * the way are made; the index after the last appends to an array. */
int document_set(struct document *d, const char *assignment, struct error *e);

/* "scene.json:12:5: /particles/fluid/fill: " + message; EXIT_USAGE. If the node came from --set,
 * that is named instead of line and column. Returns -1. */
int document_fail(const struct document *d, const cJSON *node, struct error *e, const char *format,
                  ...) __attribute__((format(printf, 4, 5)));
/* As above, pointing at the node's key. */
int document_fail_key(const struct document *d, const cJSON *node, struct error *e,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));
/* JSON pointer of a node ("/particles/fluid"), into out. Returns out. */
const char *document_pointer(const struct document *d, const cJSON *node, char *out, size_t size);
/* Line and column (from 1; in characters) of byte `offset` of the text. */
void document_line(const struct document *d, size_t offset, size_t *line, size_t *column);

/* The path of a file that the document names: relative to the document's folder. The caller frees it;
 * NULL when out of memory. */
char *document_relative(const struct document *d, const char *file);

/* An object with the members of `object` whose key is not known[0..n), for what is left to others
 * (parameters). Its members are references, which messages may point at as at the originals. It
 * belongs to the document. NULL when out of memory. */
const cJSON *document_rest(struct document *d, const cJSON *object, const char *const *known,
                           size_t n);

/* Typed access with errors that name the place. An object's member `key`; `*out` is untouched
 * when the key is absent and !required. Numbers must be finite. */
int json_number(const struct document *d, const cJSON *object, const char *key, bool required,
                double *out, struct error *e);
/* A number > 0; `what` it is: "-0.1 is not a spacing; give a positive number". */
int json_positive(const struct document *d, const cJSON *object, const char *key, bool required,
                  const char *what, double *out, struct error *e);
int json_integer(const struct document *d, const cJSON *object, const char *key, bool required,
                 long long min, long long max, long long *out, struct error *e);
int json_string(const struct document *d, const cJSON *object, const char *key, bool required,
                const char **out, struct error *e);
int json_bool(const struct document *d, const cJSON *object, const char *key, bool required,
              bool *out, struct error *e);
/* 1..3 numbers; their count must be `dim` if dim > 0. */
int json_vector(const struct document *d, const cJSON *object, const char *key, bool required,
                int dim, double out[3], struct error *e);
/* The member `key`, NULL if absent; case matters. */
const cJSON *json_get(const cJSON *object, const char *key);
/* The value is an object, and every key of it one of known[0..n); else
 * "unknown key "fil" (did you mean "fill"?)". */
int json_keys(const struct document *d, const cJSON *object, const char *const *known, size_t n,
              struct error *e);
/* Members that a comparison passes over: `key` of the root (`in` NULL), or of its member `in`. */
struct json_skip {
    const char *in, *key;
};
/* A place where two values differ: what stands there; NULL: nothing. */
struct json_difference {
    const cJSON *was, *is;
    bool order; /* the same keys in another order, from here on */
};
/* Whether they do, and where first. The order of keys counts: it is that of arrays of particles. */
bool json_differ(const cJSON *was, const cJSON *is, const struct json_skip *skip, size_t n,
                 struct json_difference *out);
/* A value in a few words for messages: 12, "text", an object. Returns out. */
#define JSON_BRIEF 72
const char *json_brief(const cJSON *node, char out[JSON_BRIEF]);

#endif
