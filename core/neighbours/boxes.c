/* neighbours/boxes.c -- a tree of bounding boxes over the sources in the order in which they stand:
 * 8 leaves make a block of boxes, and 8 blocks the block above. Each box keeps the largest reach in
 * it, so that a few large smoothing lengths cost little. Memory: 9 bytes a source, wherever they
 * are. */
#include "neighbours/manager.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BOXES_LEVELS 11 /* 8^11 leaves and sources have room in 32 bits */

struct boxes {
    const struct sources *s;
    const struct filter *filter;
    int n_level;
    struct box8 *level[BOXES_LEVELS]; /* [0]: of the leaves */
    size_t n_node[BOXES_LEVELS];      /* boxes in use at each level */
};

static void boxes_free(void *search)
{
    struct boxes *b = search;

    for (int l = 0; l < BOXES_LEVELS; l++) {
        free(b->level[l]);
    }
    free(b);
}

static bool boxes_alloc(struct boxes *b, size_t *bytes, struct error *e)
{
    size_t n = b->s->n_leaf;

    for (b->n_level = 0; b->n_level < BOXES_LEVELS; b->n_level++) {
        size_t blocks = (n + LEAF - 1) / LEAF, size = blocks * sizeof(struct box8);
        struct box8 *level = aligned_alloc(64, size);

        if (!level) {
            error_memory(e, "the neighbour search's boxes", size);
            return false;
        }
        *bytes += size;
        b->level[b->n_level] = level;
        b->n_node[b->n_level] = n;
        n = blocks;
        if (blocks == 1) {
            b->n_level++;
            return true;
        }
    }
    error_set(e, EXIT_RUN, "too many particles for the neighbour search");
    return false;
}

static void boxes_fill(struct boxes *b, int threads)
{
    const struct sources *s = b->s;
    struct points p = {.x = s->x, .h = s->h, .scale = s->scale, .n = s->n, .dim = s->dim};

    for (int l = 0; l < b->n_level; l++) {
        size_t n = b->n_node[l], blocks = (n + LEAF - 1) / LEAF;

        (void)threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (blocks > 512)
        for (size_t q = 0; q < blocks; q++) {
            double least[LEAF];

            if (l == 0) {
                b->filter->eight(&b->level[0][q], least, &p, q * LEAF);
                continue;
            }
            for (size_t k = 0; k < LEAF; k++) {
                size_t node = q * LEAF + k;

                if (node >= n) {
                    box_empty(&b->level[l][q], k);
                } else {
                    box_around(&b->level[l - 1][node], &b->level[l][q], k);
                }
            }
        }
    }
}

static void *boxes_make(const struct sources *s, const struct filter *filter, int threads,
                        size_t *bytes, struct error *e)
{
    struct boxes *b = calloc(1, sizeof *b);

    *bytes = sizeof *b;
    if (!b) {
        error_memory(e, "the neighbour search's boxes", sizeof *b);
        return NULL;
    }
    b->s = s;
    b->filter = filter;
    if (!boxes_alloc(b, bytes, e)) {
        boxes_free(b);
        return NULL;
    }
    boxes_fill(b, threads);
    return b;
}

/* Below a block of sisters. */
static size_t walk(const struct boxes *b, const struct query *q, int level, size_t block,
                   struct bitset *leaf)
{
    unsigned mask = b->filter->near_boxes(&b->level[level][block], q, b->s->dim);
    size_t rest = b->n_node[level] - block * LEAF, seen = 0;

    if (rest < LEAF) {
        mask &= (1u << rest) - 1; /* a box without points may seem near a reach beyond measure */
    }
    if (level == 0) {
        if (mask) {
            bitset_put(leaf, block / 8, (uint64_t)mask << block % 8 * 8);
        }
        return LEAF * (size_t)bits_of(mask);
    }
    for (; mask; mask &= mask - 1) {
        seen += walk(b, q, level - 1, block * LEAF + (size_t)__builtin_ctz(mask), leaf);
    }
    return seen;
}

static size_t boxes_find(const void *search, const struct query *q, struct bitset *leaf)
{
    const struct boxes *b = search;

    return walk(b, q, b->n_level - 1, 0, leaf);
}

const struct manager_calls manager_boxes = {boxes_make, boxes_free, boxes_find};
