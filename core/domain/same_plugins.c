/* domain/same_plugins.c -- compares the plugins of all ranks (see same_plugins.h). The first
 * rank sends what it loaded, file by file and piece by piece; the others compare it with what
 * they loaded, read through the very descriptors that the loader opened. No digest: equal bytes
 * are a proof, and plugins are small. */
#include "config.h"

#include "domain/same_plugins.h"

#if SPH_HAVE_MPI
#include "domain/ranks.h"
#include "registry/loader.h"
#include <errno.h>
#include <limits.h>
#include <mpi.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PIECE ((size_t)1 << 20)

struct comparison {
    const struct registry *registry;
    int rank, size;
    char *theirs, *mine; /* PIECE bytes each */
};

/* -- One rank's side -------- */

/* Fills a buffer from the file, up to its end. Bytes read, or -1. */
static int64_t read_piece(int fd, uint64_t at, char *out)
{
    size_t n = 0;

    while (n < PIECE) {
        const ssize_t k = pread(fd, out + n, PIECE - n, (off_t)(at + n));
        if (k < 0 && errno == EINTR)
            continue;
        if (k < 0)
            return -1;
        if (k == 0)
            break;
        n += (size_t)k;
    }
    return (int64_t)n;
}

static int64_t size_of(int fd)
{
    struct stat st;

    return fd >= 0 && fstat(fd, &st) == 0 ? (int64_t)st.st_size : -1;
}

/* The first byte that differs in a piece, or n. */
static size_t first_difference(const char *a, const char *b, size_t n)
{
    for (size_t i = 0; memcmp(a, b, n) != 0 && i < n; i++)
        if (a[i] != b[i])
            return i;
    return n;
}

/* -- All ranks together -------- */

/* A text of the first rank's, to all. */
static void share_text(const struct comparison *c, const char *text, char out[PATH_MAX])
{
    memset(out, 0, PATH_MAX);
    if (c->rank == 0)
        strncpy(out, text, PATH_MAX - 1);
    MPI_Bcast(out, PATH_MAX, MPI_CHAR, 0, MPI_COMM_WORLD);
}

/* Compares one plugin. Every rank takes part in every exchange, also one that has found a
 * difference. */
static int compare(const struct comparison *c, const char *name, const char *path, struct error *e)
{
    const struct plugin *p = registry_plugin(c->registry, name);
    const int fd = p ? loader_descriptor(p) : -1;
    int64_t bytes = size_of(fd), theirs = bytes;
    int status = 0;

    MPI_Bcast(&theirs, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
    if (!p)
        status = error_set(e, EXIT_REFUSED,
                           "plugin \"%s\" is not here, but rank 0 loaded it from %s", name, path);
    else if (bytes != theirs)
        status = error_set(e, EXIT_REFUSED,
                           "plugin \"%s\", %s, has %lld bytes, but rank 0's, %s, has %lld", name,
                           p->path, (long long)bytes, path, (long long)theirs);
    for (int64_t at = 0; at < theirs; at += (int64_t)PIECE) {
        int64_t n = c->rank == 0 ? read_piece(fd, (uint64_t)at, c->theirs) : 0;
        const int64_t asked = theirs - at < (int64_t)PIECE ? theirs - at : (int64_t)PIECE;
        size_t k;
        MPI_Bcast(&n, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
        if (n != asked) {
            if (c->rank == 0)
                status = error_set(e, EXIT_REFUSED, "plugin \"%s\", %s, cannot be read again", name,
                                   path);
            break;
        }
        MPI_Bcast(c->theirs, (int)n, MPI_BYTE, 0, MPI_COMM_WORLD);
        if (status || c->rank == 0)
            continue;
        k = read_piece(fd, (uint64_t)at, c->mine) == n
                ? first_difference(c->theirs, c->mine, (size_t)n)
                : 0;
        if (k < (size_t)n)
            status = error_set(e, EXIT_REFUSED,
                               "plugin \"%s\", %s, differs from rank 0's, %s, at byte %lld", name,
                               p->path, path, (long long)at + (long long)k);
    }
    return status;
}

/* All that the first rank has are here; are there more? */
static int find_surplus(const struct comparison *c, size_t n, struct error *e)
{
    const struct registry *r = c->registry;

    if (r->n_plugin <= n)
        return 0;
    return error_set(e, EXIT_REFUSED, "%zu plugins are here, the last from %s, but rank 0 has %zu",
                     r->n_plugin, r->plugin[r->n_plugin - 1].path, n);
}

static int compare_all(const struct comparison *c, struct error *e)
{
    int n = (int)c->registry->n_plugin;

    MPI_Bcast(&n, 1, MPI_INT, 0, MPI_COMM_WORLD);
    for (int i = 0; i < n; i++) {
        const struct plugin *p = c->rank == 0 ? &c->registry->plugin[i] : NULL;
        char name[PATH_MAX], path[PATH_MAX];
        share_text(c, p ? p->name : "", name);
        share_text(c, p ? p->path : "", path);
        if (ranks_agree(compare(c, name, path, e), e))
            return -1;
    }
    return ranks_agree(find_surplus(c, (size_t)n, e), e);
}

int same_plugins(const struct registry *r, struct error *e)
{
    struct comparison c = {.registry = r};
    int status;

    ranks_count(&c.rank, &c.size);
    if (c.size == 1)
        return 0;
    c.theirs = malloc(PIECE);
    c.mine = malloc(PIECE);
    status = c.theirs && c.mine ? 0 : error_memory(e, "a piece of a plugin", PIECE);
    status = ranks_agree(status, e) ? -1 : compare_all(&c, e);
    free(c.theirs);
    free(c.mine);
    return status;
}

#else

int same_plugins(const struct registry *r, struct error *e)
{
    (void)r;
    (void)e;
    return 0;
}

#endif
