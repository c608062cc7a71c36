/* neighbours/radix.c -- cells in sorted keys: each source has the key of its cell (z, y, x), the
 * keys are radix-sorted, and a row of cells is a stretch of them, found by bisection. Memory
 * depends on the number of sources alone, however empty the box is: 24 bytes a source while
 * sorting, at most 20 after it. Cells are as wide as the largest reach, as those of cells.c. */
#include "neighbours/keys.h"
#include "neighbours/manager.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BITS 20 /* of a cell's number along an axis */

struct radix {
    int dim;
    double low[3], inverse, largest;
    uint64_t *key;   /* [n]: of the cells that hold a source, ascending */
    uint32_t *begin; /* [n + 1]: their sources in `index` */
    size_t n;
    uint32_t *index;
};

static void radix_free(void *search)
{
    struct radix *r = search;

    free(r->key);
    free(r->begin);
    free(r->index);
    free(r);
}

static uint64_t along(const struct radix *r, int axis, double x)
{
    double q = (x - r->low[axis]) * r->inverse, last = (1 << BITS) - 1;

    q = q < last ? q : last;
    return q > 0 ? (uint64_t)q : 0;
}

/* Keeps one key a cell. */
static int compress(struct radix *r, struct keys *k, struct error *e)
{
    size_t n = 0;

    for (size_t i = 0; i < k->n; i++) {
        n += i == 0 || k->key[i] != k->key[i - 1];
    }
    r->begin = malloc((n + 1) * sizeof *r->begin);
    if (!r->begin) {
        return error_memory(e, "the keys of the neighbour search", (n + 1) * sizeof *r->begin);
    }
    for (size_t i = 0; i < k->n; i++) {
        if (i == 0 || k->key[i] != r->key[r->n - 1]) {
            r->begin[r->n] = (uint32_t)i;
            k->key[r->n++] = k->key[i];
        }
    }
    r->begin[n] = (uint32_t)k->n;
    return 0;
}

static int bits_in_use(uint64_t all)
{
    return all ? 64 - __builtin_clzll(all) : 0;
}

static int radix_fill(struct radix *r, const struct sources *s, int threads, size_t *bytes,
                      struct error *e)
{
    uint64_t all = 0;
    struct keys k;

    if (keys_init(&k, s->n, e) != 0) {
        return -1;
    }
#pragma omp parallel for schedule(static) num_threads(threads) reduction(| : all)
    for (size_t i = 0; i < s->n; i++) {
        uint64_t key = 0;

        for (int a = s->dim - 1; a >= 0; a--) {
            key = key << BITS | along(r, a, s->x[a][i]);
        }
        k.key[i] = key;
        all |= key;
    }
    if (keys_sort(&k, bits_in_use(all), threads, e) != 0) {
        keys_fini(&k);
        return -1;
    }
    *bytes = sizeof *r + k.bytes;
    r->key = k.key;
    r->index = k.index;
    return compress(r, &k, e);
}

static void *radix_make(const struct sources *s, const struct filter *filter, int threads,
                        size_t *bytes, struct error *e)
{
    struct radix *r = calloc(1, sizeof *r);
    double hi[3], edge = s->query > 1e-290 ? s->query : 1e-290;

    (void)filter;
    if (!r) {
        error_memory(e, "the keys of the neighbour search", sizeof *r);
        return NULL;
    }
    r->dim = s->dim;
    r->largest = s->largest;
    sources_bounds(s, threads, r->low, hi);
    for (int a = 0; a < s->dim; a++) {
        edge = fmax(edge, (hi[a] - r->low[a]) / (1 << BITS));
    }
    r->inverse = 1 / edge;
    if (radix_fill(r, s, threads, bytes, e) != 0) {
        radix_free(r);
        return NULL;
    }
    return r;
}

/* The first cell whose key is not below this one. */
static size_t bisect(const struct radix *r, uint64_t key)
{
    size_t first = 0, n = r->n;

    while (n > 0) {
        size_t half = n / 2;
        bool below = r->key[first + half] < key;

        first += below ? half + 1 : 0;
        n = below ? n - half - 1 : half;
    }
    return first;
}

static size_t radix_find(const void *search, const struct query *q, struct bitset *leaf)
{
    const struct radix *r = search;
    double reach = (q->reach > r->largest ? q->reach : r->largest) * (1 + MARGIN);
    uint64_t from[3] = {0}, to[3] = {0};
    size_t seen = 0;

    for (int a = 0; a < r->dim; a++) {
        from[a] = along(r, a, q->lo[a] - reach);
        to[a] = along(r, a, q->hi[a] + reach);
    }
    for (uint64_t z = from[2]; z <= to[2]; z++) {
        for (uint64_t y = from[1]; y <= to[1]; y++) {
            uint64_t row = (z << BITS | y) << BITS;
            size_t cell = bisect(r, row | from[0]);

            for (; cell < r->n && r->key[cell] <= (row | to[0]); cell++) {
                for (uint32_t k = r->begin[cell]; k < r->begin[cell + 1]; k++) {
                    bitset_add(leaf, r->index[k] / LEAF);
                }
                seen += r->begin[cell + 1] - r->begin[cell];
            }
        }
    }
    return seen;
}

const struct manager_calls manager_radix = {radix_make, radix_free, radix_find};
