/* registry/loader.c -- finds plugins and loads them (see loader.h): the way to a file is looked
 * at by registry/trust.h, the file by registry/preflight.h, what it registers by registry_add. */
#include "config.h"

#include "registry/loader.h"

#include "base/text.h"
#include "registry/crash.h"
#include "registry/module.h"
#include "registry/trust.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define SUFFIX ".so"

static bool has_suffix(const char *name)
{
    const size_t n = strlen(name);

    return n > strlen(SUFFIX) && strcmp(name + n - strlen(SUFFIX), SUFFIX) == 0;
}

/* -- One file -------- */

static bool is_loaded(const struct registry *r, const char *path)
{
    for (size_t i = 0; i < r->n_plugin; i++)
        if (strcmp(r->plugin[i].path, path) == 0)
            return true;
    return false;
}

static int load_file(struct registry *r, const char *file, struct error *e)
{
    char *path = trust_path(file, e);
    struct module *module = NULL;
    int status = -1;

    if (!path)
        return error_prefix(e, "plugin %s", file);
    if (is_loaded(r, path)) {
        free(path);
        return 0;
    }
    crash_watch(path, "being loaded");
    module = module_open(path, e);
    if (module) {
        status = registry_add(r, path, module_entry(module), module, module_close, e);
        if (status)
            module_close(module);
    }
    crash_forget();
    free(path);
    return status;
}

int loader_descriptor(const struct plugin *p)
{
    return p->handle && p->close == module_close ? module_descriptor(p->handle) : -1;
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
