/* cli/new_plugin.c -- `sph new-plugin NAME`: a project that builds, tests, packs and installs as it
 * stands, made from the templates of the SDK. It is made beside its place and put there when it is
 * complete. */
#include "config.h"

#include "base/place.h"
#include "base/text.h"
#include "cli/cli.h"
#include "cli/from.h"
#include "cli/template.h"

#include <sph/abi.h>

#include <argp.h>
#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* The folder of templates for what is made --from bodies. */
#define FROM "from"
/* What the templates are called in themselves. */
#define TEMPLATE "my-plugin"
#define TEMPLATE_C "my_plugin"
#define LONGEST_NAME 40

static const char *const kinds[] = {"function", "eos", "boundary", "kernel", "scheme", "exact"};
static const char *const builds[] = {"make", "autotools"};
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

struct arguments {
    const char *name, *kind, *dir, *build, *from;
    struct from made_of; /* with `from` */
};

enum { KEY_KIND = 0x100, KEY_DIR, KEY_BUILD, KEY_FROM };
static const struct argp_option options[] = {
    {"kind", KEY_KIND, "KIND", 0,
     "what it registers: function (default), eos, boundary, kernel, scheme or exact", 0},
    {"dir", KEY_DIR, "DIR", 0, "make the folder NAME in DIR; here if not given", 0},
    {"build", KEY_BUILD, "SYSTEM", 0, "make (default: a Makefile) or autotools", 0},
    {"from", KEY_FROM, "SCENE[:FUNCTION]|BODY", 0,
     "make it of the functions that a scene brings, of one of them, or of those whose body this file is",
     0},
    {0},
};

static error_t parse(int key, char *value, struct argp_state *state)
{
    struct arguments *a = state->input;

    switch (key) {
    case KEY_KIND:
        a->kind = value;
        return 0;
    case KEY_DIR:
        a->dir = value;
        return 0;
    case KEY_BUILD:
        a->build = value;
        return 0;
    case KEY_FROM:
        a->from = value;
        return 0;
    case ARGP_KEY_ARG:
        if (a->name)
            argp_error(state, "one plugin at a time, not also \"%s\"", value);
        a->name = value;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "the name of the plugin is missing");
        return 0;
    case ARGP_KEY_END:
        if (a->from && a->kind)
            argp_error(state, "--from and --kind do not go together: it is a function");
        if (!a->kind)
            a->kind = a->from ? FROM : "function";
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    options,
    parse,
    "NAME",
    "Makes the folder NAME with a plugin project that builds, tests, packs and installs as it "
    "stands."
    "\vIt begins as a commented example of its kind, with a scene that uses it and a test that "
    "compares it with an exact value. NAME: a small letter, then small letters, digits and -.",
    NULL,
    NULL,
    NULL,
};

/* -- What the user said -------- */

static int check_name(const char *name, struct error *e)
{
    const size_t n = strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-");

    if (n == 0 || name[n] || name[0] < 'a')
        return error_set(
            e, EXIT_USAGE,
            "\"%s\" is no name for a plugin: a small letter, then small letters, digits and -",
            name);
    if (n > LONGEST_NAME)
        return error_set(e, EXIT_USAGE, "the name \"%s\" is longer than %d letters", name,
                         LONGEST_NAME);
    return 0;
}

static int check_word(const char *option, const char *word, const char *const *known, size_t n,
                      struct error *e)
{
    char hint[256];

    for (size_t i = 0; i < n; i++)
        if (strcmp(word, known[i]) == 0)
            return 0;
    return error_set(e, EXIT_USAGE, "%s: there is no \"%s\"%s", option, word,
                     text_suggest(hint, sizeof(hint), word, known, n));
}

/* The folder that will hold it is there, and it itself is not. */
static int check_places(const char *dir, const char *target, struct error *e)
{
    struct stat st;

    if (stat(dir, &st) != 0)
        return error_set(e, EXIT_USAGE, "--dir: %s: %s", dir, strerror(errno));
    if (!S_ISDIR(st.st_mode))
        return error_set(e, EXIT_USAGE, "--dir: %s is no folder", dir);
    if (lstat(target, &st) == 0)
        return error_set(e, EXIT_USAGE, "%s is there already: choose another name, or remove it",
                         target);
    return 0;
}

/* -- The project -------- */

/* The folder of templates: SPH_DATA_PATH's, for a build that is not installed, or the
 * installation's. */
static char *templates_folder(struct error *e)
{
    const char *path = secure_getenv("SPH_DATA_PATH");
    char *data = path && *path ? strdup(path) : place_data();
    char *folder = data ? text_format("%s/templates", data) : NULL;
    struct stat st;

    free(data);
    if (!folder) {
        error_memory(e, "a path", 0);
    } else if (stat(folder, &st) != 0 || !S_ISDIR(st.st_mode)) {
        error_set(e, EXIT_RUN, "the templates are not in %s: is the SDK installed?", folder);
        free(folder);
        folder = NULL;
    }
    return folder;
}

/* All of a kind's files, then those of all kinds, then those of the build system. */
static int copy_parts(const struct arguments *a, const char *templates, const char *to,
                      const struct template_word *words, size_t n, struct error *e)
{
    const char *const part[] = {a->kind, "common", a->build};
    int status = 0;

    for (size_t i = 0; i < COUNT(part) && !status; i++) {
        char *from = text_format("%s/%s", templates, part[i]);
        status = from ? template_copy(from, to, words, n, e) : error_memory(e, "a path", 0);
        free(from);
    }
    return status;
}

static int copy_all(const struct arguments *a, const char *templates, const char *to,
                    struct error *e)
{
    char c_name[LONGEST_NAME + 1], abi[32], year[32];
    const time_t now = time(NULL);
    const struct tm *date = gmtime(&now);
    struct template_word words[] = {
        {TEMPLATE, a->name}, {TEMPLATE_C, c_name}, {"@ABI@", abi},
        {"@YEAR@", year},    {"@FUNCTIONS@", ""},  {"@HEADERS@", ""},
    };
    char *functions = a->from ? from_words(&a->made_of) : strdup("");
    char *from = text_format("%s/%s", templates, a->kind);
    char *headers = NULL;
    int status = -1;

    for (size_t i = 0; i <= strlen(a->name); i++)
        c_name[i] = a->name[i] == '-' ? '_' : a->name[i];
    snprintf(abi, sizeof(abi), "%u.%u", SPH_ABI_MAJOR, SPH_ABI_MINOR);
    snprintf(year, sizeof(year), "%d", date ? date->tm_year + 1900 : 0);
    if (!from || !functions)
        error_memory(e, "a path", 0);
    else if (a->from && !(headers = from_headers(&a->made_of)))
        error_memory(e, "names", 0);
    else if (!a->from)
        headers = template_headers(from, words, COUNT(words) - 1, e);
    if (headers) {
        words[COUNT(words) - 1].to = headers;
        words[COUNT(words) - 2].to = functions;
        status = copy_parts(a, templates, to, words, COUNT(words), e);
    }
    if (!status && a->from)
        status = from_write(&a->made_of, to, a->name, e);
    free(functions);
    free(headers);
    free(from);
    return status;
}

/* A folder without folders in it. */
static void remove_folder(const char *folder)
{
    DIR *dir = opendir(folder);
    const struct dirent *entry;

    while (dir && (entry = readdir(dir)))
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(dirfd(dir), entry->d_name, 0);
    if (dir)
        closedir(dir);
    rmdir(folder);
}

/* Makes it under another name, then gives it its own. */
static int make_project(const struct arguments *a, const char *templates, const char *target,
                        struct error *e)
{
    char *draft = text_format("%s/.%s.XXXXXX", a->dir, a->name);
    const mode_t mask = umask(0);
    int status = -1;

    umask(mask);
    if (!draft)
        return error_memory(e, "a path", 0);
    if (!mkdtemp(draft)) {
        error_set(e, EXIT_RUN, "%s cannot be written to: %s", a->dir, strerror(errno));
        free(draft);
        return -1;
    }
    status = copy_all(a, templates, draft, e);
    if (!status && (chmod(draft, 0777 & ~mask) != 0 || rename(draft, target) != 0))
        status = error_set(e, EXIT_RUN, "%s cannot be made: %s", target, strerror(errno));
    if (status)
        remove_folder(draft);
    free(draft);
    return status;
}

/* What it is made of, or that its kind is known. */
static int check_origin(struct arguments *a, struct error *e)
{
    return a->from ? from_open(&a->made_of, a->from, e)
                   : check_word("--kind", a->kind, kinds, COUNT(kinds), e);
}

static int run(struct arguments *a, struct error *e)
{
    char *target =
        strcmp(a->dir, ".") == 0 ? strdup(a->name) : text_format("%s/%s", a->dir, a->name);
    char *templates = NULL;
    int status = -1;

    if (!target)
        return error_memory(e, "a path", strlen(a->dir));
    if (!check_name(a->name, e) && !check_word("--build", a->build, builds, COUNT(builds), e) &&
        !check_places(a->dir, target, e) && !check_origin(a, e)) {
        templates = templates_folder(e);
        if (templates)
            status = make_project(a, templates, target, e);
    }
    if (!status)
        printf("%s: the project of a plugin, kind %s; its README.md tells more\n"
               "  cd %s && %smake check\n",
               target, a->from ? "function" : a->kind, target,
               strcmp(a->build, "autotools") == 0 ? "autoreconf -fi && ./configure && " : "");
    if (a->from)
        from_free(&a->made_of);
    free(templates);
    free(target);
    return status;
}

int cli_new_plugin(int argc, char **argv)
{
    struct arguments a = {.dir = ".", .build = "make"};
    struct error e = {0};

    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    return run(&a, &e) ? cli_error(&e) : EXIT_DONE;
}
