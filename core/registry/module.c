/* registry/module.c -- maps shared objects (see module.h). The one file that brings foreign code
 * into the program. */
#include "config.h"

#include "registry/module.h"

#include "base/text.h"
#include "registry/fpmode.h"
#include "registry/preflight.h"

#include <dlfcn.h>
#include <errno.h>
#include <ltdl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct module {
    int fd;
    struct stat st;
    lt_dlhandle handle;
    sph_plugin_entry_fn entry;
};

/* The linker's own words, without the file's name, which the sentence has. */
static int linker_failed(const char *path, struct error *e)
{
    const char *why = dlerror();
    const size_t n = strlen(path);

    if (why && strncmp(why, path, n) == 0 && why[n] == ':')
        why += n + 1 + (why[n + 1] == ' ');
    error_set(e, EXIT_REFUSED, "it cannot be linked: %s", why ? why : "no reason given");
    text_one_line(e->text); /* names come out of the file as they stand */
    return -1;
}

/* Maps a module whose path is absolute, so that libltdl searches nothing. dlopen goes first:
 * libltdl says "file not found" whatever is wrong, and binds lazily, so that a missing symbol
 * would end the program at its first call. */
static int map(struct module *m, const char *path, struct error *e)
{
    void *probe = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    lt_dladvise advise = NULL;

    if (!probe)
        return linker_failed(path, e);
    if (lt_dlinit()) {
        error_set(e, EXIT_RUN, "libltdl does not start: %s", lt_dlerror());
        dlclose(probe);
        return -1;
    }
    if (!lt_dladvise_init(&advise) && !lt_dladvise_local(&advise))
        m->handle = lt_dlopenadvise(path, advise);
    if (!m->handle) {
        const char *why = lt_dlerror();
        error_set(e, EXIT_REFUSED, "libltdl does not load it: %s", why ? why : "no reason given");
        lt_dlexit();
    }
    if (advise)
        lt_dladvise_destroy(&advise);
    dlclose(probe);
    return m->handle ? 0 : -1;
}

/* Is what the path leads to still what was looked at? Only root, the user and the program's
 * owner could have exchanged it in between (registry/trust.h), so this guards against an
 * installation that runs at the same time, not against an attack. Loading /proc/self/fd/N
 * instead would need no such look, but then a plugin's $ORIGIN, and every debugger, would be led
 * astray. The time of the last change covers a file that was exchanged and put back, and one
 * written to in its place. */
static bool is_same(const char *path, const struct stat *a)
{
    struct stat b;

    return lstat(path, &b) == 0 && a->st_dev == b.st_dev && a->st_ino == b.st_ino &&
           a->st_size == b.st_size && a->st_mtim.tv_sec == b.st_mtim.tv_sec &&
           a->st_mtim.tv_nsec == b.st_mtim.tv_nsec && a->st_ctim.tv_sec == b.st_ctim.tv_sec &&
           a->st_ctim.tv_nsec == b.st_ctim.tv_nsec;
}

/* Maps, and asks whether that changed more than it should. */
static int load(struct module *m, const char *path, struct error *e)
{
    const uint64_t mode = fpmode_get();
    const int failed = map(m, path, e);
    void *symbol;

    if (fpmode_get() != mode) {
        fpmode_set(mode);
        return error_set(e, EXIT_REFUSED,
                         "loading it changes the floating point mode of the program: link it "
                         "without -ffast-math");
    }
    if (failed)
        return -1;
    if (!is_same(path, &m->st))
        return error_set(e, EXIT_REFUSED, "it was changed while it was being loaded; try again");
    symbol = lt_dlsym(m->handle, PREFLIGHT_ENTRY);
    if (!symbol)
        return error_set(e, EXIT_REFUSED,
                         "it has no function " PREFLIGHT_ENTRY ", so is not a plugin of sph");
    memcpy(&m->entry, &symbol, sizeof(m->entry));
    return 0;
}

struct module *module_open(const char *path, struct error *e)
{
    struct module *m = calloc(1, sizeof(*m));

    if (!m) {
        error_memory(e, "a plugin", sizeof(*m));
        return NULL;
    }
    m->fd = preflight_open(path, &m->st, e);
    if (m->fd >= 0 && load(m, path, e) == 0)
        return m;
    error_prefix(e, "plugin %s", path);
    module_close(m);
    return NULL;
}

void module_close(void *module)
{
    struct module *m = module;

    if (m->handle) {
        lt_dlclose(m->handle);
        lt_dlexit();
    }
    if (m->fd >= 0)
        close(m->fd);
    free(m);
}

sph_plugin_entry_fn module_entry(const struct module *m)
{
    return m->entry;
}

int module_descriptor(const struct module *m)
{
    return m->fd;
}
