/* neighbours/grid.h -- cells of equal edge over a box, their number bounded by that of the
 * points. */
#ifndef NEIGHBOURS_GRID_H
#define NEIGHBOURS_GRID_H

#include <math.h>
#include <stddef.h>

struct grid {
    int dim;
    double low[3], inverse; /* of the edge */
    double last[3];         /* cells along an axis, less one */
    size_t step[3], n;      /* from cell to cell along an axis; all cells */
};

/* Number of cells of this edge; infinite if there are too many to count. */
static inline double grid_count(const double *lo, const double *hi, int dim, double edge)
{
    double n = 1;

    for (int a = 0; a < dim; a++) {
        n *= floor((hi[a] - lo[a]) / edge) + 2;
    }
    return n;
}

/* The edge is enlarged until there are at most two cells a point. */
static inline void grid_init(struct grid *g, const double *lo, const double *hi, int dim,
                             double edge, size_t points)
{
    double most = 2 * (double)points + 64;

    edge = edge > 1e-290 ? edge : 1e-290;
    for (int a = 0; a < dim; a++) {
        edge = edge > 1e-11 * (hi[a] - lo[a]) ? edge : 1e-11 * (hi[a] - lo[a]);
    }
    while (!(grid_count(lo, hi, dim, edge) <= most)) {
        edge *= 1.25;
    }
    g->dim = dim;
    g->inverse = 1 / edge;
    g->n = 1;
    for (int a = 0; a < dim; a++) {
        /* At a multiple of the edge, so that the cells stay while the extremes move. */
        double anchor = edge * floor(lo[a] / edge);

        g->low[a] = anchor <= lo[a] && lo[a] - anchor <= edge ? anchor : lo[a];
        g->last[a] = floor((hi[a] - g->low[a]) * g->inverse);
        g->step[a] = g->n;
        g->n *= (size_t)g->last[a] + 1;
    }
}

/* The number along an axis of the cell that holds x, or is nearest to it. */
static inline size_t grid_along(const struct grid *g, int axis, double x)
{
    double q = (x - g->low[axis]) * g->inverse;

    q = q < g->last[axis] ? q : g->last[axis];
    return q > 0 ? (size_t)q : 0;
}

static inline size_t grid_cell(const struct grid *g, const double *const *x, size_t i)
{
    size_t cell = grid_along(g, 0, x[0][i]);

    for (int a = 1; a < g->dim; a++) {
        cell += g->step[a] * grid_along(g, a, x[a][i]);
    }
    return cell;
}

#endif
