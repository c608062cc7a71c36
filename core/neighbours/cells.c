/* neighbours/cells.c -- linked-list cells: a grid whose cells are as wide as the largest reach, the
 * first source of each cell, and of each source the next in its cell. As old as the method (Hockney
 * and Eastwood, Computer Simulation Using Particles, 1981), and best where one reach serves for
 * all: a few large ones make the cells wide for everybody. Where the box is mostly empty the cells
 * are wider, so that there are at most two a source. Memory: 12 bytes a source, at most. */
#include "neighbours/grid.h"
#include "neighbours/manager.h"

#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

struct cells {
    struct grid g;
    double largest; /* reach of a source; 0 if it does not count */
    uint32_t *head, *next;
};

static void cells_free(void *search)
{
    struct cells *c = search;

    free(c->head);
    free(c->next);
    free(c);
}

static void *cells_make(const struct sources *s, const struct filter *filter, int threads,
                        size_t *bytes, struct error *e)
{
    struct cells *c = calloc(1, sizeof *c);
    double lo[3], hi[3];

    (void)filter;
    if (!c) {
        error_memory(e, "the cells of the neighbour search", sizeof *c);
        return NULL;
    }
    sources_bounds(s, threads, lo, hi);
    grid_init(&c->g, lo, hi, s->dim, s->query, s->n);
    c->largest = s->largest;
    c->head = malloc(c->g.n * sizeof *c->head);
    c->next = malloc(s->n * sizeof *c->next);
    *bytes = sizeof *c + c->g.n * sizeof *c->head + s->n * sizeof *c->next;
    if (!c->head || !c->next) {
        error_memory(e, "the cells of the neighbour search", *bytes);
        cells_free(c);
        return NULL;
    }
    memset(c->head, 0xff, c->g.n * sizeof *c->head);
    for (size_t i = s->n; i-- > 0;) {
        size_t cell = grid_cell(&c->g, s->x, i);

        c->next[i] = c->head[cell];
        c->head[cell] = (uint32_t)i;
    }
    return c;
}

static size_t cells_find(const void *search, const struct query *q, struct bitset *leaf)
{
    const struct cells *c = search;
    double reach = (q->reach > c->largest ? q->reach : c->largest) * (1 + MARGIN);
    size_t from[3] = {0}, to[3] = {0}, seen = 0;

    for (int a = 0; a < c->g.dim; a++) {
        from[a] = grid_along(&c->g, a, q->lo[a] - reach);
        to[a] = grid_along(&c->g, a, q->hi[a] + reach);
    }
    for (size_t z = from[2]; z <= to[2]; z++) {
        for (size_t y = from[1]; y <= to[1]; y++) {
            const uint32_t *row = c->head + z * c->g.step[2] + y * c->g.step[1];

            for (size_t x = from[0]; x <= to[0]; x++) {
                for (uint32_t i = row[x]; i != NONE; i = c->next[i]) {
                    bitset_add(leaf, i / LEAF);
                    seen++;
                }
            }
        }
    }
    return seen;
}

const struct manager_calls manager_cells = {cells_make, cells_free, cells_find};
