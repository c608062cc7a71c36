/* neighbours/octree.c -- an octree over the sources in Morton order. A node has up to eight
 * children in any number of dimensions: three halvings of space, x, y and z in 3D, the axes in
 * turns in 2D and 1D. Every child has the box around its sources and the largest reach among them,
 * so that a search costs what the density at the place asks for, whatever the reaches elsewhere. A
 * halving that parts nothing makes no node. Memory: 24 bytes a source while sorting; then, for
 * even sources, some 30, and never more than 600. */
#include "neighbours/keys.h"
#include "neighbours/manager.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FULL 8 /* sources that are not divided further */

struct node {
    struct box8 box;
    uint32_t first[8], count[8]; /* sources of a child, in `index` */
    uint32_t inner[8];           /* its node; 0: it is a leaf */
};

struct octree {
    const struct sources *s;
    const struct filter *filter;
    struct keys k;
    struct node *node; /* [0]: the root */
    size_t n_node, capacity;
};

static void octree_free(void *search)
{
    struct octree *t = search;

    keys_fini(&t->k);
    free(t->node);
    free(t);
}

/* -- Keys -------------------------------------------------------------------------------------- */

/* The lowest 21 bits, two apart. */
static uint64_t spread3(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffffull;
    x = (x | x << 16) & 0x001f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

/* The lowest 30 bits, one apart. */
static uint64_t spread2(uint64_t x)
{
    x = (x | x << 16) & 0x0000ffff0000ffffull;
    x = (x | x << 8) & 0x00ff00ff00ff00ffull;
    x = (x | x << 4) & 0x0f0f0f0f0f0f0f0full;
    x = (x | x << 2) & 0x3333333333333333ull;
    return (x | x << 1) & 0x5555555555555555ull;
}

static const int axis_bits[4] = {0, 60, 30, 21};

static uint64_t morton(int dim, const uint64_t *cell)
{
    if (dim == 3) {
        return spread3(cell[2]) << 2 | spread3(cell[1]) << 1 | spread3(cell[0]);
    }
    return dim == 2 ? spread2(cell[1]) << 1 | spread2(cell[0]) : cell[0];
}

static int octree_sort(struct octree *t, int threads, struct error *e)
{
    const struct sources *s = t->s;
    uint64_t cells = 1ull << axis_bits[s->dim];
    double lo[3], hi[3], longest = 1e-290, inverse;

    if (keys_init(&t->k, s->n, e) != 0) {
        return -1;
    }
    sources_bounds(s, threads, lo, hi);
    for (int a = 0; a < s->dim; a++) {
        longest = fmax(longest, hi[a] - lo[a]);
    }
    inverse = (double)cells / longest;
#pragma omp parallel for schedule(static) num_threads(threads) if (s->n > 4096)
    for (size_t i = 0; i < s->n; i++) {
        uint64_t cell[3] = {0};

        for (int a = 0; a < s->dim; a++) {
            cell[a] = (uint64_t)((s->x[a][i] - lo[a]) * inverse);
            cell[a] = cell[a] < cells ? cell[a] : cells - 1;
        }
        t->k.key[i] = morton(s->dim, cell);
    }
    return keys_sort(&t->k, axis_bits[s->dim] * s->dim, threads, e);
}

/* -- Nodes ------------------------------------------------------------------------------------- */

static uint32_t node_new(struct octree *t, struct error *e)
{
    if (t->n_node == t->capacity) {
        size_t capacity = t->capacity + t->capacity / 2 + t->s->n / 16 + 8;
        struct node *node = aligned_alloc(32, capacity * sizeof *node);

        if (!node) {
            error_memory(e, "the nodes of the neighbour search", capacity * sizeof *node);
            return UINT32_MAX;
        }
        if (t->n_node > 0) {
            memcpy(node, t->node, t->n_node * sizeof *node);
        }
        free(t->node);
        t->node = node;
        t->capacity = capacity;
    }
    memset(&t->node[t->n_node], 0, sizeof *t->node);
    for (size_t k = 0; k < 8; k++) {
        box_empty(&t->node[t->n_node].box, k);
    }
    return (uint32_t)t->n_node++;
}

/* The box of sources that are not divided further. */
static void leaf_box(const struct octree *t, struct node *node, size_t k)
{
    const struct sources *s = t->s;
    struct box8 *b = &node->box;

    for (uint32_t q = node->first[k]; q < node->first[k] + node->count[k]; q++) {
        uint32_t i = t->k.index[q];
        double reach = s->scale > 0 ? s->scale * s->h[i] : 0;

        for (int a = 0; a < s->dim; a++) {
            double x = s->x[a][i];

            b->lo[a][k] = x < b->lo[a][k] ? x : b->lo[a][k];
            b->hi[a][k] = x > b->hi[a][k] ? x : b->hi[a][k];
        }
        b->reach[k] = reach > b->reach[k] ? reach : b->reach[k];
    }
}

/* Where keys whose digit at `shift` is at least `digit` begin among the sorted [first, last). */
static size_t digit_begin(const uint64_t *key, size_t first, size_t last, int shift, uint64_t digit)
{
    while (first < last) {
        size_t mid = first + (last - first) / 2;

        if ((key[mid] >> shift & 7) < digit) {
            first = mid + 1;
        } else {
            last = mid;
        }
    }
    return first;
}

/* A node of the sources [first, last) and all below it, parted by the bits of their keys from shift
 * down; its number, or UINT32_MAX if there is no memory. */
static uint32_t node_make(struct octree *t, size_t first, size_t last, int shift, struct error *e)
{
    uint32_t me = node_new(t, e);
    size_t begin[9];

    if (me == UINT32_MAX) {
        return me;
    }
    /* The highest digit in which the first and the last differ: none above it parts them. */
    while (shift > 0 && !((t->k.key[first] ^ t->k.key[last - 1]) >> shift & 7)) {
        shift -= 3;
    }
    for (uint64_t k = 0; k <= 8; k++) {
        begin[k] = k == 0   ? first
                   : k == 8 ? last
                            : digit_begin(t->k.key, begin[k - 1], last, shift, k);
    }
    for (size_t k = 0; k < 8; k++) {
        size_t n = begin[k + 1] - begin[k];

        t->node[me].first[k] = (uint32_t)begin[k];
        t->node[me].count[k] = (uint32_t)n;
        if (n > FULL && shift > 0) {
            uint32_t child = node_make(t, begin[k], begin[k + 1], shift - 3, e);

            if (child == UINT32_MAX) {
                return child;
            }
            t->node[me].inner[k] = child;
            box_around(&t->node[child].box, &t->node[me].box, k);
        } else {
            leaf_box(t, &t->node[me], k);
        }
    }
    return me;
}

static void *octree_make(const struct sources *s, const struct filter *filter, int threads,
                         size_t *bytes, struct error *e)
{
    struct octree *t = calloc(1, sizeof *t);

    if (!t) {
        error_memory(e, "the neighbour search's octree", sizeof *t);
        return NULL;
    }
    t->s = s;
    t->filter = filter;
    if (octree_sort(t, threads, e) != 0 ||
        node_make(t, 0, s->n, axis_bits[s->dim] * s->dim - 3, e) == UINT32_MAX) {
        octree_free(t);
        return NULL;
    }
    free(t->k.key);
    t->k.key = NULL;
    *bytes = sizeof *t + t->capacity * sizeof *t->node + t->k.bytes;
    return t;
}

/* -- Search ------------------------------------------------------------------------------------ */

static size_t walk(const struct octree *t, const struct query *q, uint32_t at, struct bitset *leaf)
{
    const struct node *node = &t->node[at];
    unsigned mask = t->filter->near_boxes(&node->box, q, t->s->dim);
    size_t seen = 0;

    for (; mask; mask &= mask - 1) {
        unsigned k = (unsigned)__builtin_ctz(mask);

        if (node->inner[k]) {
            seen += walk(t, q, node->inner[k], leaf);
            continue;
        }
        for (uint32_t i = node->first[k]; i < node->first[k] + node->count[k]; i++) {
            bitset_add(leaf, t->k.index[i] / LEAF);
        }
        seen += node->count[k];
    }
    return seen;
}

static size_t octree_find(const void *search, const struct query *q, struct bitset *leaf)
{
    return walk(search, q, 0, leaf);
}

const struct manager_calls manager_octree = {octree_make, octree_free, octree_find};
