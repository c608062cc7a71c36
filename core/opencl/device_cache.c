/* opencl/device_cache.c -- the files of the cache (see device_cache.h), in $SPH_CACHE_DIR (empty: no cache),
 * $XDG_CACHE_HOME/sph/opencl or ~/.cache/sph/opencl. The only place that touches them. */
#include "config.h"

#include "base/text.h"
#include "opencl/device_cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* All entries together [bytes]. */
#define MOST ((off_t)256 << 20)
/* A draft this old has no writer any more [s]. */
#define DRAFT_AGE 3600
#define SUFFIX ".sphcl"
#define DRAFT "draft-"
/* So long, and so often, one process waits for another's work [s], [ns]. */
#define WAIT_MOST 300
#define WAIT_STEP 20000000

struct head {
    char magic[8];
    struct cache_key key, sum; /* sum: of what follows */
    uint64_t bytes;            /* that follow */
};
static const char magic[8] = "sphcl 1";

/* -- Keys -------- */

/* FNV-1a with 128 bits, by G. Fowler, L. C. Noll, K.-P. Vo and D. Eastlake (draft-eastlake-fnv), beginning
 * with another value. */
void cache_key_add(struct cache_key *k, const void *data, size_t n)
{
    __extension__ typedef unsigned __int128 wide;
    const wide prime = ((wide)1 << 88) + 0x13b;
    const unsigned char *byte = data;
    wide h = (wide)k->half[1] << 64 | k->half[0];

    for (size_t i = 0; i < n; i++)
        h = (h ^ byte[i]) * prime;
    for (unsigned i = 0; i < 8; i++)
        h = (h ^ ((uint64_t)n >> 8 * i & 0xff) ^ 0x100) * prime;
    k->half[0] = (uint64_t)h;
    k->half[1] = (uint64_t)(h >> 64);
}

void cache_key_text(struct cache_key *k, const char *text)
{
    cache_key_add(k, text, strlen(text));
}

/* -- Folder -------- */

/* In fresh memory; NULL: there is to be no cache. */
static char *folder(void)
{
    const char *own = secure_getenv("SPH_CACHE_DIR");
    const char *cache = secure_getenv("XDG_CACHE_HOME");
    const char *home = secure_getenv("HOME");

    if (own)
        return own[0] ? strdup(own) : NULL;
    if (cache && cache[0] == '/')
        return text_format("%s/sph/opencl", cache);
    return home && home[0] == '/' ? text_format("%s/.cache/sph/opencl", home) : NULL;
}

/* With the folders above it, for the user alone. */
static void make_folder(char *path)
{
    for (char *p = path + 1; *p; p++)
        if (*p == '/') {
            *p = '\0';
            mkdir(path, 0700);
            *p = '/';
        }
    mkdir(path, 0700);
}

static char *file_of(const char *dir, const struct cache_key *k)
{
    return text_format("%s/%016llx%016llx" SUFFIX, dir, (unsigned long long)k->half[1],
                       (unsigned long long)k->half[0]);
}

/* -- Room -------- */

struct kept {
    char *name;
    struct timespec used;
    off_t bytes;
};

static int older_first(const void *a, const void *b)
{
    const struct timespec *s = &((const struct kept *)a)->used;
    const struct timespec *t = &((const struct kept *)b)->used;

    if (s->tv_sec != t->tv_sec)
        return s->tv_sec < t->tv_sec ? -1 : 1;
    return (s->tv_nsec > t->tv_nsec) - (s->tv_nsec < t->tv_nsec);
}

static bool ends_with(const char *s, const char *end)
{
    const size_t n = strlen(s), m = strlen(end);

    return n >= m && strcmp(s + n - m, end) == 0;
}

/* All entries; drafts that nobody finishes go at once. */
static size_t list(DIR *dir, struct kept **out, off_t *total)
{
    size_t n = 0;
    struct dirent *entry;

    *out = NULL;
    *total = 0;
    while ((entry = readdir(dir))) {
        struct kept *grown;
        struct stat s;
        if (fstatat(dirfd(dir), entry->d_name, &s, AT_SYMLINK_NOFOLLOW) || !S_ISREG(s.st_mode))
            continue;
        if (strncmp(entry->d_name, DRAFT, strlen(DRAFT)) == 0 &&
            time(NULL) - s.st_mtime > DRAFT_AGE)
            unlinkat(dirfd(dir), entry->d_name, 0);
        if (!ends_with(entry->d_name, SUFFIX))
            continue;
        grown = realloc(*out, (n + 1) * sizeof(*grown));
        if (!grown)
            break;
        *out = grown;
        grown[n] = (struct kept){strdup(entry->d_name), s.st_mtim, s.st_size};
        if (!grown[n].name)
            break;
        *total += s.st_size;
        n++;
    }
    return n;
}

static void make_room(const char *path)
{
    DIR *dir = opendir(path);
    struct kept *kept;
    off_t total;
    size_t n;

    if (!dir)
        return;
    n = list(dir, &kept, &total);
    if (n > 0)
        qsort(kept, n, sizeof(*kept), older_first);
    for (size_t i = 0; i < n; i++) {
        if (total > MOST && unlinkat(dirfd(dir), kept[i].name, 0) == 0)
            total -= kept[i].bytes;
        free(kept[i].name);
    }
    free(kept);
    closedir(dir);
}

/* -- Entries -------- */

static bool read_all(int fd, void *data, size_t n)
{
    char *at = data;

    while (n > 0) {
        const ssize_t got = read(fd, at, n);
        if (got <= 0)
            return false;
        at += got;
        n -= (size_t)got;
    }
    return true;
}

static bool write_all(int fd, const void *data, size_t n)
{
    const char *at = data;

    while (n > 0) {
        const ssize_t put = write(fd, at, n);
        if (put <= 0)
            return false;
        at += put;
        n -= (size_t)put;
    }
    return true;
}

/* What the file holds, if it is whole and of that key. */
static void *get(int fd, const struct cache_key *k, size_t *bytes)
{
    struct cache_key sum = {{0}};
    struct stat s;
    struct head h;
    void *data;

    if (fstat(fd, &s) || !read_all(fd, &h, sizeof(h)) || memcmp(h.magic, magic, sizeof(magic)) ||
        memcmp(&h.key, k, sizeof(*k)) || (uint64_t)s.st_size != sizeof(h) + h.bytes ||
        h.bytes == 0 || s.st_size > MOST)
        return NULL;
    data = malloc(h.bytes);
    if (!data)
        return NULL;
    if (read_all(fd, data, h.bytes))
        cache_key_add(&sum, data, h.bytes);
    if (memcmp(&sum, &h.sum, sizeof(sum))) {
        free(data);
        return NULL;
    }
    *bytes = h.bytes;
    return data;
}

void *cache_get(const struct cache_key *k, size_t *bytes)
{
    char *dir = folder(), *path = dir ? file_of(dir, k) : NULL;
    void *data = NULL;
    int fd;

    *bytes = 0;
    fd = path ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1;
    if (fd >= 0) {
        data = get(fd, k, bytes);
        futimens(fd, NULL); /* used now; as its owner may without writing */
        close(fd);
    }
    free(path);
    free(dir);
    return data;
}

/* A file of another name first: the entry is there in whole or not at all. */
static void put(const char *dir, const char *path, const struct head *h, const void *data)
{
    char *draft = text_format("%s/" DRAFT "XXXXXX", dir);
    const int fd = draft ? mkostemp(draft, O_CLOEXEC) : -1;

    if (fd >= 0) {
        bool good = write_all(fd, h, sizeof(*h)) && write_all(fd, data, h->bytes);
        good = close(fd) == 0 && good;
        if (!good || rename(draft, path))
            unlink(draft);
    }
    free(draft);
}

void cache_put(const struct cache_key *k, const void *data, size_t bytes)
{
    char *dir = folder(), *path = dir ? file_of(dir, k) : NULL;
    struct head h;

    if (path && bytes > 0 && (off_t)bytes < MOST / 4) {
        memset(&h, 0, sizeof(h));
        memcpy(h.magic, magic, sizeof(magic));
        h.key = *k;
        h.bytes = bytes;
        cache_key_add(&h.sum, data, bytes);
        make_folder(dir);
        put(dir, path, &h, data);
        make_room(dir);
    }
    free(path);
    free(dir);
}

/* -- Turns -------- */

/* The file whose lock says that somebody makes the entry; a draft, as it is nobody's any more one day. */
static char *turn_of(const char *dir, const struct cache_key *k)
{
    return text_format("%s/" DRAFT "%016llx%016llx", dir, (unsigned long long)k->half[1],
                       (unsigned long long)k->half[0]);
}

/* False: the other took too long. */
static bool wait_for(int fd, bool *waited)
{
    const struct timespec step = {0, WAIT_STEP};
    const time_t end = time(NULL) + WAIT_MOST;

    while (flock(fd, LOCK_EX | LOCK_NB)) {
        if (errno != EWOULDBLOCK || time(NULL) > end)
            return false;
        *waited = true;
        nanosleep(&step, NULL);
    }
    return true;
}

int cache_begin(const struct cache_key *k, bool *waited)
{
    char *dir = folder(), *path = NULL;
    int fd = -1;

    *waited = false;
    if (dir) {
        make_folder(dir);
        path = turn_of(dir, k);
    }
    if (path)
        fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd >= 0 && !wait_for(fd, waited)) {
        close(fd);
        fd = -1;
    }
    free(path);
    free(dir);
    return fd;
}

void cache_end(const struct cache_key *k, int turn)
{
    char *dir = folder(), *path = dir ? turn_of(dir, k) : NULL;

    if (turn >= 0 && path)
        unlink(path); /* who waits for it finds it free, and looks for the entry first */
    if (turn >= 0)
        close(turn);
    free(path);
    free(dir);
}
