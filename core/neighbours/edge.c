/* neighbours/edge.c -- the edge of the cells that make good groups of points. Reads points only.
 *
 * The fewer sources a group of eight has the closer together it is, whatever the reach: so the
 * edge follows the spacing, and that is measured, for schemes differ in how many spacings h is. */
#include "neighbours/edge.h"

#include "neighbours/neighbours.h"
#include "neighbours/range.h"

#include <math.h>
#include <stdlib.h>

#define WIDE 1.5 /* the largest reach in units of the mean, from which they range widely */

static double slice_sum(const double *h, size_t n)
{
    double lane[EDGE_LANES] = {0}, sum = 0;
    size_t i = 0;

    for (; i + EDGE_LANES <= n; i += EDGE_LANES) {
        for (size_t l = 0; l < EDGE_LANES; l++) {
            lane[l] += h[i + l];
        }
    }
    for (size_t l = 0; i + l < n; l++) {
        lane[l] += h[i + l];
    }
    for (size_t l = 0; l < EDGE_LANES; l++) {
        sum += lane[l];
    }
    return sum;
}

static struct edge_known know(const struct cloud *c)
{
    struct edge_known k = {.dim = c->dim, .n = c->n, .scale = c->scale};

    for (size_t i = 0; i < c->n; i += EDGE_SLICE) {
        k.h_sum += slice_sum(c->h + i, c->n - i < EDGE_SLICE ? c->n - i : EDGE_SLICE);
    }
    k.h_most = range_of(c->h, c->n, 1).most;
    for (int a = 0; a < c->dim; a++) {
        struct range r = range_of(c->x[a], c->n, 1);

        k.least[a] = r.least;
        k.most[a] = r.most;
    }
    return k;
}

bool edge_begin(const struct edge_known *k, struct grid *g, double *edge)
{
    double mean = k->n > 0 ? k->scale * k->h_sum / (double)k->n : 0;
    bool even = k->scale * k->h_most <= WIDE * mean && mean > 0;

    if (!even) { /* reaches range widely, or a number is none */
        *edge = k->dim == 3 ? 3 * mean : 3.9 * mean;
        return false;
    }
    *edge = mean;
    for (int a = 0; a < k->dim; a++) {
        if (!(k->most[a] - k->least[a] < 1e150)) {
            return false; /* a number is none */
        }
    }
    grid_init(g, k->least, k->most, k->dim, k->dim == 3 ? 2 * mean : 3 * mean, k->n);
    return true;
}

double edge_end(const struct edge_known *k, const struct grid *g, double sum, double cells)
{
    double distance = pow(sum / cells, -1.0 / k->dim) / g->inverse;

    return distance > 0 ? distance * (k->dim == 3 ? 2.0 : 3.2) : k->scale * k->h_sum / (double)k->n;
}

double cell_best(const struct cloud *points)
{
    struct edge_known k = know(points);
    double edge, squares = 0, sum = 0, cells = 0;
    struct grid g;
    uint32_t *count;

    if (!edge_begin(&k, &g, &edge)) {
        return edge;
    }
    count = calloc(g.n, sizeof *count);
    if (!count) {
        return edge;
    }
    for (size_t i = 0; i < points->n; i++) {
        count[grid_cell(&g, points->x, i)]++;
    }
    for (size_t q = 0; q < g.n; q++) {
        squares += (double)count[q] * (double)count[q];
    }
    /* Those at a surface would make it less. */
    for (size_t q = 0; q < g.n; q++) {
        if (count[q] >= EDGE_FULL * squares / (double)k.n) {
            sum += (double)count[q];
            cells++;
        }
    }
    free(count);
    return edge_end(&k, &g, sum, cells);
}
