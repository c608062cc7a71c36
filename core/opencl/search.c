/* opencl/search.c -- a device's search: its programs and rooms, what is known of clouds, and the
 * structure in which sources are sought (see search.h; the kernels are survey.cl, search.cl and
 * own_order.cl). */
#include "config.h"

#include "opencl/search.h"

#include "base/text.h"
#include "neighbours/grid.h"
#include "neighbours/sources.h"
#include "opencl/search_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LANES 8
#define KEY_BITS 20 /* of a cell's number along an axis, where cells are sorted keys */

/* -- Programs -------- */

/* By set: its kernels, from the first to the one before `end`, and its texts. */
static const struct {
    int first, end;
    const char *const text[7]; /* up to NULL */
} sets[SEARCH_SETS] = {
    [SEARCH_ALL] = {K_SURVEY,
                    K_GATHER,
                    {points_text, survey_text, search_text, lists_text, bundles_text, order_text}},
    [SEARCH_OWN_ORDER] = {K_GATHER, K_CROWDS, {points_text, own_order_text}},
    [SEARCH_CROWDS] = {K_CROWDS, SEARCH_KERNELS, {points_text, crowds_text}},
};

int search_need(struct device_search *s, enum search_set set, struct error *e)
{
    static const char *const name[SEARCH_KERNELS] = {
        [K_SURVEY] = "survey",      [K_CELL] = "cells_count",      [K_SCATTER] = "cells_scatter",
        [K_LEAVES] = "leaves_make", [K_BOXES] = "boxes_make",      [K_LIST] = "list_make",
        [K_PAIRS] = "list_pairs",   [K_LOOK] = "bundles_look",     [K_PUT] = "bundles_put",
        [K_FULL] = "full_sums",     [K_SORT_CELLS] = "cells_sort", [K_GATHER] = "gather",
        [K_KEYS] = "keys",          [K_CROWDS] = "crowds_sort"};
    char options[128], *text;
    int status;

    if (s->program[set]) {
        return 0;
    }
    text = text_join(sets[set].text);
    if (!text) {
        return error_memory(e, "the neighbour search's program", 1);
    }
    snprintf(options, sizeof options, "-DDIM=%d -DCPU=%d -DWG=%d -DEACH=%uul -DSEARCH=%d", s->dim,
             s->cpu, s->cpu ? 1 : 64, search_each(s), (int)s->kind);
    status = device_build(s->d, &s->program[set], text, options, "the neighbour search", e);
    free(text);
    for (int k = sets[set].first; k < sets[set].end && status == 0; k++) {
        const bool orders = k == K_FULL || k == K_SORT_CELLS || k == K_CROWDS;

        if ((k == K_LOOK || k == K_PUT) && !s->cpu) {
            continue;
        }
        status = device_kernel(s->d, s->program[set], name[k], orders ? "order" : "neighbour lists",
                               &s->kernel[k], e);
    }
    return status;
}

/* Of each mask of eight the numbers of its bits. */
static int tables(struct device_search *s, struct error *e)
{
    uint8_t table[256][8] = {{0}};

    for (unsigned mask = 0; mask < 256; mask++) {
        unsigned n = 0;

        for (unsigned k = 0; k < 8; k++) {
            if (mask >> k & 1) {
                table[mask][n++] = (uint8_t)k;
            }
        }
    }
    return device_reserve(s->d, &s->tables, sizeof table, "the neighbour search", e) ||
                   device_write(s->d, &s->tables, 0, table, sizeof table, e)
               ? -1
               : 0;
}

int search_open(struct device_search **out, struct device *d, int dim,
                const struct neighbour_manager *manager, bool cpu, struct error *e)
{
    struct device_search *s = calloc(1, sizeof *s);

    *out = s;
    if (!s) {
        return error_memory(e, "the neighbour search", sizeof *s);
    }
    s->d = d;
    s->dim = dim;
    s->cpu = cpu;
    s->morton = manager == neighbour_manager_at(NEIGHBOURS_OCTREE);
    s->kind = manager == neighbour_manager_at(NEIGHBOURS_CELLS)   ? SEARCH_CELLS
              : manager == neighbour_manager_at(NEIGHBOURS_RADIX) ? SEARCH_KEYS
                                                                  : SEARCH_TREE;
    s->room = dim == 3 ? 384 : dim == 2 ? 128 : 64;
    if (search_need(s, SEARCH_ALL, e) != 0 || tables(s, e) != 0 ||
        device_sort_open(&s->sort, d, cpu, e) != 0 ||
        device_reserve(d, &s->need, 2 * sizeof(uint32_t), "the neighbour search", e) != 0 ||
        device_reserve(d, &s->total, 2 * sizeof(uint64_t), "the neighbour search", e) != 0) {
        device_search_close(s);
        *out = NULL;
        return -1;
    }
    return 0;
}

int device_search_open(struct device_search **out, struct device *d, int dim,
                       const struct neighbour_manager *manager, struct error *e)
{
    return search_open(out, d, dim, manager, device_facts(d)->cpu, e);
}

void device_search_close(struct device_search *s)
{
    if (!s) {
        return;
    }
    struct device_buffer *const all[] = {&s->survey, &s->box,    &s->copy,  &s->order, &s->key,
                                         &s->cell,   &s->begin,  &s->total, &s->need,  &s->tables,
                                         &s->slot,   &s->counts, &s->pairs};
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        device_release(s->d, all[k]);
    }
    device_sort_close(s->sort);
    for (int set = 0; set < SEARCH_SETS; set++) {
        device_program_free(s->d, s->program[set]);
    }
    free(s->host);
    free(s);
}

/* -- What is known of a cloud -------- */

struct search_points search_points_of(const struct device_cloud *c)
{
    return (struct search_points){.x = (uint64_t)c->x_slot * c->plane + c->first,
                                  .h = (uint64_t)c->h_slot * c->plane + c->first,
                                  .plane = c->plane,
                                  .scale = c->scale,
                                  .n = (uint32_t)c->n};
}

void *search_room(struct device_search *s, size_t bytes, struct error *e)
{
    if (bytes > s->host_size) {
        free(s->host);
        s->host = malloc(bytes);
        s->host_size = s->host ? bytes : 0;
        if (!s->host) {
            error_memory(e, "the neighbour search", bytes);
        }
    }
    return s->host;
}

int search_look(struct device_search *s, const struct device_cloud *c, size_t first, bool h,
                struct search_survey *out, struct error *e)
{
    const struct search_points p = search_points_of(c);
    const uint32_t first4 = (uint32_t)first, has_h = h;
    const size_t slices = c->n > first ? search_items(c->n - first, SEARCH_SLICE) : 0;
    const size_t each = (size_t)(2 * s->dim + 3) * LANES, bytes = slices * each * sizeof(double);
    const double *part;

    *out = (struct search_survey){.least = {INFINITY, INFINITY, INFINITY},
                                  .most = {-INFINITY, -INFINITY, -INFINITY},
                                  .good = true};
    if (slices == 0) {
        return 0;
    }
    part = search_room(s, bytes, e);
    if (!part || device_reserve(s->d, &s->survey, bytes, "the neighbour search", e) != 0 ||
        SEARCH_LAUNCH(s, K_SURVEY, s->cpu ? slices : LANES * slices, DEVICE_BUFFER(c->wide),
                      DEVICE_VALUE(p), DEVICE_VALUE(first4), DEVICE_VALUE(has_h),
                      DEVICE_BUFFER(&s->survey)) != 0 ||
        device_read(s->d, &s->survey, 0, s->host, bytes, e) != 0) {
        return -1;
    }
    for (size_t k = 0; k < slices; k++, part += each) {
        const double *sum = part + 2 * LANES * s->dim, *most = sum + LANES, *bad = most + LANES;
        double slice = 0;

        for (int l = 0; l < LANES; l++) {
            for (int a = 0; a < s->dim; a++) {
                out->least[a] = fmin(out->least[a], part[2 * LANES * a + l]);
                out->most[a] = fmax(out->most[a], part[2 * LANES * a + LANES + l]);
            }
            slice += sum[l];
            out->h_most = fmax(out->h_most, most[l]);
            out->good = out->good && !(bad[l] < 0) && !(bad[l] > 0);
        }
        out->h_sum += slice;
    }
    return 0;
}

int search_check(const struct search_survey *v, const char *role, struct error *e)
{
    return v->good ? 0
                   : error_set(e, EXIT_RUN,
                               "a %s particle is nowhere, or its smoothing length is no number "
                               "that can be",
                               role);
}

/* -- An order of the search's own -------- */

static int copy(struct device_search *s, const struct device_cloud *src, bool symmetric,
                struct search_points *p, struct error *e)
{
    const struct search_points from = search_points_of(src);
    const uint32_t has_h = symmetric;
    const uint64_t plane = (src->n + 63) / 64 * 64;

    if (device_reserve(s->d, &s->copy, ((size_t)s->dim + 1) * plane * sizeof(double),
                       "the neighbour search's order", e) != 0 ||
        SEARCH_LAUNCH(s, K_GATHER, search_items(src->n, search_each(s)), DEVICE_BUFFER(src->wide),
                      DEVICE_VALUE(from), DEVICE_VALUE(has_h), DEVICE_BUFFER(&s->order),
                      DEVICE_BUFFER(&s->copy), DEVICE_VALUE(plane)) != 0) {
        return -1;
    }
    p->x = 0;
    p->h = (uint64_t)s->dim * plane;
    p->plane = plane;
    return 0;
}

/* Sorts sources by a key of eight bytes. */
static int sort_keys(struct device_search *s, const struct device_cloud *src,
                     const struct search_index *ix, bool morton, unsigned bits, struct error *e)
{
    const struct search_points p = search_points_of(src);
    const uint32_t along_curve = morton;

    if (search_need(s, SEARCH_OWN_ORDER, e) != 0 ||
        device_reserve(s->d, &s->key, src->n * sizeof(uint64_t), "the neighbour search", e) != 0 ||
        device_reserve(s->d, &s->order, src->n * sizeof(uint32_t), "the neighbour search", e) !=
            0 ||
        SEARCH_LAUNCH(s, K_KEYS, search_items(src->n, search_each(s)), DEVICE_BUFFER(src->wide),
                      DEVICE_VALUE(p), DEVICE_VALUE(*ix), DEVICE_VALUE(along_curve),
                      DEVICE_BUFFER(&s->key), DEVICE_BUFFER(&s->order)) != 0) {
        return -1;
    }
    return device_sort_pairs(s->sort, &s->key, &s->order, src->n, sizeof(uint64_t), bits, e);
}

static unsigned bits_in(double last)
{
    unsigned bits = 0;

    for (uint64_t n = (uint64_t)last; n > 0; n >>= 1) {
        bits++;
    }
    return bits;
}

/* -- The structures -------- */

/* Boxes of the sources' leaves, and of a tree's higher levels. *scattered: leaves much larger than
 * a reach. */
static int boxes_make(struct device_search *s, const struct device_buffer *wide,
                      const struct search_points *p, double typical, struct search_index *ix,
                      uint32_t *scattered, struct error *e)
{
    const size_t block = (size_t)(2 * s->dim + 1) * LANES * sizeof(double);
    size_t nodes = ix->n_leaf, blocks = 0;
    const uint32_t first = (uint32_t)search_items(nodes, LANES);

    for (ix->n_level = 0; ix->n_level == 0 || (nodes > 1 && s->kind == SEARCH_TREE);
         ix->n_level++) {
        ix->offset[ix->n_level] = (uint32_t)blocks;
        ix->nodes[ix->n_level] = (uint32_t)nodes;
        nodes = search_items(nodes, LANES);
        blocks += nodes;
    }
    if (device_reserve(s->d, &s->box, blocks * block, "the neighbour search's boxes", e) != 0 ||
        device_fill(s->d, &s->need, 4, 0, 4, e) != 0 ||
        SEARCH_LAUNCH(s, K_LEAVES, search_items(first, s->cpu ? 64 : 1), DEVICE_BUFFER(wide),
                      DEVICE_VALUE(*p), DEVICE_BUFFER(&s->box), DEVICE_VALUE(first),
                      DEVICE_VALUE(typical), DEVICE_BUFFER(&s->need)) != 0) {
        return -1;
    }
    for (uint32_t l = 1; l < ix->n_level; l++) {
        const uint32_t above = (uint32_t)search_items(ix->nodes[l], LANES);

        if (SEARCH_LAUNCH(s, K_BOXES, above, DEVICE_BUFFER(&s->box),
                          DEVICE_VALUE(ix->offset[l - 1]), DEVICE_VALUE(ix->nodes[l]),
                          DEVICE_VALUE(ix->offset[l]), DEVICE_VALUE(above)) != 0) {
            return -1;
        }
    }
    return device_read(s->d, &s->need, 4, scattered, 4, e);
}

static int morton(struct device_search *s, const struct device_cloud *src,
                  const struct search_survey *all, struct search_index *ix, struct error *e)
{
    static const unsigned axis_bits[4] = {0, 52, 30, 21};
    const double cells = (double)(1ull << axis_bits[s->dim]);
    double longest = 1e-290;

    for (int a = 0; a < s->dim; a++) {
        longest = fmax(longest, all->most[a] - all->least[a]);
        ix->low[a] = all->least[a];
        ix->last[a] = cells - 1;
    }
    ix->inverse = cells / longest;
    return sort_keys(s, src, ix, true, axis_bits[s->dim] * (unsigned)s->dim, e);
}

static int keys_make(struct device_search *s, const struct device_cloud *src,
                     const struct search_survey *all, double query, struct search_index *ix,
                     struct error *e)
{
    double edge = query > 1e-290 ? query : 1e-290;
    unsigned bits = KEY_BITS * (unsigned)(s->dim - 1);
    const int top = s->dim - 1;

    for (int a = 0; a < s->dim; a++) {
        edge = fmax(edge, (all->most[a] - all->least[a]) / (1 << KEY_BITS));
    }
    ix->inverse = 1 / edge;
    for (int a = 0; a < s->dim; a++) {
        ix->low[a] = all->least[a];
        ix->last[a] = (1 << KEY_BITS) - 1;
        ix->step[a] = 1ull << KEY_BITS * a;
    }
    bits += bits_in(fmin(ix->last[top], (all->most[top] - all->least[top]) * ix->inverse + 1));
    return sort_keys(s, src, ix, false, bits, e);
}

int search_cells(struct device_search *s, const struct device_cloud *c, const struct grid *g,
                 struct search_index *ix, struct error *e)
{
    const struct search_points p = search_points_of(c);

    if (g->n >= UINT32_MAX) {
        return error_set(e, EXIT_RUN, "%zu particles: too many cells for a device", c->n);
    }
    ix->inverse = g->inverse;
    for (int a = 0; a < s->dim; a++) {
        ix->low[a] = g->low[a];
        ix->last[a] = g->last[a];
        ix->step[a] = g->step[a];
    }
    if (device_reserve(s->d, &s->cell, c->n * sizeof(uint32_t), "the neighbour search", e) != 0 ||
        device_reserve(s->d, &s->begin, (g->n + 1) * sizeof(uint32_t), "the neighbour search", e) !=
            0 ||
        device_fill(s->d, &s->begin, 0, 0, (g->n + 1) * sizeof(uint32_t), e) != 0) {
        return -1;
    }
    return SEARCH_LAUNCH(s, K_CELL, search_items(c->n, search_each(s)), DEVICE_BUFFER(c->wide),
                         DEVICE_VALUE(p), DEVICE_VALUE(*ix), DEVICE_BUFFER(&s->cell),
                         DEVICE_BUFFER(&s->begin));
}

static int cells_make(struct device_search *s, const struct device_cloud *src,
                      const struct search_survey *all, double query, struct search_index *ix,
                      struct error *e)
{
    struct grid g;

    grid_init(&g, all->least, all->most, s->dim, query, src->n);
    if (search_cells(s, src, &g, ix, e) != 0 ||
        device_scan(s->sort, &s->begin, 0, g.n, &s->begin, 0, &s->total, 0, e) != 0) {
        return -1;
    }
    return sort_keys(s, src, ix, false, bits_in((double)g.n), e);
}

int search_make(struct device_search *s, const struct device_cloud *src,
                const struct search_survey *all, bool symmetric, double factor, double typical,
                double query, struct search_index *ix, struct search_points *p, struct error *e)
{
    const uint32_t n_leaf = (uint32_t)search_items(src->n, LANES);
    uint32_t scattered = 0;

    *ix = (struct search_index){.n = (uint32_t)src->n, .n_leaf = n_leaf};
    *p = search_points_of(src);
    p->scale = symmetric ? factor * src->scale : 0;
    ix->reach = symmetric ? p->scale * all->h_most : 0;
    s->own_order = s->kind != SEARCH_TREE || s->morton;
    if (s->kind == SEARCH_CELLS || s->kind == SEARCH_KEYS) {
        const int status = s->kind == SEARCH_CELLS ? cells_make(s, src, all, query, ix, e)
                                                   : keys_make(s, src, all, query, ix, e);

        return status == 0 && copy(s, src, symmetric, p, e) == 0
                   ? boxes_make(s, &s->copy, p, typical, ix, &scattered, e)
                   : -1;
    }
    if (!s->own_order) {
        if (boxes_make(s, src->wide, p, typical, ix, &scattered, e) != 0) {
            return -1;
        }
        s->own_order = typical > 0 && n_leaf > 64 && scattered > n_leaf / 4;
    }
    if (!s->own_order) {
        return 0;
    }
    if (morton(s, src, all, ix, e) != 0 || copy(s, src, symmetric, p, e) != 0) {
        return -1;
    }
    return boxes_make(s, &s->copy, p, typical, ix, &scattered, e);
}
