/* registry/folders.c -- where plugins are looked for (see loader.h). Reads the environment. */
#include "config.h"

#include "registry/loader.h"

#include "base/place.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

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

char **loader_folders(size_t *n)
{
    const char *path = secure_getenv("SPH_PLUGIN_PATH");
    char **folders = calloc(1, sizeof(*folders));

    *n = 0;
    if (!folders || (path && strcmp(path, "::") == 0))
        return folders;
    if (add_path(&folders, n, path) || add_users(&folders, n) ||
        add(&folders, n, place_plugins())) {
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
