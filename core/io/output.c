/* output.c -- the output folder: claims it, clears an earlier run's results, and puts files there
 * whole. Touches only files of the names that output.h lists and temporaries of its own. */
#include "config.h"

#include "io/output.h"

#include "base/text.h"
#include "io/csv.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define LOCK_NAME ".sph-lock"
#define ASIDE_PREFIX ".sph-aside-"

/* -- The claim --------------------------------------------------------------------------------- */

/* mkdir -p. */
static int make_folder(const char *dir, struct error *e)
{
    char *path = text_format("%s", dir);
    if (!path)
        return error_memory(e, "a path", strlen(dir) + 1);
    int result = 0;
    for (char *end = path + 1; result == 0; end++) {
        if (*end && *end != '/')
            continue;
        const char kept = *end;
        *end = '\0';
        struct stat s;
        if (mkdir(path, 0777) && (errno != EEXIST || stat(path, &s) || !S_ISDIR(s.st_mode)))
            result = error_set(e, EXIT_USAGE, "cannot make the output folder %s: %s%s%s", dir, path,
                               errno == EEXIST ? " is not a folder" : ": ",
                               errno == EEXIST ? "" : strerror(errno));
        *end = kept;
        if (!kept)
            break;
    }
    free(path);
    return result;
}

/* Who holds the lock, as it says itself; 0 if it does not. */
static long lock_holder(int fd)
{
    char text[32];
    const ssize_t n = pread(fd, text, sizeof text - 1, 0);
    if (n <= 0)
        return 0;
    text[n] = '\0';
    return strtol(text, NULL, 10);
}

static int lock_refused(int fd, const char *dir, struct error *e)
{
    if (errno != EWOULDBLOCK)
        return error_set(e, EXIT_USAGE, "cannot lock the output folder %s: %s", dir,
                         strerror(errno));
    const long pid = lock_holder(fd);
    if (pid > 0)
        return error_set(e, EXIT_USAGE, "the output folder %s is in use by process %ld", dir, pid);
    return error_set(e, EXIT_USAGE, "the output folder %s is in use by another run", dir);
}

/* The lock file is removed when a run ends: what is locked must still be what the name stands
 * for. */
static bool lock_is_current(int fd, const char *path)
{
    struct stat mine, named;
    return fstat(fd, &mine) == 0 && stat(path, &named) == 0 && mine.st_ino == named.st_ino &&
           mine.st_dev == named.st_dev;
}

/* Opens and locks the lock file: its descriptor, or -1. */
static int lock_take(const char *path, const char *dir, struct error *e)
{
    for (int attempt = 0; attempt < 100; attempt++) {
        const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (fd < 0)
            return error_set(e, EXIT_USAGE, "cannot write to the output folder %s: %s", dir,
                             strerror(errno));
        if (flock(fd, LOCK_EX | LOCK_NB)) {
            lock_refused(fd, dir, e);
            close(fd);
            return -1;
        }
        if (lock_is_current(fd, path))
            return fd;
        close(fd);
    }
    return error_set(e, EXIT_USAGE, "the output folder %s is in use by another run", dir);
}

int output_claim(struct output *o, const char *dir, struct error *e)
{
    *o = (struct output){NULL, -1};
    if (!dir || !*dir)
        return error_set(e, EXIT_USAGE, "the output folder has an empty name");
    /* A file larger than the system's limit shall be an error of the write, not the end of us. */
    signal(SIGXFSZ, SIG_IGN);
    if (make_folder(dir, e))
        return -1;
    char *lock = text_format("%s/" LOCK_NAME, dir);
    o->dir = text_format("%s", dir);
    if (!lock || !o->dir) {
        error_memory(e, "a path", strlen(dir) + sizeof LOCK_NAME);
        goto fail;
    }
    o->lock = lock_take(lock, dir, e);
    if (o->lock < 0)
        goto fail;
    char pid[32];
    const int n = snprintf(pid, sizeof pid, "%ld\n", (long)getpid());
    if (ftruncate(o->lock, 0) || pwrite(o->lock, pid, (size_t)n, 0) != n) {
        error_set(e, EXIT_RUN, "cannot write %s: %s", lock, strerror(errno));
        goto fail;
    }
    free(lock);
    return 0;
fail:
    free(lock);
    output_close(o);
    return -1;
}

void output_close(struct output *o)
{
    if (o->dir && o->lock >= 0) {
        char *lock = output_path(o, LOCK_NAME);
        if (lock && lock_is_current(o->lock, lock))
            unlink(lock);
        free(lock);
        close(o->lock);
    }
    free(o->dir);
    *o = (struct output){NULL, -1};
}

int output_open(struct output *o, const char *dir, struct error *e)
{
    if (output_claim(o, dir, e))
        return -1;
    if (output_clear(o, e)) {
        output_close(o);
        return -1;
    }
    return 0;
}

/* -- What an earlier run left ------------------------------------------------------------------ */

static bool starts_with(const char *s, const char *prefix)
{
    return strncmp(s, prefix, strlen(prefix)) == 0;
}

static bool ends_with(const char *s, const char *suffix)
{
    const size_t n = strlen(s), m = strlen(suffix);
    return n >= m && strcmp(s + n - m, suffix) == 0;
}

bool output_is_snapshot(const char *name)
{
    if (!starts_with(name, "snapshot_"))
        return false;
    name += strlen("snapshot_");
    const size_t digits = strspn(name, "0123456789");
    return digits > 0 && strcmp(name + digits, ".vtkhdf") == 0;
}

void output_checkpoint_name(char *out, size_t size, unsigned long long step)
{
    snprintf(out, size, "checkpoint_%08llu.h5", step);
}

long long output_checkpoint_step(const char *name)
{
    char again[64];
    if (strncmp(name, "checkpoint_", 11) != 0 || name[11] < '0' || name[11] > '9')
        return -1;
    errno = 0;
    const long long step = strtoll(name + 11, NULL, 10);
    if (errno)
        return -1;
    output_checkpoint_name(again, sizeof again, (unsigned long long)step);
    return strcmp(name, again) == 0 ? step : -1;
}

/* Whether the file begins with `mark` (offset < 0: holds it near its beginning). */
static bool file_has_mark(int folder, const char *name, const char *mark, size_t n, bool anywhere)
{
    char head[512];
    const int fd = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (fd < 0)
        return false;
    const ssize_t got = read(fd, head, sizeof head);
    close(fd);
    if (got < (ssize_t)n)
        return false;
    if (!anywhere)
        return memcmp(head, mark, n) == 0;
    for (size_t i = 0; i + n <= (size_t)got; i++)
        if (memcmp(head + i, mark, n) == 0)
            return true;
    return false;
}

/* Rows that a run writes: log.csv, and what the scene has measured. */
static bool is_rows(const char *name)
{
    return strcmp(name, "log.csv") == 0 || strcmp(name, "errors.csv") == 0 ||
           strcmp(name, "ranks.csv") == 0 ||
           ((starts_with(name, "probe_") || starts_with(name, "profile_")) &&
            ends_with(name, ".csv"));
}

enum owner { NOBODY, OURS, FOREIGN };

/* Whose file this is: ours to remove, of no concern, or in the way of ours. */
static enum owner file_owner(int folder, const char *name)
{
    struct stat s;
    if (fstatat(folder, name, &s, AT_SYMLINK_NOFOLLOW))
        return NOBODY;
    const bool regular = S_ISREG(s.st_mode);
    if (starts_with(name, ASIDE_PREFIX) || output_is_snapshot(name) ||
        output_checkpoint_step(name) >= 0 || strcmp(name, OUTPUT_FAILED) == 0 ||
        strcmp(name, OUTPUT_EARLIER) == 0)
        return regular ? OURS : FOREIGN;
    if (is_rows(name)) {
        const char *mark = strcmp(name, "log.csv") == 0 ? OUTPUT_LOG_MARK : CSV_MARK;
        const bool ours = s.st_size == 0 || file_has_mark(folder, name, mark, strlen(mark), false);
        return regular && ours ? OURS : FOREIGN;
    }
    if (strcmp(name, "summary.json") == 0)
        return regular && file_has_mark(folder, name, "\"status\":", 9, true) ? OURS : FOREIGN;
    if (ends_with(name, ".png")) {
        const char mark[] = OUTPUT_PNG_KEY "\0" OUTPUT_PNG_MARK;
        return regular && file_has_mark(folder, name, mark, sizeof mark - 1, true) ? OURS : NOBODY;
    }
    return NOBODY;
}

/* Looks at, or removes, one entry of the folder. */
static int clear_entry(const struct output *o, int folder, const char *name, bool removing,
                       struct error *e)
{
    switch (file_owner(folder, name)) {
    case FOREIGN:
        return error_set(e, EXIT_USAGE,
                         "%s/%s is not of an earlier run and would be overwritten; "
                         "choose another output folder",
                         o->dir, name);
    case OURS:
        if (removing && unlinkat(folder, name, 0) && errno != ENOENT)
            return error_set(e, EXIT_USAGE, "cannot remove %s/%s of an earlier run: %s", o->dir,
                             name, strerror(errno));
        return 0;
    case NOBODY:
        break;
    }
    return 0;
}

/* What a run that goes on leaves alone, though it is of the earlier one. */
struct kept {
    bool any;
    uint64_t snapshots, step;
    const char *name; /* or this one alone */
};

static bool is_kept(const struct kept *k, const char *name)
{
    if (k->name && strcmp(name, k->name) == 0)
        return true;
    if (!k->any || starts_with(name, ASIDE_PREFIX) || strcmp(name, "summary.json") == 0 ||
        strcmp(name, OUTPUT_FAILED) == 0)
        return false;
    if (output_is_snapshot(name))
        return strtoull(name + strlen("snapshot_"), NULL, 10) < k->snapshots;
    const long long step = output_checkpoint_step(name);
    return step < 0 || (uint64_t)step <= k->step;
}

static int clear(const struct output *o, const struct kept *kept, struct error *e)
{
    DIR *folder = opendir(o->dir);
    if (!folder)
        return error_set(e, EXIT_USAGE, "cannot read the output folder %s: %s", o->dir,
                         strerror(errno));
    int result = 0;
    /* First all are looked at: nothing is removed from a folder that is refused. */
    for (int removing = 0; removing < 2 && result == 0; removing++) {
        const struct dirent *entry;
        rewinddir(folder);
        while (result == 0 && (entry = readdir(folder)))
            if (!is_kept(kept, entry->d_name))
                result = clear_entry(o, dirfd(folder), entry->d_name, removing, e);
    }
    closedir(folder);
    return result;
}

int output_clear(const struct output *o, struct error *e)
{
    const struct kept none = {0};
    return clear(o, &none, e);
}

int output_clear_but(const struct output *o, const char *name, struct error *e)
{
    const struct kept kept = {.name = name};
    if (clear(o, &kept, e))
        return -1;
    char *from = output_path(o, name ? name : ""), *to = output_path(o, OUTPUT_EARLIER);
    int status = from && to ? 0 : error_memory(e, "a path", strlen(o->dir));
    if (!status && name && rename(from, to))
        status = error_set(e, EXIT_USAGE, "cannot keep %s: %s", from, strerror(errno));
    free(from);
    free(to);
    return status;
}

int output_cut(const struct output *o, uint64_t snapshots, uint64_t step, struct error *e)
{
    const struct kept kept = {true, snapshots, step, NULL};
    return clear(o, &kept, e);
}

void output_sweep(const struct output *o)
{
    DIR *folder = opendir(o->dir);
    const struct dirent *entry;
    while (folder && (entry = readdir(folder)))
        if (starts_with(entry->d_name, ASIDE_PREFIX))
            unlinkat(dirfd(folder), entry->d_name, 0);
    if (folder)
        closedir(folder);
}

/* -- Files written whole ----------------------------------------------------------------------- */

char *output_path(const struct output *o, const char *name)
{
    return text_format("%s/%s", o->dir, name);
}

char *output_begin(const struct output *o, const char *name)
{
    char *path = text_format("%s/" ASIDE_PREFIX "%s", o->dir, name);
    if (path)
        unlink(path);
    return path;
}

void output_drop(char *temporary)
{
    if (temporary)
        unlink(temporary);
    free(temporary);
}

char *output_shown(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    if (!starts_with(name, ASIDE_PREFIX))
        return text_format("%s", path);
    return text_format("%.*s%s", (int)(name - path), path, name + strlen(ASIDE_PREFIX));
}

static int cannot_write(const char *path, int error_number, struct error *e)
{
    char *shown = output_shown(path);
    error_set(e, EXIT_RUN, "cannot write %s: %s", shown ? shown : path, strerror(error_number));
    free(shown);
    return -1;
}

/* The name itself is on disk only when its folder is. Filesystems that cannot sync one say so. */
static int sync_folder(const char *path, struct error *e)
{
    const char *slash = strrchr(path, '/');
    char *dir = slash ? text_format("%.*s", (int)(slash - path) + 1, path) : text_format(".");
    if (!dir)
        return error_memory(e, "a path", strlen(path));
    int result = 0;
    const int fd = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        if (fsync(fd) && (errno == EIO || errno == ENOSPC || errno == EDQUOT))
            result = cannot_write(path, errno, e);
        close(fd);
    }
    free(dir);
    return result;
}

/* Syncs and closes `fd`, which `temporary` names, and gives it the name `path`. */
static int place(int fd, const char *temporary, const char *path, struct error *e)
{
    int failed = 0;
    if (fsync(fd) && errno != EINVAL && errno != EROFS)
        failed = errno;
    if (close(fd) && !failed)
        failed = errno;
    if (!failed && rename(temporary, path))
        failed = errno;
    if (failed) {
        unlink(temporary);
        return cannot_write(path, failed, e);
    }
    return sync_folder(path, e);
}

int output_commit(const struct output *o, const char *temporary, const char *name, struct error *e)
{
    char *path = output_path(o, name);
    if (!path) {
        unlink(temporary);
        return error_memory(e, "a path", strlen(name));
    }
    int result;
    const int fd = open(temporary, O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
    if (fd < 0) {
        result = cannot_write(path, errno, e);
        unlink(temporary);
    } else {
        result = place(fd, temporary, path, e);
    }
    free(path);
    return result;
}

/* All of it, or an errno. */
static int write_all(int fd, const void *data, size_t n)
{
    const char *at = data;
    while (n > 0) {
        const ssize_t done = write(fd, at, n);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return done < 0 ? errno : ENOSPC;
        at += done;
        n -= (size_t)done;
    }
    return 0;
}

/* Writes to `temporary` and renames it to `path`. */
static int write_aside(const char *temporary, const char *path, const void *data, size_t n,
                       struct error *e)
{
    unlink(temporary);
    const int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd < 0)
        return cannot_write(path, errno, e);
    const int failed = write_all(fd, data, n);
    if (failed) {
        close(fd);
        unlink(temporary);
        return cannot_write(path, failed, e);
    }
    return place(fd, temporary, path, e);
}

int output_write(const struct output *o, const char *name, const char *text, size_t n,
                 struct error *e)
{
    int result;
    char *path = output_path(o, name), *temporary = output_begin(o, name);
    if (path && temporary)
        result = write_aside(temporary, path, text, n, e);
    else
        result = error_memory(e, "a path", strlen(o->dir) + strlen(name));
    free(path);
    free(temporary);
    return result;
}

/* A device or a pipe: there is nothing to rename. */
static int write_direct(const char *path, const void *data, size_t n, struct error *e)
{
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    if (fd < 0)
        return cannot_write(path, errno, e);
    int failed = write_all(fd, data, n);
    if (close(fd) && !failed)
        failed = errno;
    return failed ? cannot_write(path, failed, e) : 0;
}

int output_write_path(const char *path, const void *data, size_t n, struct error *e)
{
    struct stat s;
    signal(SIGXFSZ, SIG_IGN); /* as in output_claim */
    if (stat(path, &s) == 0 && !S_ISREG(s.st_mode))
        return write_direct(path, data, n, e);
    const char *slash = strrchr(path, '/');
    const int folder = slash ? (int)(slash - path) + 1 : 0;
    /* Nobody claimed this folder: another process may write the same file now. */
    char *temporary =
        text_format("%.*s" ASIDE_PREFIX "%ld-%s", folder, path, (long)getpid(), path + folder);
    if (!temporary)
        return error_memory(e, "a path", strlen(path));
    const int result = write_aside(temporary, path, data, n, e);
    free(temporary);
    return result;
}
