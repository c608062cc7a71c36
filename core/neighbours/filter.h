/* neighbours/filter.h -- the inner loops of the neighbour search: which boxes of the tree are
 * near a query, and which sources are within reach of any destination of a group. Plain C, and
 * the same with AVX2 and FMA where the processor has them; both keep what is within reach, and
 * may differ on what lies within SLACK beyond it. */
#ifndef NEIGHBOURS_FILTER_H
#define NEIGHBOURS_FILTER_H

#include "neighbours/boxes.h"

/* Every reach is enlarged so much, relatively: covers the rounding of the filter's single
 * precision for groups up to SPREAD_MOST times the smallest reach in them. */
#define SLACK 5e-5
#define SPREAD_MOST 8.0

/* A query's centre and unit of length. */
struct frame {
    double centre[3], inverse;
};

/* A leaf's points in a query's frame. */
struct packed_leaf {
    float x[3][BOXES_FAN];
    float s[BOXES_FAN];  /* square of the distance to the centre; INFINITY: no point */
    float r2[BOXES_FAN]; /* square of its reach; 0 if that does not count */
};

struct packed_box8 { /* eight leaves' boxes, likewise */
    float lo[3][BOXES_FAN], hi[3][BOXES_FAN], reach[BOXES_FAN];
};

/* A group's destinations, likewise. Lane i sees a source b if s - 2 a.b + a^2 <= max(reach^2,
 * r2). */
struct lanes {
    float m2a[3][8];           /* -2 a */
    float a2[8];               /* a^2; INFINITY: no destination */
    float r2[8];               /* reach^2 */
    float lo[3], hi[3], reach; /* the box around them, their largest reach */
    uint32_t uniform;          /* 1: the largest reach serves for all */
};

struct filter {
    /* Bit k: box k of the eight is nearer to the query than the larger reach. */
    unsigned (*near_boxes)(const struct box8 *boxes, const struct query *q, int dim);
    /* Fills a leaf's pack. */
    void (*pack)(struct packed_leaf *p, const struct boxes *t, const struct frame *f,
                 uint32_t leaf);
    /* Writes which of n packed boxes (padded to a multiple of 8 by boxes at infinity) are near
     * the lanes, as numbers within the pack; their count. Room for n + 8. */
    size_t (*near_leaves)(const struct packed_box8 *boxes, size_t n, const struct lanes *t, int dim,
                          uint32_t *out);
    /* Writes the index 8 leaf[k] + i of every source of those leaves that a lane sees; their
     * count. Room for 8 (n + 1). */
    size_t (*near_points)(const struct packed_leaf *pack, const uint32_t *leaf,
                          const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                          uint32_t *out);
    /* Writes found[k] - base; room for STEPS_MORE beyond n, read and written. */
    void (*steps)(uint16_t *out, const uint32_t *found, size_t n, uint32_t base);
};

#define STEPS_MORE 16

/* The filter for this processor; the plain one for the tests. */
const struct filter *filter_best(void);
const struct filter *filter_plain(void);

/* group_list_make with a filter of the caller's choice. */
int filter_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                bool symmetric, double skin, int threads, const struct filter *filter,
                struct error *e);

#endif
