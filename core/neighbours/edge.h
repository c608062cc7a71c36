/* neighbours/edge.h -- what cell_best reckons with, for who looks at the points elsewhere: on a
 * device. Numbers alone. */
#ifndef NEIGHBOURS_EDGE_H
#define NEIGHBOURS_EDGE_H

#include "neighbours/grid.h"

#include <stdbool.h>

/* The sum of h is that of slices, in their order, and a slice's that of its lanes: lane l has every
 * EDGE_LANES-th from the l-th on. */
#define EDGE_SLICE 4096
#define EDGE_LANES 8
#define EDGE_FULL                                                                                  \
    0.7 /* cells with fewer points, in units of what a point's own cell has, are cut off */

/* What is known of points: the sum of h, the largest, their extremes. */
struct edge_known {
    int dim;
    size_t n;
    double scale, h_sum, h_most, least[3], most[3];
};

/* False: *edge is what is best. True: it is not yet, the points are to be counted in the cells of
 * *g. */
bool edge_begin(const struct edge_known *k, struct grid *g, double *edge);
/* sum: points in the cells that have at least EDGE_FULL * squares / n of them, `cells` of them;
 * squares: the sum of all cells' squares. */
double edge_end(const struct edge_known *k, const struct grid *g, double sum, double cells);

#endif
