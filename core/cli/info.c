/* cli/info.c -- `sph info`: what the plugins have registered. */
#include "config.h"

#include "base/text.h"
#include "cli/cli.h"
#include "cli/info.h"
#include "registry/loader.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct arguments {
    const char *what;
    const char **load;
    size_t n_load;
    bool json, build, devices;
};

enum { KEY_LOAD = 0x100, KEY_JSON, KEY_BUILD, KEY_DEVICES };
static const struct argp_option options[] = {
    {"load", KEY_LOAD, "PLUGIN", 0, "load this one too (name or path; may be repeated)", 0},
    {"json", KEY_JSON, NULL, 0, "as one JSON object", 0},
    {"build", KEY_BUILD, NULL, 0, "versions of what is built in, instead", 0},
    {"devices", KEY_DEVICES, NULL, 0, "the OpenCL devices, instead", 0},
    {0},
};

static error_t parse(int key, char *value, struct argp_state *state)
{
    struct arguments *a = state->input;

    switch (key) {
    case KEY_LOAD:
        a->load[a->n_load++] = value;
        return 0;
    case KEY_JSON:
        a->json = true;
        return 0;
    case KEY_BUILD:
        a->build = true;
        return 0;
    case KEY_DEVICES:
        a->devices = true;
        return 0;
    case ARGP_KEY_ARG:
        if (a->what)
            argp_error(state, "one plugin or item at a time, not also \"%s\"", value);
        a->what = value;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    options,
    parse,
    "[PLUGIN|ITEM]",
    "What the plugins offer, by kind; of one plugin or item: all that it declares."
    "\vLists the plugins in SPH_PLUGIN_PATH, the user's and the system's folder, and those given "
    "with --load.",
    NULL,
    NULL,
    NULL,
};

static void tell_refused(const char *sentence, void *context)
{
    (void)context;
    fprintf(stderr, "sph: %s\n", sentence);
}

static int load(struct registry *r, const struct arguments *a, struct error *e)
{
    for (size_t i = 0; i < a->n_load; i++)
        if (loader_load(r, a->load[i], e))
            return -1;
    /* A file may be asked after without --load. */
    if (a->what && strchr(a->what, '/'))
        return loader_load(r, a->what, e);
    return loader_load_all(r, tell_refused, NULL, e);
}

static int unknown(const struct registry *r, const char *what, struct error *e)
{
    const size_t n = r->n_entry + r->n_plugin;
    const char **known = malloc((n + 1) * sizeof(*known));
    char hint[512];

    if (!known)
        return error_memory(e, "names", n * sizeof(*known));
    for (size_t i = 0; i < r->n_entry; i++)
        known[i] = r->entry[i].item->name;
    for (size_t i = 0; i < r->n_plugin; i++)
        known[r->n_entry + i] = r->plugin[i].name;
    if (n == 0)
        error_set(e, EXIT_USAGE, "no plugin or item \"%s\": no plugin was found", what);
    else
        error_set(e, EXIT_USAGE, "no plugin or item \"%s\"%s", what,
                  text_suggest(hint, sizeof(hint), what, known, n));
    free(known);
    return -1;
}

/* "eos.so" and "/a/b/eos.so" mean the plugin of that file. */
static bool is_plugin(const struct plugin *p, const char *what)
{
    const char *base = strrchr(what, '/') ? strrchr(what, '/') + 1 : what;
    const char *own = strrchr(p->path, '/') ? strrchr(p->path, '/') + 1 : p->path;

    return strcmp(p->name, what) == 0 || strcmp(own, base) == 0;
}

/* Everything, or the plugins and items of that name. */
static int choose(const struct registry *r, const char *what, struct info_choice *c,
                  struct error *e)
{
    c->entry = calloc(r->n_entry + 1, sizeof(*c->entry));
    c->plugin = calloc(r->n_plugin + 1, sizeof(*c->plugin));
    if (!c->entry || !c->plugin)
        return error_memory(e, "a list", (r->n_entry + 1) * sizeof(*c->entry));
    c->detail = what != NULL;
    for (size_t i = 0; i < r->n_plugin; i++)
        if (!what || is_plugin(&r->plugin[i], what))
            c->plugin[c->n_plugin++] = i;
    for (size_t i = 0; i < r->n_entry; i++) {
        const struct entry *x = &r->entry[i];
        if (!what || strcmp(x->item->name, what) == 0 || is_plugin(&r->plugin[x->plugin], what))
            c->entry[c->n_entry++] = i;
    }
    return c->n_entry + c->n_plugin > 0 || !what ? 0 : unknown(r, what, e);
}

static int show(const struct arguments *a, struct error *e)
{
    struct registry r;
    struct info_choice c = {0};
    int status = -1;

    if (registry_init(&r, e))
        return -1;
    if (!load(&r, a, e) && !choose(&r, a->what, &c, e)) {
        status = 0;
        if (a->json)
            status = info_json(&r, &c, e);
        else
            info_text(&r, &c);
    }
    free(c.entry);
    free(c.plugin);
    registry_fini(&r);
    return status;
}

int cli_info(int argc, char **argv)
{
    struct arguments a = {0};
    struct error e = {0};
    int status = 0;
    error_t wrong;

    a.load = calloc((size_t)argc + 1, sizeof(*a.load));
    if (!a.load) {
        error_memory(&e, "arguments", (size_t)argc * sizeof(*a.load));
        return cli_error(&e);
    }
    argp_err_exit_status = EXIT_USAGE;
    wrong = argp_parse(&argp, argc, argv, 0, NULL, &a);
    if (wrong)
        status = error_set(&e, EXIT_USAGE, "the arguments are wrong: %s", strerror(wrong));
    if (!status && a.build)
        info_build();
    if (!status && a.devices)
        status = info_devices(&e);
    if (!status && !a.build && !a.devices)
        status = show(&a, &e);
    free(a.load);
    return status ? cli_error(&e) : EXIT_DONE;
}
