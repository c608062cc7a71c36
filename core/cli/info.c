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
    const char *what, *exists, *least;
    const char **load;
    size_t n_load;
    bool json, build, devices, extensions;
};

enum {
    KEY_LOAD = 'l',
    KEY_JSON = 'j',
    KEY_BUILD = 0x100,
    KEY_DEVICES,
    KEY_EXTENSIONS,
    KEY_EXISTS,
    KEY_ATLEAST
};
static const struct argp_option options[] = {
    {"load", KEY_LOAD, "PLUGIN", 0, "load this one too (name or path; may be repeated)", 0},
    {"json", KEY_JSON, NULL, 0, "as one JSON object", 0},
    {"exists", KEY_EXISTS, "ID", 0, "print nothing; exit status 0 if ID is there, 1 if not", 0},
    {"atleast", KEY_ATLEAST, "VERSION", 0, "... and of that version or later (with --exists)", 0},
    {"extensions", KEY_EXTENSIONS, NULL, 0, "what plugins may ask this sph for, by id, instead", 0},
    {"build", KEY_BUILD, NULL, 0, "versions of what is built in, instead", 0},
    {"devices", KEY_DEVICES, NULL, 0, "the OpenCL devices, instead", 0},
    {0},
};

/* What cannot be meant. */
static void check(const struct arguments *a, struct argp_state *state)
{
    if (a->least && !a->exists)
        argp_error(state, "--atleast goes with --exists");
    if (a->least && !info_is_version(a->least))
        argp_error(state, "--atleast: \"%s\" is no version: numbers with dots between", a->least);
    if (a->exists && (a->what || a->json || a->build || a->devices || a->extensions))
        argp_error(state,
                   "--exists answers with its exit status, and nothing else can be asked with it");
    if (a->exists && (a->exists[0] == '\0' || info_is_path(a->exists)))
        argp_error(
            state,
            "--exists: \"%s\" is neither a name nor KIND/NAME with a kind of: plugin, function, "
            "eos, boundary, kernel, scheme, exact",
            a->exists);
}

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
    case KEY_EXTENSIONS:
        a->extensions = true;
        return 0;
    case KEY_DEVICES:
        a->devices = true;
        return 0;
    case KEY_EXISTS:
        a->exists = value;
        return 0;
    case KEY_ATLEAST:
        a->least = value;
        return 0;
    case ARGP_KEY_ARG:
        if (a->what)
            argp_error(state, "one plugin or item at a time, not also \"%s\"", value);
        a->what = value;
        return 0;
    case ARGP_KEY_END:
        check(a, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    options,
    parse,
    "[ID]",
    "What the plugins offer, by kind; with an ID: all that one plugin or item declares."
    "\vAn ID is the name or the file of a plugin, or the name of an item; KIND/NAME tells apart what "
    "shares a name, where KIND is plugin, function, eos, boundary, kernel, scheme or exact. "
    "Plugins are looked for in SPH_PLUGIN_PATH, the user's and the system's folder, and --load.",
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
    if (a->what && info_is_path(a->what))
        return loader_load(r, a->what, e);
    return loader_load_all(r, tell_refused, NULL, e);
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
        if (!what || info_names_plugin(&r->plugin[i], what))
            c->plugin[c->n_plugin++] = i;
    for (size_t i = 0; i < r->n_entry; i++) {
        const struct entry *x = &r->entry[i];
        if (!what || info_names_entry(x, what) || info_names_plugin(&r->plugin[x->plugin], what))
            c->entry[c->n_entry++] = i;
    }
    return c->n_entry + c->n_plugin > 0 || !what ? 0 : info_unknown(r, what, e);
}

static int print(const struct registry *r, const struct arguments *a, struct error *e)
{
    struct info_choice c = {0};
    int status = choose(r, a->what, &c, e);

    if (!status && a->json)
        status = info_json(r, &c, e);
    else if (!status)
        info_text(r, &c);
    free(c.entry);
    free(c.plugin);
    return status;
}

static int show(const struct arguments *a, bool *absent, struct error *e)
{
    struct registry r;
    int status;

    if (registry_init(&r, e))
        return -1;
    status = load(&r, a, e);
    if (!status && a->exists)
        *absent = !info_exists(&r, a->exists, a->least);
    else if (!status)
        status = print(&r, a, e);
    registry_fini(&r);
    return status;
}

int cli_info(int argc, char **argv)
{
    struct arguments a = {0};
    struct error e = {0};
    bool absent = false;
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
    if (!status && a.extensions)
        info_extensions();
    if (!status && a.build)
        info_build();
    if (!status && a.devices)
        status = info_devices(&e);
    if (!status && !a.extensions && !a.build && !a.devices)
        status = show(&a, &absent, &e);
    free(a.load);
    return status ? cli_error(&e) : absent ? EXIT_RUN : EXIT_DONE;
}
