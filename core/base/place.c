/* base/place.c -- where the folders of this installation are (see place.h). */
#include "config.h"

#include "base/place.h"

#include "base/text.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_folder(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

/* Length of the longest head that two absolute paths share, whole names only: 4 of "/usr/lib" and
 * "/usr/lib64". */
static size_t common(const char *a, const char *b)
{
    size_t last = 0;

    for (size_t i = 0;; i++) {
        const bool a_ends = a[i] == '/' || a[i] == '\0', b_ends = b[i] == '/' || b[i] == '\0';
        if (a_ends && b_ends)
            last = i;
        if (a[i] != b[i] || a[i] == '\0')
            return last;
    }
}

char *place_moved(const char *folder, const char *bindir, const char *here)
{
    const size_t shared = common(folder, bindir);
    const char *tail = bindir + shared; /* "/bin", whatever the prefix */
    const size_t n = strlen(here), n_tail = strlen(tail);

    if (n < n_tail || strcmp(here + n - n_tail, tail) != 0)
        return NULL;
    return text_format("%.*s%s", (int)(n - n_tail), here, folder + shared);
}

/* The folder in which the running program's file lies, links resolved; false if that is unknown. */
static bool program_folder(char *out, size_t size)
{
    const ssize_t n = readlink("/proc/self/exe", out, size);
    char *slash;

    if (n <= 0 || (size_t)n >= size)
        return false;
    out[n] = '\0';
    slash = strrchr(out, '/');
    if (!slash)
        return false;
    *slash = '\0';
    return true;
}

char *place_of(const char *folder)
{
    char here[4096];
    char *moved = program_folder(here, sizeof(here)) ? place_moved(folder, SPH_BINDIR, here) : NULL;

    if (moved && is_folder(moved))
        return moved;
    free(moved);
    return strdup(folder);
}

char *place_data(void)
{
    return place_of(SPH_DATADIR);
}

char *place_plugins(void)
{
    return place_of(SPH_PLUGINDIR);
}
