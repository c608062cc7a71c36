/* neighbours/edge.c -- the edge of the cells that make good groups of points. Reads points only.
 *
 * The fewer sources a group of eight has the closer together it is, whatever the reach: so the
 * edge follows the spacing, and that is measured, for schemes differ in how many spacings h is. */
#include "neighbours/neighbours.h"

#include "neighbours/grid.h"
#include "neighbours/range.h"

#include <math.h>
#include <stdlib.h>

#define WIDE 1.5 /* the largest reach in units of the mean, from which they range widely */
#define FULL 0.7 /* cells with fewer points, in units of what a point's own cell has, are cut off */

/* The mean reach; 0 if they range widely or a number is none. */
static double even_reach(const struct cloud *c, double *mean)
{
    double sum = 0;

    for (size_t i = 0; i < c->n; i++) {
        sum += c->h[i];
    }
    *mean = c->n > 0 ? c->scale * sum / (double)c->n : 0;
    return c->scale * range_of(c->h, c->n, 1).most <= WIDE * *mean ? *mean : 0;
}

/* Points in a full cell, by the counts of all cells: those at a surface would make it less. */
static double full_count(const uint32_t *count, size_t n, double points)
{
    double squares = 0, sum = 0, cells = 0;

    for (size_t k = 0; k < n; k++) {
        squares += (double)count[k] * (double)count[k];
    }
    for (size_t k = 0; k < n; k++) {
        if (count[k] >= FULL * squares / points) {
            sum += (double)count[k];
            cells++;
        }
    }
    return sum / cells;
}

/* The mean distance of points, measured in cells of this edge; 0 if it cannot be. */
static double spacing(const struct cloud *c, double edge)
{
    double lo[3], hi[3], full;
    struct grid g;
    uint32_t *count;

    for (int a = 0; a < c->dim; a++) {
        struct range r = range_of(c->x[a], c->n, 1);

        lo[a] = r.least;
        hi[a] = r.most;
        if (!(hi[a] - lo[a] < 1e150)) {
            return 0; /* a number is none */
        }
    }
    grid_init(&g, lo, hi, c->dim, edge, c->n);
    count = calloc(g.n, sizeof *count);
    if (!count) {
        return 0;
    }
    for (size_t i = 0; i < c->n; i++) {
        count[grid_cell(&g, c->x, i)]++;
    }
    full = full_count(count, g.n, (double)c->n);
    free(count);
    return pow(full, -1.0 / c->dim) / g.inverse;
}

double cell_best(const struct cloud *points)
{
    double mean, reach = even_reach(points, &mean), distance;

    if (!(reach > 0)) {
        return points->dim == 3 ? 3 * mean : 3.9 * mean;
    }
    distance = spacing(points, points->dim == 3 ? 2 * reach : 3 * reach);
    return distance > 0 ? distance * (points->dim == 3 ? 3.9 : 3.2) : reach;
}
