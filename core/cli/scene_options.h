/* cli/scene_options.h -- what run, plan and check share: a scene, its plugins, --load and --set. */
#ifndef CLI_SCENE_OPTIONS_H
#define CLI_SCENE_OPTIONS_H

#include "plan/plan.h"
#include "registry/loader.h"
#include <argp.h>

struct scene_options {
    const char *path;    /* of the scene */
    bool optional;       /* none need be given ... */
    const char *text;    /* ... as it may have come with these: its text, NULL: the file's, */
    char *const *before; /* [n_before] and --set that go before `set` */
    size_t n_before;
    const char *load[64]; /* --load */
    const char *set[64];  /* --set */
    size_t n_load, n_set;
    const char *precision; /* --precision, or NULL */
    bool device_opencl;    /* --device opencl[:device_number] */
    size_t device_number;
    bool device_numbered; /* N was given */
    bool device_only;     /* --device-only */
};

/* An argp child that fills a struct scene_options (its input). */
extern const struct argp scene_argp;

/* A scene with everything that it needs loaded and resolved. */
struct loaded {
    struct document doc;
    struct scene scene;
    struct registry registry;
    struct plan plan;
    bool has_doc, has_scene, has_registry, has_plan;
};

/* Reads the document, applies --set, compiles, loads the plugins, makes the plan. On failure the caller still
 * calls loaded_free. */
int loaded_make(struct loaded *l, const struct scene_options *o, bool guarded, struct error *e);
/* The same without the plan. */
int loaded_open(struct loaded *l, const struct scene_options *o, struct error *e);
void loaded_free(struct loaded *l);

#endif
