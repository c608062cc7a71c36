/* registry/trust.c -- owners and modes on the way to a plugin (see trust.h). Asks the file
 * system and the user database, opens nothing. */
#include "config.h"

#include "registry/trust.h"

#include <errno.h>
#include <grp.h>
#include <limits.h>
#include <pwd.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINKS_MAX 40 /* as many as the kernel follows */

/* -- Users and groups -------- */

static bool is_trusted(uid_t owner)
{
    struct stat program;

    return owner == 0 || owner == geteuid() ||
           (stat("/proc/self/exe", &program) == 0 && owner == program.st_uid);
}

static bool is_private(gid_t group)
{
    const struct passwd *user;
    const struct group *g;

    if (group == 0)
        return true;
    user = getpwuid(geteuid());
    g = user ? getgrgid(group) : NULL;
    if (!g || user->pw_gid != group || strcmp(user->pw_name, g->gr_name) != 0)
        return false;
    for (char **member = g->gr_mem; *member; member++)
        if (strcmp(*member, user->pw_name) != 0)
            return false;
    return true;
}

static const char *user_name(uid_t user, char *out, size_t size)
{
    const struct passwd *p = getpwuid(user);

    if (p)
        snprintf(out, size, "%.60s", p->pw_name);
    else
        snprintf(out, size, "user %u", (unsigned)user);
    return out;
}

static bool others_may_write(const struct stat *st)
{
    return (st->st_mode & S_IWOTH) || ((st->st_mode & S_IWGRP) && !is_private(st->st_gid));
}

/* -- What lies on the way -------- */

int trust_file(const struct stat *st, struct error *e)
{
    char name[64];

    if (!S_ISREG(st->st_mode))
        return error_set(e, EXIT_REFUSED, "it is not a regular file");
    if (!is_trusted(st->st_uid))
        return error_set(e, EXIT_REFUSED,
                         "the file belongs to %s, not to you, to root or to the owner of sph",
                         user_name(st->st_uid, name, sizeof(name)));
    if (others_may_write(st))
        return error_set(e, EXIT_REFUSED, "others may write to the file (mode %03o; chmod go-w)",
                         (unsigned)st->st_mode & 0777u);
    return 0;
}

/* Who may change a folder in which the program itself lies may change the program: nothing is
 * gained by asking there. */
static bool holds_program(const char *folder)
{
    char exe[PATH_MAX];
    const ssize_t length = readlink("/proc/self/exe", exe, sizeof(exe) - 1);
    const size_t n = strlen(folder);

    if (length <= 0)
        return false;
    exe[length] = '\0';
    return n == 0 || (strncmp(exe, folder, n) == 0 && exe[n] == '/');
}

static int trust_folder(const char *folder, const struct stat *st, struct error *e)
{
    const char *shown = folder[0] ? folder : "/";
    char name[64];

    if (holds_program(folder))
        return 0;
    if (!is_trusted(st->st_uid))
        return error_set(e, EXIT_REFUSED,
                         "its folder %s belongs to %s, not to you, to root or to the owner of sph",
                         shown, user_name(st->st_uid, name, sizeof(name)));
    if (others_may_write(st) && !(st->st_mode & S_ISVTX))
        return error_set(e, EXIT_REFUSED,
                         "others may write to its folder %s (mode %03o; chmod go-w)", shown,
                         (unsigned)st->st_mode & 0777u);
    return 0;
}

/* -- The walk -------- */

struct walk {
    char done[PATH_MAX]; /* resolved; "" is the root */
    char rest[PATH_MAX]; /* still to go */
    int links;
};

/* The next part of the way, without slashes; false: there is none. */
static bool next_part(struct walk *w, char *part, size_t size)
{
    const size_t skip = strspn(w->rest, "/");
    const size_t n = strcspn(w->rest + skip, "/");

    if (n == 0 || n >= size)
        return false;
    memcpy(part, w->rest + skip, n);
    part[n] = '\0';
    memmove(w->rest, w->rest + skip + n, strlen(w->rest + skip + n) + 1);
    return true;
}

/* Puts a link's target in front of the rest of the way. */
static int follow(struct walk *w, const char *link, const struct stat *st, struct error *e)
{
    char target[2 * PATH_MAX], name[64];
    const ssize_t n = readlink(link, target, PATH_MAX);

    if (n < 0)
        return error_set(e, EXIT_REFUSED, "%s", strerror(errno));
    if (!is_trusted(st->st_uid))
        return error_set(e, EXIT_REFUSED,
                         "the symbolic link %s belongs to %s, not to you, to root or to the owner "
                         "of sph",
                         link, user_name(st->st_uid, name, sizeof(name)));
    if (++w->links > LINKS_MAX)
        return error_set(e, EXIT_REFUSED, "%s", strerror(ELOOP));
    if ((size_t)n + strlen(w->rest) + 1 > sizeof(w->rest))
        return error_set(e, EXIT_REFUSED, "%s", strerror(ENAMETOOLONG));
    memcpy(target + n, w->rest, strlen(w->rest) + 1);
    memcpy(w->rest, target, strlen(target) + 1);
    if (w->rest[0] == '/')
        w->done[0] = '\0';
    return 0;
}

static int step(struct walk *w, const char *part, struct error *e)
{
    char here[2 * PATH_MAX];
    struct stat st;

    if (strcmp(part, ".") == 0)
        return 0;
    if (strcmp(part, "..") == 0) {
        char *slash = strrchr(w->done, '/');
        if (slash)
            *slash = '\0';
        return 0;
    }
    if ((size_t)snprintf(here, sizeof(here), "%s/%s", w->done, part) >= sizeof(w->done))
        return error_set(e, EXIT_REFUSED, "%s", strerror(ENAMETOOLONG));
    if (lstat(here, &st))
        return error_set(e, EXIT_REFUSED, "%s", strerror(errno));
    if (S_ISLNK(st.st_mode))
        return follow(w, here, &st, e);
    memcpy(w->done, here, strlen(here) + 1);
    if (S_ISDIR(st.st_mode))
        return trust_folder(w->done, &st, e);
    return w->rest[0] ? error_set(e, EXIT_REFUSED, "%s", strerror(ENOTDIR)) : 0;
}

char *trust_path(const char *path, struct error *e)
{
    struct walk *w = calloc(1, sizeof(*w));
    char part[NAME_MAX + 1];
    char *found = NULL;
    struct stat root;
    int status = 0;

    if (!w) {
        error_memory(e, "a path", sizeof(*w));
        return NULL;
    }
    if (path[0] != '/' && !getcwd(w->rest, sizeof(w->rest) - 1))
        status = error_set(e, EXIT_REFUSED, "the folder that it is relative to is gone");
    else if (strlen(w->rest) + strlen(path) + 2 > sizeof(w->rest))
        status = error_set(e, EXIT_REFUSED, "%s", strerror(ENAMETOOLONG));
    else if (stat("/", &root) || trust_folder("", &root, e))
        status = -1;
    if (!status) {
        if (path[0] != '/')
            strcat(w->rest, "/");
        strcat(w->rest, path);
    }
    while (!status && next_part(w, part, sizeof(part)))
        status = step(w, part, e);
    if (!status && w->rest[strspn(w->rest, "/")])
        status = error_set(e, EXIT_REFUSED, "%s", strerror(ENAMETOOLONG));
    if (!status) {
        found = strdup(w->done[0] ? w->done : "/");
        if (!found)
            error_memory(e, "a path", strlen(w->done));
    }
    free(w);
    return found;
}
