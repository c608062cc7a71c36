/* scene/json.h -- a JSON document that knows where its values stand in the text: cJSON for the tree,
 * a locator of our own for line and column, which cJSON does not keep. */
#ifndef SCENE_JSON_H
#define SCENE_JSON_H

#include "base/error.h"
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>

struct document {
    char *path; /* as the user gave it */
    char *text;
    size_t length;
    cJSON *root;
    char **set; /* the --set arguments applied, for messages about values that are not in the text */
    size_t n_set;
};

/* Reads and parses. Refuses, naming line and column: files that cannot be read, invalid UTF-8, syntax
 * errors, truncation, nesting deeper than 64, duplicate keys, text after the end, over 64 MiB. */
int document_load(struct document *d, const char *path, struct error *e);
/* As above from memory (copied); `path` is for messages. */
int document_parse(struct document *d, const char *path, const char *text, size_t n, struct error *e);
void document_free(struct document *d);

/* Applies "a.b.0.c=VALUE": VALUE is JSON, or else a bare word taken as a string; missing objects on
 * the way are made. */
int document_set(struct document *d, const char *assignment, struct error *e);

/* "scene.json:12:5: /particles/fluid/fill: " + message; EXIT_USAGE. If the node came from --set, that is
 * named instead of line and column. Returns -1. */
int document_fail(const struct document *d, const cJSON *node, struct error *e, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* JSON pointer of a node ("/particles/fluid"), into out. */
const char *document_pointer(const struct document *d, const cJSON *node, char *out, size_t size);

/* Typed access with errors that name the place. An object's member `key`; `*out` is untouched when the
 * key is absent and !required. Numbers must be finite. */
int json_number(const struct document *d, const cJSON *object, const char *key, bool required, double *out, struct error *e);
int json_integer(const struct document *d, const cJSON *object, const char *key, bool required, long long min, long long max, long long *out, struct error *e);
int json_string(const struct document *d, const cJSON *object, const char *key, bool required, const char **out, struct error *e);
int json_bool(const struct document *d, const cJSON *object, const char *key, bool required, bool *out, struct error *e);
/* 1..3 numbers; count in *n must come out equal to `dim` if dim > 0. */
int json_vector(const struct document *d, const cJSON *object, const char *key, bool required, int dim, double out[3], struct error *e);
/* Every key of the object is one of known[0..n); else "unknown key "fil" (did you mean "fill"?)". Keys
 * that begin with "//" are comments. */
int json_keys(const struct document *d, const cJSON *object, const char *const *known, size_t n, struct error *e);

#endif
