/* neighbours/sources.h -- the points among which neighbours are sought, in leaves of eight that
 * stand side by side in memory. Neighbours in the order should be neighbours in space, as after
 * cell_order; a cloud that is not so ordered is read through an order of the search's own. */
#ifndef NEIGHBOURS_SOURCES_H
#define NEIGHBOURS_SOURCES_H

#include "neighbours/neighbours.h"

#define LEAF 8

/* Every reach is enlarged so much, relatively: covers the rounding of the filter's single
 * precision for groups up to SPREAD_MOST times the smallest reach in them. */
#define SLACK 5e-5
#define SPREAD_MOST 8.0
/* ... and so much more wherever leaves are left out as a whole, so that none is whose points the
 * filter would have taken: hence lists do not depend on who searches. */
#define MARGIN 1e-4

struct sources {
    int dim;
    size_t n, n_leaf;
    const double *x[3]; /* of the points in the search's order; axes beyond dim are NULL */
    const double *h;
    double scale;          /* reach = scale * h; 0 if only the asker's reach counts */
    double largest;        /* reach; 0 if it does not count */
    double typical;        /* reach of those that ask: their mean */
    double query;          /* largest reach of any that asks or is asked for */
    const uint32_t *order; /* index of the k-th point; NULL: it is k */
    double *copy;          /* owned: points in the search's order, if it has one */
    uint32_t *own_order;
    size_t bytes;
};

/* What is asked for: sources nearer to this box than the larger of `reach` and their own. */
struct query {
    double lo[3], hi[3], reach;
};

/* Clouds as in group_list_make, which are checked; `factor` enlarges every reach. The clouds must
 * outlive the sources. */
int sources_make(struct sources *s, const struct cloud *dst, const struct cloud *src,
                 bool symmetric, double factor, int threads, struct error *e);
void sources_free(struct sources *s);
void sources_bounds(const struct sources *s, int threads, double *lo, double *hi);

/* Fails with the first point whose position is not finite, or whose h is negative or not finite. */
int cloud_check(const struct cloud *c, const char *role, int threads, struct error *e);

#endif
