/* scratch.h -- a folder of a test's own, and files in it. */
#ifndef TESTS_UNIT_SCRATCH_H
#define TESTS_UNIT_SCRATCH_H

#include <ftw.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

struct scratch {
    char dir[256];
};

static inline int scratch_setup(void **state)
{
    const char *tmp = getenv("TMPDIR");
    struct scratch *s = calloc(1, sizeof *s);
    if (!s)
        return -1;
    snprintf(s->dir, sizeof s->dir, "%s/sph-test-XXXXXX", tmp && *tmp ? tmp : "/tmp");
    *state = s;
    return mkdtemp(s->dir) ? 0 : -1;
}

static inline int scratch_remove_one(const char *path, const struct stat *s, int type,
                                     struct FTW *f)
{
    (void)s;
    (void)type;
    (void)f;
    return remove(path);
}

static inline int scratch_teardown(void **state)
{
    struct scratch *s = *state;
    const int result = nftw(s->dir, scratch_remove_one, 16, FTW_DEPTH | FTW_PHYS);
    free(s);
    return result;
}

/* "DIR/name", in one of eight buffers that take turns. */
static inline const char *scratch_path(void **state, const char *name)
{
    static char path[8][512];
    static unsigned turn;
    char *out = path[turn++ % 8];
    snprintf(out, sizeof path[0], "%s/%s", ((struct scratch *)*state)->dir, name);
    return out;
}

static inline bool scratch_exists(const char *path)
{
    struct stat s;
    return lstat(path, &s) == 0;
}

static inline void scratch_write(const char *path, const void *data, size_t n)
{
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, n, f) != n || fclose(f))
        abort();
}

/* The file's contents with a zero behind them; free it. NULL if there is none. */
static inline char *scratch_read(const char *path, size_t *n)
{
    FILE *f = fopen(path, "rb");
    if (!f)
        return NULL;
    char *data = NULL;
    size_t got = 0, room = 0, done = 1;
    while (done > 0) {
        if (room - got < 4096) {
            room = 2 * room + 8192;
            data = realloc(data, room);
            if (!data)
                abort();
        }
        done = fread(data + got, 1, room - got - 1, f);
        got += done;
    }
    fclose(f);
    data[got] = '\0';
    if (n)
        *n = got;
    return data;
}

/* No file may grow beyond `bytes` (0: as before): the disk is full, as a test can have it. */
static inline void scratch_limit(rlim_t bytes)
{
    struct rlimit limit;
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes ? bytes : limit.rlim_max;
    setrlimit(RLIMIT_FSIZE, &limit);
}

#endif
