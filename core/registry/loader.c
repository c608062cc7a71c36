/* registry/loader.c -- finds plugins and loads them (see loader.h). The one file that maps code into
 * the program: what it loads has passed registry/preflight.h, and what it keeps registry_add. */
#include "config.h"

#include "registry/loader.h"

#include "base/text.h"
#include "registry/fpmode.h"
#include "registry/preflight.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <ltdl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ENTRY "sph_plugin_entry"
#define SUFFIX ".so"

static bool has_suffix(const char *name)
{
    const size_t n = strlen(name);

    return n > strlen(SUFFIX) && strcmp(name + n - strlen(SUFFIX), SUFFIX) == 0;
}

/* -- One file -------- */

static void close_module(void *handle)
{
    lt_dlclose((lt_dlhandle)handle);
    lt_dlexit();
}

/* The linker's own words, without the file's name, which the sentence has. */
static int linker_failed(const char *path, struct error *e)
{
    const char *why = dlerror();
    const size_t n = strlen(path);

    if (why && strncmp(why, path, n) == 0 && why[n] == ':')
        why += n + 1 + (why[n + 1] == ' ');
    return error_set(e, EXIT_REFUSED, "it cannot be linked: %s", why ? why : "no reason given");
}

/* Opens a module whose path is absolute, so that libltdl searches nothing. dlopen goes first:
 * libltdl says "file not found" whatever is wrong, and binds lazily, so that a missing symbol would
 * end the program at its first call. */
static lt_dlhandle open_module(const char *path, struct error *e)
{
    void *probe = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    lt_dladvise advise = NULL;
    lt_dlhandle handle = NULL;

    if (!probe) {
        linker_failed(path, e);
        return NULL;
    }
    if (lt_dlinit()) {
        error_set(e, EXIT_RUN, "libltdl does not start: %s", lt_dlerror());
        dlclose(probe);
        return NULL;
    }
    if (!lt_dladvise_init(&advise) && !lt_dladvise_local(&advise))
        handle = lt_dlopenadvise(path, advise);
    if (!handle) {
        const char *why = lt_dlerror();
        error_set(e, EXIT_REFUSED, "libltdl does not load it: %s", why ? why : "no reason given");
        lt_dlexit();
    }
    if (advise)
        lt_dladvise_destroy(&advise);
    dlclose(probe);
    return handle;
}

/* Loads an absolute path and lets it register. The floating point mode is restored in any case. */
static int load_module(struct registry *r, const char *path, struct error *e)
{
    const uint64_t mode = fpmode_get();
    lt_dlhandle handle = open_module(path, e);
    sph_plugin_entry_fn entry;
    void *symbol;

    if (fpmode_get() != mode) {
        fpmode_set(mode);
        error_set(e, EXIT_REFUSED,
                  "loading it changes the floating point mode of the program: "
                  "link it without -ffast-math");
        goto fail;
    }
    if (!handle)
        goto fail;
    symbol = lt_dlsym(handle, ENTRY);
    if (!symbol) {
        error_set(e, EXIT_REFUSED, "it has no function " ENTRY ", so is not a plugin of sph");
        goto fail;
    }
    memcpy(&entry, &symbol, sizeof(entry));
    if (registry_add(r, path, entry, handle, close_module, e)) {
        fpmode_set(mode);
        close_module(handle);
        return -1;
    }
    /* Its init may have, too; no harm is done if that is undone. */
    fpmode_set(mode);
    return 0;
fail:
    if (handle)
        close_module(handle);
    return error_prefix(e, "plugin %s", path);
}

static bool is_loaded(const struct registry *r, const char *path)
{
    for (size_t i = 0; i < r->n_plugin; i++)
        if (strcmp(r->plugin[i].path, path) == 0)
            return true;
    return false;
}

static int load_file(struct registry *r, const char *file, struct error *e)
{
    char *path = realpath(file, NULL);
    int status = -1;

    if (!path)
        return error_set(e, EXIT_REFUSED, "plugin %s: %s", file, strerror(errno));
    if (is_loaded(r, path))
        status = 0;
    else if (preflight_file(path, e))
        error_prefix(e, "plugin %s", path);
    else
        status = load_module(r, path, e);
    free(path);
    return status;
}

/* -- By name -------- */

struct names {
    char **name;
    size_t n;
};

static void names_free(struct names *names)
{
    for (size_t i = 0; i < names->n; i++)
        free(names->name[i]);
    free(names->name);
    *names = (struct names){NULL, 0};
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Appends the names (without suffix) of a folder's plugins, sorted. A folder that is not there has
 * none. */
static int names_of(const char *folder, struct names *names)
{
    DIR *dir = opendir(folder);
    const size_t first = names->n;
    const struct dirent *entry;

    while (dir && (entry = readdir(dir))) {
        char **grown;
        if (!has_suffix(entry->d_name) || entry->d_name[0] == '.')
            continue;
        grown = realloc(names->name, (names->n + 1) * sizeof(*grown));
        if (!grown)
            break;
        names->name = grown;
        grown[names->n] = strndup(entry->d_name, strlen(entry->d_name) - strlen(SUFFIX));
        if (!grown[names->n])
            break;
        names->n++;
    }
    if (dir)
        closedir(dir);
    if (names->n > first)
        qsort(names->name + first, names->n - first, sizeof(*names->name), compare_names);
    return 0;
}

/* "no plugin "gsa" in A, B (did you mean "gas"?)" */
static int not_found(const char *name, char *const *folders, size_t n, struct error *e)
{
    struct names names = {NULL, 0};
    char searched[600] = "";
    char hint[256];
    size_t used = 0;

    for (size_t i = 0; i < n; i++) {
        names_of(folders[i], &names);
        if (used < sizeof(searched))
            used += (size_t)snprintf(searched + used, sizeof(searched) - used, "%s%s",
                                     i > 0 ? ", " : "", folders[i]);
    }
    if (n == 0)
        error_set(e, EXIT_REFUSED, "no plugin \"%s\": SPH_PLUGIN_PATH=:: switches the search off",
                  name);
    else if (names.n == 0)
        error_set(e, EXIT_REFUSED, "no plugin \"%s\" in %s", name, searched);
    else
        error_set(e, EXIT_REFUSED, "no plugin \"%s\" in %s%s", name, searched,
                  text_suggest(hint, sizeof(hint), name, (const char *const *)names.name, names.n));
    names_free(&names);
    return -1;
}

static int load_name(struct registry *r, const char *name, struct error *e)
{
    size_t n;
    char **folders = loader_folders(&n);
    bool found = false;
    int status = -1;

    if (!folders)
        return error_memory(e, "the plugin folders", 0);
    for (size_t i = 0; i < n && !found; i++) {
        struct stat st;
        char *file = text_format("%s/%s" SUFFIX, folders[i], name);
        if (!file) {
            found = true;
            error_memory(e, "a path", strlen(name));
        } else if (lstat(file, &st) == 0) { /* a dangling link is found, and told of */
            found = true;
            status = load_file(r, file, e);
        }
        free(file);
    }
    if (!found)
        not_found(name, folders, n, e);
    loader_folders_free(folders, n);
    return status;
}

int loader_load(struct registry *r, const char *name_or_path, struct error *e)
{
    struct stat st;
    char *name;
    int status;

    if (name_or_path[0] == '\0')
        return error_set(e, EXIT_USAGE, "the name of a plugin is empty");
    if (strchr(name_or_path, '/'))
        return load_file(r, name_or_path, e);
    if (!has_suffix(name_or_path))
        return load_name(r, name_or_path, e);
    if (lstat(name_or_path, &st) == 0)
        return load_file(r, name_or_path, e);
    name = strndup(name_or_path, strlen(name_or_path) - strlen(SUFFIX));
    if (!name)
        return error_memory(e, "a name", strlen(name_or_path));
    status = load_name(r, name, e);
    free(name);
    return status;
}

/* -- All -------- */

static bool has(const struct names *names, size_t n, const char *name)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(names->name[i], name) == 0)
            return true;
    return false;
}

int loader_load_all(struct registry *r, void (*refused)(const char *sentence, void *),
                    void *context, struct error *e)
{
    struct names names = {NULL, 0};
    size_t n;
    char **folders = loader_folders(&n);

    if (!folders)
        return error_memory(e, "the plugin folders", 0);
    for (size_t i = 0; i < n; i++) {
        const size_t first = names.n;
        names_of(folders[i], &names);
        for (size_t k = first; k < names.n; k++) {
            struct error why = {0};
            char *file = text_format("%s/%s" SUFFIX, folders[i], names.name[k]);
            /* An earlier folder's plugin stands before a later one's of the same name. */
            if (file && !has(&names, first, names.name[k]) && load_file(r, file, &why) && refused)
                refused(why.text, context);
            free(file);
        }
    }
    names_free(&names);
    loader_folders_free(folders, n);
    return 0;
}
