/* scene/functions.h -- functions that a scene brings itself ("functions"): bodies in text files beside it, and
 * what they read, write and may be set to. What a property is, where the scene does not say, is found out
 * when plugins are loaded (plan/bodies.c). */
#ifndef SCENE_FUNCTIONS_H
#define SCENE_FUNCTIONS_H

#include <cjson/cJSON.h>
#include <sph/function.h>
#include <stdbool.h>
#include <stddef.h>

/* The lists of a body, in the words of sph/device.h: the first five of a pair, the others of one particle.
 * Sums may stand in a function of one particle, too. */
enum scene_list {
    LIST_I,
    LIST_J,
    LIST_SUM,
    LIST_MIN,
    LIST_MAX,
    LIST_IN,
    LIST_OUT,
    LIST_INOUT,
    LISTS
};
extern const char *const scene_list_key[LISTS];

/* A name of the body, and the property that it stands for. */
struct scene_value {
    const cJSON *node;
    const char *name, *property;
};

struct scene_body {
    const cJSON *node;                  /* for messages; NULL: there is no such body */
    const char *file, *text;            /* as it was opened, so that an editor finds it */
    const char *prelude_file, *prelude; /* or NULL */
    struct scene_value *value[LISTS];
    size_t n_value[LISTS];
    const char **fail; /* sentences of sph_fail; of one particle */
    size_t n_fail;
};

/* What the scene itself says of a property. */
struct scene_property {
    const cJSON *node;
    const char *name;
    uint32_t type;          /* 0: as others have it */
    const char *unit, *doc; /* NULL: likewise */
    double start;           /* INFINITY: likewise */
    bool work;              /* of no interest in a snapshot */
};

struct scene_function {
    const cJSON *node;
    const char *name, *doc, *source;
    uint32_t shape, dims, reach, self, reals;
    double reach_scale;
    struct scene_body run, before, after;
    struct scene_property *property;
    size_t n_property;
    sph_param *param;
    size_t n_param;
    sph_rate *rate;
    size_t n_rate;
    sph_reduction *reduction;
    size_t n_reduction;
};

/* Whether the body's text has the name, as far as can be told: with macros of its own it may. */
bool scene_body_uses(const struct scene_body *b, const char *name);

#endif
