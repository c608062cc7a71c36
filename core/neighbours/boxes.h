/* neighbours/boxes.h -- a tree of bounding boxes over a cloud's points in the order in which they
 * stand: leaves are runs of 8 points, and 8 boxes make the box above. Points that are neighbours in
 * the order should be neighbours in space, as after cell_order; a cloud that is not so ordered is
 * read through an order of the tree's own. Each box keeps the largest reach in it, so that a few
 * large smoothing lengths cost little. Memory: 7 bytes a point, wherever the points are. */
#ifndef NEIGHBOURS_BOXES_H
#define NEIGHBOURS_BOXES_H

#include "neighbours/neighbours.h"

#define BOXES_FAN 8
#define BOXES_LEVELS 11 /* 8^11 leaves and points have room in 32 bits */

struct box8 { /* eight sisters */
    double lo[3][BOXES_FAN], hi[3][BOXES_FAN], reach[BOXES_FAN];
};

struct boxes {
    int dim;
    size_t n, n_leaf;
    const double *x[3]; /* of the points in the tree's order; axes beyond dim are NULL */
    const double *h;
    double scale;          /* reach = scale * h; 0 if only the asker's reach counts */
    const uint32_t *order; /* index of the k-th point; NULL: it is k */
    int n_level;
    struct box8 *level[BOXES_LEVELS]; /* [0]: of the leaves */
    size_t n_node[BOXES_LEVELS];      /* boxes in use at each level */
    double *copy;                     /* owned: points in the tree's order, if it has one */
    uint32_t *own_order;
};

/* What is asked for: sources nearer to this box than the larger of `reach` and their own. */
struct query {
    double lo[3], hi[3], reach;
};

/* `scale` makes the reach out of h, skin and slack included; 0 if the sources' reach does not
 * count. `typical` is the reach by which an order is judged. The cloud must outlive the tree. */
int boxes_make(struct boxes *b, const struct cloud *cloud, double scale, double typical,
               int threads, struct error *e);
void boxes_free(struct boxes *b);

/* Fails with the first point whose position is not finite, or whose h is negative or not finite. */
int boxes_check(const struct cloud *c, const char *role, struct error *e);

#endif
