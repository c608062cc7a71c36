/* cli/scene_options.c -- a scene from the command line: --load, --set, and the road from file to
 * plan. */
#include "cli/scene_options.h"
#include "domain/ranks.h"
#include "domain/same_plugins.h"
#include "plan/bodies.h"
#include <stdlib.h>
#include <string.h>

enum { KEY_LOAD = 'l', KEY_SET = 's', KEY_PRECISION = 512, KEY_DEVICE, KEY_DEVICE_ONLY };

static const struct argp_option options[] = {
    {"load", KEY_LOAD, "PLUGIN", 0, "Load a plugin, by name or path, besides those the scene names",
     0},
    {"set", KEY_SET, "PATH=VALUE", 0, "Change the scene: --set time.end=0.1 --set scheme.name=NAME",
     0},
    {"precision", KEY_PRECISION, "WORD", 0,
     "Of the arithmetic: double, mixed or single (default: the scene's, or its scheme's)", 0},
    {"device", KEY_DEVICE, "cpu|opencl[:N]", 0,
     "Where to compute (default: cpu); `sph info --devices' lists those of OpenCL", 0},
    {"device-only", KEY_DEVICE_ONLY, NULL, 0,
     "Refuse a scene that can not run on the device, instead of running it on the processor", 0},
    {0},
};

static void parse_device(struct scene_options *o, const char *text, struct argp_state *state)
{
    char *end = NULL;
    o->device_opencl = strncmp(text, "opencl", 6) == 0;
    o->device_number = 0;
    o->device_numbered = o->device_opencl && text[6] == ':';
    if (o->device_opencl && text[6] == ':' && text[7] >= '0' && text[7] <= '9')
        o->device_number = strtoul(text + 7, &end, 10);
    if (strcmp(text, "cpu") != 0 && strcmp(text, "opencl") != 0 && !(end && *end == '\0'))
        argp_error(state,
                   "--device: \"%s\" is neither cpu nor opencl, nor opencl:N with N a number",
                   text);
}

static error_t parse(int key, char *arg, struct argp_state *state)
{
    struct scene_options *o = state->input;
    switch (key) {
    case KEY_LOAD:
        if (o->n_load == sizeof o->load / sizeof o->load[0])
            argp_error(state, "too many --load");
        o->load[o->n_load++] = arg;
        return 0;
    case KEY_SET:
        if (o->n_set == sizeof o->set / sizeof o->set[0])
            argp_error(state, "too many --set");
        o->set[o->n_set++] = arg;
        return 0;
    case KEY_PRECISION:
        if (strcmp(arg, "double") != 0 && strcmp(arg, "mixed") != 0 && strcmp(arg, "single") != 0)
            argp_error(state, "--precision: \"%s\" is none of double, mixed and single", arg);
        o->precision = arg;
        return 0;
    case KEY_DEVICE:
        parse_device(o, arg, state);
        return 0;
    case KEY_DEVICE_ONLY:
        o->device_only = true;
        return 0;
    case ARGP_KEY_ARG:
        if (o->path)
            argp_error(state, "one scene at a time: \"%s\" and \"%s\"", o->path, arg);
        o->path = arg;
        return 0;
    case ARGP_KEY_NO_ARGS:
        if (o->optional)
            return 0;
        argp_error(state, "no scene is given");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp scene_argp = {.options = options, .parser = parse};

/* A plugin that the scene names: a path is relative to the scene, as those of its other files are;
 * a name may have come in by --load, from wherever its file stands. */
static int load_named(struct loaded *l, const char *plugin, struct error *e)
{
    if (registry_plugin(&l->registry, plugin))
        return 0;
    if (!strchr(plugin, '/'))
        return loader_load(&l->registry, plugin, e);
    char *path = document_relative(&l->doc, plugin);
    if (!path)
        return error_memory(e, "a path", strlen(plugin));
    int status = loader_load(&l->registry, path, e);
    free(path);
    return status;
}

/* The scene, and all plugins that it and the command line name. */
static int load(struct loaded *l, const struct scene_options *o, struct error *e)
{
    if (o->text ? document_parse(&l->doc, o->path, o->text, strlen(o->text), e)
                : document_load(&l->doc, o->path, e))
        return -1;
    l->has_doc = true;
    for (size_t i = 0; i < o->n_before; i++)
        if (document_set(&l->doc, o->before[i], e))
            return -1;
    for (size_t i = 0; i < o->n_set; i++)
        if (document_set(&l->doc, o->set[i], e))
            return -1;
    if (scene_compile(&l->scene, &l->doc, e))
        return -1;
    l->has_scene = true;
    if (o->precision)
        l->scene.precision = o->precision;
    l->scene.device.opencl = o->device_opencl;
    l->scene.device.number = o->device_number;
    l->scene.device.numbered = o->device_numbered;
    l->scene.device.only = o->device_only;
    if (registry_init(&l->registry, e))
        return -1;
    l->has_registry = true;
    int ranks;
    ranks_count(&l->registry.rank, &ranks);
    for (size_t i = 0; i < o->n_load; i++)
        if (loader_load(&l->registry, o->load[i], e))
            return -1;
    for (size_t i = 0; i < l->scene.n_plugin; i++)
        if (load_named(l, l->scene.plugin[i], e))
            return -1;
    return bodies_register(&l->registry, &l->scene, e);
}

int loaded_open(struct loaded *l, const struct scene_options *o, struct error *e)
{
    *l = (struct loaded){0};
    return load(l, o, e);
}

int loaded_make(struct loaded *l, const struct scene_options *o, bool guarded, struct error *e)
{
    *l = (struct loaded){0};
    /* A rank that fails alone must not leave the others waiting. */
    if (ranks_agree(load(l, o, e), e) || same_plugins(&l->registry, e))
        return -1;
    l->has_plan = true;
    return ranks_agree(plan_make(&l->plan, &l->registry, &l->scene, guarded, e), e);
}

void loaded_free(struct loaded *l)
{
    if (l->has_plan)
        plan_free(&l->plan);
    if (l->has_registry)
        registry_fini(&l->registry);
    if (l->has_scene)
        scene_free(&l->scene);
    if (l->has_doc)
        document_free(&l->doc);
}
