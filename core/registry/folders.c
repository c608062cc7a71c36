/* registry/folders.c -- where plugins are looked for (see loader.h). Reads the environment and asks
 * the file system which folders there are. */
#include "config.h"

#include "registry/loader.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifndef SPH_PLUGINDIR
#define SPH_PLUGINDIR "/usr/local/lib/sph/plugins-0"
#endif

static bool is_folder(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

/* Takes over `folder`; NULL is an error of memory. */
static int add(char ***folders, size_t *n, char *folder)
{
    char **grown = folder ? realloc(*folders, (*n + 1) * sizeof(*grown)) : NULL;

    if (!grown) {
        free(folder);
        return -1;
    }
    *folders = grown;
    grown[(*n)++] = folder;
    return 0;
}

static int add_path(char ***folders, size_t *n, const char *path)
{
    while (path && *path) {
        const size_t length = strcspn(path, ":");
        if (length > 0 && add(folders, n, strndup(path, length)))
            return -1;
        path += length + (path[length] == ':');
    }
    return 0;
}

/* $XDG_DATA_HOME, or ~/.local/share where it is not set, or not absolute, as its standard asks. */
static int add_users(char ***folders, size_t *n)
{
    const char *data = secure_getenv("XDG_DATA_HOME");
    const char *home = secure_getenv("HOME");
    char *folder;

    if (data && data[0] == '/')
        folder = text_format("%s/sph/plugins-%u", data, SPH_ABI_MAJOR);
    else if (home && home[0] == '/')
        folder = text_format("%s/.local/share/sph/plugins-%u", home, SPH_ABI_MAJOR);
    else
        return 0;
    return add(folders, n, folder);
}

/* An installed tree may have been moved: the folder at the same place relative to the program's
 * prefix, if there is one. Which part of SPH_PLUGINDIR is the prefix is not known, so that the
 * longest tail that exists is taken; the tail keeps at least LIB/sph/plugins-N. */
static char *beside_program(void)
{
    char exe[4096];
    const ssize_t length = readlink("/proc/self/exe", exe, sizeof(exe) - 1);
    char *slash;

    if (length <= 0)
        return NULL;
    exe[length] = '\0';
    for (int i = 0; i < 2; i++) { /* PREFIX/bin/sph */
        slash = strrchr(exe, '/');
        if (!slash)
            return NULL;
        *slash = '\0';
    }
    for (const char *tail = SPH_PLUGINDIR; (tail = strchr(tail, '/')); tail++) {
        const char *second = strchr(tail + 1, '/');
        char *folder;
        if (!second || !strchr(second + 1, '/'))
            break;
        folder = text_format("%s%s", exe, tail);
        if (folder && is_folder(folder))
            return folder;
        free(folder);
    }
    return NULL;
}

static int add_systems(char ***folders, size_t *n)
{
    char *moved = beside_program();

    return add(folders, n, moved ? moved : strdup(SPH_PLUGINDIR));
}

char **loader_folders(size_t *n)
{
    const char *path = secure_getenv("SPH_PLUGIN_PATH");
    char **folders = calloc(1, sizeof(*folders));

    *n = 0;
    if (!folders || (path && strcmp(path, "::") == 0))
        return folders;
    if (add_path(&folders, n, path) || add_users(&folders, n) || add_systems(&folders, n)) {
        loader_folders_free(folders, *n);
        *n = 0;
        return NULL;
    }
    return folders;
}

void loader_folders_free(char **folders, size_t n)
{
    for (size_t i = 0; folders && i < n; i++)
        free(folders[i]);
    free(folders);
}
