/* neighbours/filter.h -- the inner loops of the neighbour search: which boxes are near a query,
 * and which sources are within reach of any destination of a group. Plain C, and the same with
 * AVX2 and FMA where the processor has them; both keep what is within reach, and may differ on
 * what lies within SLACK beyond it. */
#ifndef NEIGHBOURS_FILTER_H
#define NEIGHBOURS_FILTER_H

#include "neighbours/sources.h"

#include <math.h>

struct box8 { /* eight boxes, and the largest reach in each */
    double lo[3][LEAF], hi[3][LEAF], reach[LEAF];
};

/* A query's centre and unit of length. */
struct frame {
    double centre[3], inverse;
};

/* A leaf's points in a query's frame. */
struct packed_leaf {
    float x[3][LEAF];
    float s[LEAF];  /* square of the distance to the centre; INFINITY: no point */
    float r2[LEAF]; /* square of its reach; 0 if that does not count */
};

struct packed_box8 { /* eight leaves' boxes, likewise */
    float lo[3][LEAF], hi[3][LEAF], reach[LEAF];
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

/* Sources of a group, by the lanes that see them. */
enum { BY_BOTH, BY_LOWER, BY_UPPER, BY_SIDES };
struct found {
    uint32_t *source[BY_SIDES];
    size_t n[BY_SIDES], capacity[BY_SIDES];
};

/* Points in columns, whose reach is scale * h; h may be NULL if scale is 0. */
struct points {
    const double *const *x, *h;
    double scale;
    size_t n;
    int dim;
};

struct filter {
    /* Boxes of the eight leaves from `leaf` on, and the least reach in each; those beyond the last
     * point are empty. */
    void (*eight)(struct box8 *out, double *least, const struct points *p, size_t leaf);
    /* Bit k: box k of the eight is nearer to the query than the larger reach, MARGIN included. */
    unsigned (*near_boxes)(const struct box8 *boxes, const struct query *q, int dim);
    /* Fills the packs of n leaves, at most eight, and the boxes around them; those that are left of
     * the eight are at infinity. */
    void (*pack)(struct packed_leaf *p, struct packed_box8 *box, const struct sources *s,
                 const struct frame *f, const uint32_t *leaf, size_t n);
    /* Destinations [first, last) of a cloud, at most eight, whose reach is scale * h. */
    void (*lanes)(struct lanes *t, const struct cloud *c, double scale, const struct frame *f,
                  size_t first, size_t last);
    /* Writes which of n packed boxes (padded to a multiple of 8 by boxes at infinity) are near
     * the lanes, as numbers within the pack; their count. Room for n + 8. */
    size_t (*near_leaves)(const struct packed_box8 *boxes, size_t n, const struct lanes *t, int dim,
                          uint32_t *out);
    /* Appends to `out` the index 8 leaf[k] + i of every source of those leaves that a lane sees; of
     * leaf `own` as if both halves of the lanes saw it. Room for 8 n + STEPS_MORE in each. */
    void (*near_points)(const struct packed_leaf *pack, const uint32_t *leaf,
                        const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                        uint32_t own, struct found *out);
    /* Writes found[k] - base; room for STEPS_MORE beyond n, read and written. */
    void (*steps)(uint16_t *out, const uint32_t *found, size_t n, uint32_t base);
    /* Likewise lower[0], upper[0], lower[1], ... */
    void (*turns)(uint16_t *out, const uint32_t *lower, const uint32_t *upper, size_t n,
                  uint32_t base);
};

#define STEPS_MORE 32
#define UNIFORM 1.004f /* reaches of a group that differ less are taken as one */
/* Points further away than so many units are taken to be there: squares must stay numbers. */
#define FILTER_FAR 1e18

/* The filter for this processor; the plain one; those for AVX2 and AVX-512, NULL where there is
 * none. */
const struct filter *filter_best(void);
const struct filter *filter_plain(void);
const struct filter *filter_avx2(void);
const struct filter *filter_avx512(void);
/* near_boxes and near_points for AVX-512; on x86-64 alone. */
unsigned filter_near_boxes_avx512(const struct box8 *boxes, const struct query *q, int dim);
void filter_near_points_avx512(const struct packed_leaf *pack, const uint32_t *leaf,
                               const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                               uint32_t own, struct found *out);

/* Eight values of a column from `first` on, those beyond `last` as the one before it. */
static inline const double *filter_eight(const double *x, size_t first, size_t last, double *room)
{
    if (last - first >= LEAF) {
        return x + first;
    }
    for (size_t k = 0; k < LEAF; k++) {
        room[k] = x[first + k < last ? first + k : last - 1];
    }
    return room;
}

/* How many bits of a byte are set; processors that count them are not asked for everywhere. */
static inline unsigned bits_of(unsigned byte)
{
    byte -= byte >> 1 & 0x55;
    byte = (byte & 0x33) + (byte >> 2 & 0x33);
    return (byte + (byte >> 4)) & 0xf;
}

static inline void box_empty(struct box8 *b, size_t k)
{
    for (int a = 0; a < 3; a++) {
        b->lo[a][k] = INFINITY;
        b->hi[a][k] = -INFINITY;
    }
    b->reach[k] = 0;
}

/* Makes box k of `out`, and *least, those of points [first, last). */
static inline void box_of(struct box8 *out, double *least, const struct points *p, size_t k,
                          size_t first, size_t last)
{
    box_empty(out, k);
    *least = p->scale > 0 ? INFINITY : 0;
    for (size_t i = first; i < last; i++) {
        double reach = p->scale > 0 ? p->scale * p->h[i] : 0;

        for (int a = 0; a < p->dim; a++) {
            double x = p->x[a][i];

            out->lo[a][k] = x < out->lo[a][k] ? x : out->lo[a][k];
            out->hi[a][k] = x > out->hi[a][k] ? x : out->hi[a][k];
        }
        out->reach[k] = reach > out->reach[k] ? reach : out->reach[k];
        *least = reach < *least ? reach : *least;
    }
    for (int a = p->dim; a < 3 && first < last; a++) {
        out->lo[a][k] = out->hi[a][k] = 0;
    }
}

/* Makes box k of `out` the one around eight. */
static inline void box_around(const struct box8 *eight, struct box8 *out, size_t k)
{
    box_empty(out, k);
    for (size_t i = 0; i < LEAF; i++) {
        for (int a = 0; a < 3; a++) {
            double lo = eight->lo[a][i], hi = eight->hi[a][i];

            out->lo[a][k] = lo < out->lo[a][k] ? lo : out->lo[a][k];
            out->hi[a][k] = hi > out->hi[a][k] ? hi : out->hi[a][k];
        }
        out->reach[k] = eight->reach[i] > out->reach[k] ? eight->reach[i] : out->reach[k];
    }
}

/* group_list_make with a filter of the caller's choice. */
int filter_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                bool symmetric, double skin, const struct neighbour_manager *manager, int threads,
                const struct filter *filter, struct error *e);

#endif
