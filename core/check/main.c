/* check/main.c -- the program sph-plugin-check: loads plugins, makes every check of the table on
 * every item, prints the verdicts. */
#include "config.h"

#include "check/checks.h"

#include "base/text.h"
#include "registry/loader.h"

#include <argp.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define TIMEOUT 20.0

struct arguments {
    const char **file, **load, **only, **set;
    size_t n_file, n_load, n_only, n_set;
    double timeout;
    bool json, quiet, list;
};

/* The whole of a run of the program. */
struct session {
    const struct arguments *a;
    struct registry registry;
    struct report report;
    struct subject subject;
    struct setting *setting;
    size_t first; /* plugins from here on are checked */
    bool refused;
    const char *trying; /* the file that is loaded on trial */
};

enum { KEY_JSON = 0x100, KEY_ONLY, KEY_LOAD, KEY_SET, KEY_TIMEOUT, KEY_LIST };
static const struct argp_option options[] = {
    {"json", KEY_JSON, NULL, 0, "verdicts as a JSON array", 0},
    {"only", KEY_ONLY, "ITEM", 0, "check this item alone (may be repeated)", 0},
    {"load", KEY_LOAD, "PLUGIN", 0, "load this one too, without checking it (may be repeated)", 0},
    {"set", KEY_SET, "ITEM.NAME=VALUE", 0,
     "value of a parameter; value or LOW:HIGH of a property (may be repeated)", 0},
    {"timeout", KEY_TIMEOUT, "SECONDS", 0, "longest time of a check of one item (20)", 0},
    {"list", KEY_LIST, NULL, 0, "what is checked, instead", 0},
    {"quiet", 'q', NULL, 0, "print failures and the last line only", 0},
    {0},
};

static error_t parse(int key, char *value, struct argp_state *state)
{
    struct arguments *a = state->input;
    char *end;

    switch (key) {
    case KEY_JSON:
        a->json = true;
        return 0;
    case KEY_ONLY:
        a->only[a->n_only++] = value;
        return 0;
    case KEY_LOAD:
        a->load[a->n_load++] = value;
        return 0;
    case KEY_SET:
        a->set[a->n_set++] = value;
        return 0;
    case KEY_TIMEOUT:
        a->timeout = strtod(value, &end);
        if (*end || !(a->timeout > 0 && a->timeout <= 86400))
            argp_error(state, "--timeout is a number of seconds, not \"%s\"", value);
        return 0;
    case KEY_LIST:
        a->list = true;
        return 0;
    case 'q':
        a->quiet = true;
        return 0;
    case ARGP_KEY_ARG:
        a->file[a->n_file++] = value;
        return 0;
    case ARGP_KEY_END:
        if (!a->n_file && !a->list)
            argp_error(state, "no plugin is given");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    options,
    parse,
    "PLUGIN...",
    "Checks plugins of sph, files or names: one verdict a line (ok, FAIL, or a note, which is advice), and a "
    "last line that counts."
    "\vThe plugin's code runs in child processes. Exit status: 0 all is well, 1 a check failed, 2 the "
    "command line is wrong, 3 the loader refuses a plugin.",
    NULL,
    NULL,
    NULL,
};

const char *argp_program_version = "sph-plugin-check " PACKAGE_VERSION;

static int complain(const struct error *e)
{
    fflush(stdout);
    fprintf(stderr, "sph-plugin-check: %s\n", e->text);
    return e->exit_code;
}

/* -- Loading -------- */

/* In a child: what a plugin does as it is loaded and unloaded shall not end this program. */
static void load_on_trial(const struct subject *s)
{
    const struct session *x =
        (const struct session *)((const char *)s - offsetof(struct session, subject));
    struct error e = {0};
    size_t items = s->registry->n_entry;

    stage(s, "load");
    if (loader_load(s->registry, x->trying, &e)) {
        say(s, VERDICT_FAIL, "%s", e.text);
        return;
    }
    items = s->registry->n_entry - items;
    stage(s, "fini");
    registry_fini(s->registry);
    say(s, VERDICT_OK, "is taken by the loader, and let go; %zu item%s", items,
        items == 1 ? "" : "s");
}

/* Sets `refused` if the loader does not take it. */
static int load_file(struct session *x, const char *file, struct error *e)
{
    const size_t failed = x->report.count[VERDICT_FAIL];
    struct error why = {0};

    x->trying = file;
    x->subject.entry = NULL;
    if (child_run(&x->subject, file, "load", load_on_trial, x->a->timeout, &x->report, e))
        return -1;
    if (x->report.count[VERDICT_FAIL] > failed) {
        x->refused = true;
        return 0;
    }
    if (loader_load(&x->registry, file, &why) == 0)
        return 0;
    x->refused = true;
    return report_add(&x->report, VERDICT_FAIL, "plugin", file, "load", why.text, e);
}

static int load_all(struct session *x, struct error *e)
{
    for (size_t i = 0; i < x->a->n_load; i++)
        if (loader_load(&x->registry, x->a->load[i], e))
            return -1;
    x->first = x->registry.n_plugin;
    for (size_t i = 0; i < x->a->n_file; i++)
        if (load_file(x, x->a->file[i], e))
            return -1;
    return 0;
}

/* -- Checking -------- */

static bool is_wanted(const struct session *x, const struct entry *entry)
{
    if (entry->plugin < x->first)
        return false;
    for (size_t i = 0; i < x->a->n_only; i++)
        if (strcmp(x->a->only[i], entry->item->name) == 0)
            return true;
    return x->a->n_only == 0;
}

static int check_only(const struct session *x, struct error *e)
{
    const struct registry *r = &x->registry;
    const char *known[256];
    char hint[512];
    size_t n = 0;

    for (size_t k = 0; k < r->n_entry && n < 256; k++)
        if (r->entry[k].plugin >= x->first)
            known[n++] = r->entry[k].item->name;
    for (size_t i = 0; i < x->a->n_only; i++) {
        size_t k = 0;
        while (k < n && strcmp(known[k], x->a->only[i]) != 0)
            k++;
        if (k == n)
            return error_set(e, EXIT_USAGE, "--only: no item that is checked is called \"%s\"%s",
                             x->a->only[i],
                             text_suggest(hint, sizeof(hint), x->a->only[i], known, n));
    }
    return 0;
}

static int check_entry(struct session *x, const struct entry *entry, struct error *e)
{
    const size_t failed = x->report.count[VERDICT_FAIL];

    for (size_t i = 0; i < n_check; i++) {
        const struct check *c = &check_table[i];
        if (!(c->kinds & CHECK_KIND(entry->kind)) ||
            (c->calm && x->report.count[VERDICT_FAIL] > failed))
            continue;
        x->subject.entry = entry;
        if (child_run(&x->subject, entry->item->name, c->name, c->work, x->a->timeout * c->patience,
                      &x->report, e))
            return -1;
    }
    return 0;
}

static int check_all(struct session *x, struct error *e)
{
    x->setting = calloc(x->a->n_set + 1, sizeof(*x->setting));
    if (!x->setting)
        return error_memory(e, "settings", x->a->n_set * sizeof(*x->setting));
    for (size_t i = 0; i < x->a->n_set; i++)
        if (setting_parse(&x->setting[i], x->a->set[i], e))
            return -1;
    x->subject.setting = x->setting;
    x->subject.n_setting = x->a->n_set;
    if (load_all(x, e))
        return -1;
    /* Names can be looked for where all plugins are there. */
    if (!x->refused &&
        (check_only(x, e) || settings_check(&x->registry, x->first, x->setting, x->a->n_set, e)))
        return -1;
    for (size_t i = 0; i < x->registry.n_entry; i++)
        if (is_wanted(x, &x->registry.entry[i]) && check_entry(x, &x->registry.entry[i], e))
            return -1;
    return 0;
}

static int check(const struct arguments *a)
{
    struct session x = {.a = a, .report = {.print = !a->json, .quiet = a->quiet}};
    struct error e = {0};
    int status = registry_init(&x.registry, &e);

    x.subject.registry = &x.registry;
    x.subject.stage =
        mmap(NULL, sizeof(struct stage), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!status && x.subject.stage == MAP_FAILED)
        status = error_memory(&e, "the children's words", sizeof(struct stage));
    if (!status)
        status = check_all(&x, &e);
    if (!status && a->json)
        status = report_json(&x.report, stdout, &e);
    if (!status && !a->json)
        report_count(&x.report, stdout);
    if (x.subject.stage != MAP_FAILED)
        munmap(x.subject.stage, sizeof(struct stage));
    registry_fini(&x.registry);
    status = status                         ? complain(&e)
             : x.refused                    ? EXIT_REFUSED
             : x.report.count[VERDICT_FAIL] ? EXIT_RUN
                                            : EXIT_DONE;
    report_free(&x.report);
    free(x.setting);
    return status;
}

static int list(void)
{
    for (size_t i = 0; i < n_check; i++)
        printf("%-13s %s\n", check_table[i].name, check_table[i].doc);
    return EXIT_DONE;
}

int main(int argc, char **argv)
{
    const size_t n = (size_t)argc + 1;
    struct arguments a = {.timeout = TIMEOUT};
    const char **words = calloc(4 * n, sizeof(*words));
    struct error e = {0};
    int status;

    if (!words) {
        error_memory(&e, "arguments", 4 * n * sizeof(*words));
        return complain(&e);
    }
    signal(SIGXFSZ, SIG_IGN);
    a.file = words;
    a.load = words + n;
    a.only = words + 2 * n;
    a.set = words + 3 * n;
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    status = a.list ? list() : check(&a);
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == EXIT_DONE) {
        error_set(&e, EXIT_RUN, "standard output cannot be written");
        status = complain(&e);
    }
    free(words);
    return status;
}
