/* opencl/order.c -- the order of particles on a device: cell_order and cell_best, index for index
 * (see lists.h; the kernels are order.cl and crowds.cl). What is known of all points comes back to
 * the host, which reckons the cells as it does for itself. */
#include "config.h"

#include "neighbours/edge.h"
#include "opencl/search.h"

#define COUNTS 4096 /* cells whose counts a work item adds up, on a processor */

/* Over the cells' counts: the sum of their squares, of those that are not less than `least`, how many these are. */
static int sums(struct device_search *s, size_t cells, double least, double out[3], struct error *e)
{
    const uint32_t n = (uint32_t)cells, each = s->cpu ? COUNTS : 256;
    const size_t items = search_items(cells, each), bytes = items * 3 * sizeof(uint64_t);
    const uint64_t *part = search_room(s, bytes, e);

    if (!part || device_reserve(s->d, &s->survey, bytes, "the order of particles", e) != 0 ||
        SEARCH_LAUNCH(s, K_FULL, items, DEVICE_BUFFER(&s->begin), DEVICE_VALUE(n),
                      DEVICE_VALUE(each), DEVICE_VALUE(least), DEVICE_BUFFER(&s->survey)) != 0 ||
        device_read(s->d, &s->survey, 0, s->host, bytes, e) != 0) {
        return -1;
    }
    out[0] = out[1] = out[2] = 0;
    for (size_t k = 0; k < 3 * items; k++) {
        out[k % 3] += (double)part[k];
    }
    return 0;
}

/* cell_best */
static int best(struct device_search *s, const struct device_cloud *c,
                const struct search_survey *v, double *edge, struct error *e)
{
    struct edge_known k = {
        .dim = s->dim, .n = c->n, .scale = c->scale, .h_sum = v->h_sum, .h_most = v->h_most};
    struct search_index ix = {.n = (uint32_t)c->n};
    double first[3], full[3];
    struct grid g;

    for (int a = 0; a < s->dim; a++) {
        k.least[a] = v->least[a];
        k.most[a] = v->most[a];
    }
    if (!edge_begin(&k, &g, edge)) {
        return 0;
    }
    if (search_cells(s, c, &g, &ix, e) != 0 || sums(s, g.n, 0, first, e) != 0 ||
        sums(s, g.n, EDGE_FULL * first[0] / (double)c->n, full, e) != 0) {
        return -1;
    }
    *edge = edge_end(&k, &g, full[1], full[2]);
    return 0;
}

/* Cells with more points than are sorted by x alone. */
static int crowds(struct device_search *s, const struct search_points *p,
                  const struct device_cloud *c, uint64_t id, const struct grid *g,
                  const struct device_buffer *order, struct error *e)
{
    const uint32_t row = (uint32_t)g->last[0] + 1;
    uint32_t n;

    if (device_read(s->d, &s->pairs, 0, &n, sizeof n, e) != 0) {
        return -1;
    }
    if (n == 0) {
        return 0;
    }
    if (search_need(s, SEARCH_CROWDS, e) != 0 ||
        device_reserve(s->d, &s->copy, 4 * c->n * sizeof(double), "the order of particles", e) !=
            0) {
        return -1;
    }
    return SEARCH_LAUNCH(s, K_CROWDS, n, DEVICE_BUFFER(c->wide), DEVICE_VALUE(*p), DEVICE_VALUE(id),
                         DEVICE_VALUE(row), DEVICE_BUFFER(&s->begin), DEVICE_BUFFER(order),
                         DEVICE_BUFFER(&s->pairs), DEVICE_BUFFER(&s->copy));
}

int device_order(struct device_search *s, const struct device_cloud *points, uint32_t id_slot,
                 struct device_buffer *order, struct error *e)
{
    const struct search_points p = search_points_of(points);
    const uint64_t id = (uint64_t)id_slot * points->plane + points->first;
    const uint32_t n = (uint32_t)points->n;
    struct search_index ix = {.n = n};
    struct search_survey v;
    double lo[3], edge;
    struct grid g;
    uint32_t cells;

    if (points->n > UINT32_MAX / 4) {
        return error_set(e, EXIT_RUN, "%zu particles: at most %u are possible on a device",
                         points->n, UINT32_MAX / 4);
    }
    if (search_look(s, points, 0, true, &v, e) != 0 || search_check(&v, "source", e) != 0 ||
        device_reserve(s->d, order, (points->n + 1) * sizeof(uint32_t), "the order of particles",
                       e) != 0) {
        return -1;
    }
    if (points->n == 0) {
        return 0;
    }
    if (best(s, points, &v, &edge, e) != 0) {
        return -1;
    }
    edge = edge > 0 ? edge : 0;
    for (int a = 0; a < s->dim; a++) {
        lo[a] = v.least[a] - 0.25 * edge;
    }
    grid_init(&g, lo, v.most, s->dim, edge, points->n);
    cells = (uint32_t)g.n;
    if (search_cells(s, points, &g, &ix, e) != 0 ||
        device_scan(s->sort, &s->begin, 0, g.n, &s->begin, 0, &s->total, 0, e) != 0 ||
        SEARCH_LAUNCH(s, K_SCATTER, search_items(points->n, search_each(s)),
                      DEVICE_BUFFER(&s->cell), DEVICE_VALUE(n), DEVICE_BUFFER(&s->begin),
                      DEVICE_BUFFER(order)) != 0 ||
        device_reserve(s->d, &s->pairs, (points->n / 32 + 2) * sizeof(uint32_t),
                       "the order of particles", e) != 0 ||
        device_fill(s->d, &s->pairs, 0, 0, sizeof(uint32_t), e) != 0 ||
        SEARCH_LAUNCH(s, K_SORT_CELLS, search_items(g.n, search_each(s)),
                      DEVICE_BUFFER(points->wide), DEVICE_VALUE(p), DEVICE_VALUE(id),
                      DEVICE_VALUE(cells), DEVICE_BUFFER(&s->begin), DEVICE_BUFFER(order),
                      DEVICE_BUFFER(&s->pairs)) != 0) {
        return -1;
    }
    return crowds(s, &p, points, id, &g, order, e);
}
