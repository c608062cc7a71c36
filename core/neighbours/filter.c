/* neighbours/filter.c -- the neighbour search's inner loops, in plain C. Pure. */
#include "neighbours/filter.h"

#include <math.h>
#include <string.h>

static void plain_eight(struct box8 *out, double *least, const struct points *p, size_t leaf)
{
    for (size_t k = 0; k < LEAF; k++) {
        size_t first = (leaf + k) * LEAF, last = first + LEAF;

        box_of(out, &least[k], p, k, first, last < p->n ? last : p->n);
    }
}

static unsigned plain_near_boxes(const struct box8 *b, const struct query *q, int dim)
{
    double gap[LEAF] = {0};
    unsigned mask = 0;

    for (int a = 0; a < dim; a++) {
        for (int k = 0; k < LEAF; k++) {
            double below = b->lo[a][k] - q->hi[a], above = q->lo[a] - b->hi[a][k];
            double d = below > above ? below : above;

            d = d > 0 ? d : 0;
            gap[k] += d * d;
        }
    }
    for (unsigned k = 0; k < LEAF; k++) {
        double reach = b->reach[k] > q->reach ? b->reach[k] : q->reach;

        reach *= 1 + MARGIN;
        mask |= (unsigned)(gap[k] <= reach * reach) << k;
    }
    return mask;
}

static void plain_pack_one(struct packed_leaf *p, struct packed_box8 *box, size_t k,
                           const struct sources *s, const struct frame *f, uint32_t leaf)
{
    size_t first = (size_t)leaf * LEAF, last = first + LEAF < s->n ? first + LEAF : s->n;
    double room[LEAF];
    const double *h;

    memset(p, 0, sizeof *p);
    for (int a = 0; a < s->dim; a++) {
        const double *from = filter_eight(s->x[a], first, last, room);

        for (size_t i = 0; i < LEAF; i++) {
            double x = (from[i] - f->centre[a]) * f->inverse;
            float near;

            x = x < FILTER_FAR ? x : FILTER_FAR;
            near = (float)(x > -FILTER_FAR ? x : -FILTER_FAR);
            p->x[a][i] = near;
            p->s[i] += near * near;
            box->lo[a][k] = near < box->lo[a][k] ? near : box->lo[a][k];
            box->hi[a][k] = near > box->hi[a][k] ? near : box->hi[a][k];
        }
    }
    h = s->scale > 0 ? filter_eight(s->h, first, last, room) : NULL;
    for (size_t i = 0; i < LEAF; i++) {
        float reach = h ? (float)(s->scale * h[i] * f->inverse) : 0;

        p->r2[i] = reach * reach;
        p->s[i] = first + i < last ? p->s[i] : INFINITY;
        box->reach[k] = reach > box->reach[k] ? reach : box->reach[k];
    }
}

static void plain_pack(struct packed_leaf *p, struct packed_box8 *box, const struct sources *s,
                       const struct frame *f, const uint32_t *leaf, size_t n)
{
    for (size_t k = 0; k < LEAF; k++) {
        for (int a = 0; a < 3; a++) {
            box->lo[a][k] = INFINITY;
            box->hi[a][k] = -INFINITY;
        }
        box->reach[k] = 0;
        if (k < n) {
            plain_pack_one(&p[k], box, k, s, f, leaf[k]);
        }
    }
}

static void plain_lanes(struct lanes *t, const struct cloud *c, double scale, const struct frame *f,
                        size_t first, size_t last)
{
    float least = INFINITY;

    memset(t, 0, sizeof *t);
    for (size_t i = 0; i < LEAF; i++) {
        size_t k = first + i < last ? first + i : last - 1;
        float reach = (float)(scale * c->h[k] * f->inverse);
        double a2 = 0;

        for (int a = 0; a < c->dim; a++) {
            double x = (c->x[a][k] - f->centre[a]) * f->inverse;
            float near = (float)x;

            t->m2a[a][i] = -2 * near;
            a2 += x * x;
            t->lo[a] = i == 0 || near < t->lo[a] ? near : t->lo[a];
            t->hi[a] = i == 0 || near > t->hi[a] ? near : t->hi[a];
        }
        t->a2[i] = (float)a2;
        t->r2[i] = reach * reach;
        t->reach = reach > t->reach ? reach : t->reach;
        least = reach < least ? reach : least;
    }
    t->uniform = t->reach <= UNIFORM * least;
}

static size_t plain_near_leaves(const struct packed_box8 *boxes, size_t n, const struct lanes *t,
                                int dim, uint32_t *out)
{
    size_t found = 0;

    for (size_t q = 0; q < n; q += LEAF) {
        const struct packed_box8 *b = &boxes[q / LEAF];
        float gap[LEAF] = {0};

        for (int a = 0; a < dim; a++) {
            for (int k = 0; k < LEAF; k++) {
                float below = b->lo[a][k] - t->hi[a], above = t->lo[a] - b->hi[a][k];
                float d = below > above ? below : above;

                d = d > 0 ? d : 0;
                gap[k] += d * d;
            }
        }
        for (unsigned k = 0; k < LEAF; k++) {
            float reach = b->reach[k] > t->reach ? b->reach[k] : t->reach;

            reach *= 1 + (float)MARGIN;
            out[found] = (uint32_t)q + k;
            found += gap[k] <= reach * reach;
        }
    }
    return found;
}

/* The smallest over half of the lanes, from `first` on, of a^2 - 2 a.b, and of the same less the
 * lane's own reach^2. */
static inline void plain_nearest(const struct packed_leaf *p, const struct lanes *t, int dim,
                                 int first, float *any, float *own)
{
    for (int k = 0; k < LEAF; k++) {
        any[k] = own[k] = 3e38f;
    }
    for (int i = first; i < first + 4; i++) {
        for (int k = 0; k < LEAF; k++) {
            float d = t->a2[i];

            for (int a = 0; a < dim; a++) {
                d += t->m2a[a][i] * p->x[a][k];
            }
            any[k] = d < any[k] ? d : any[k];
            d -= t->r2[i];
            own[k] = d < own[k] ? d : own[k];
        }
    }
}

static void plain_near_points(const struct packed_leaf *pack, const uint32_t *leaf,
                              const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                              uint32_t own_leaf, struct found *out)
{
    for (size_t q = 0; q < n; q++) {
        const struct packed_leaf *p = &pack[chosen[q]];
        float any[2][LEAF], own[2][LEAF];

        plain_nearest(p, t, dim, 0, any[0], own[0]);
        plain_nearest(p, t, dim, 4, any[1], own[1]);
        for (unsigned k = 0; k < LEAF; k++) {
            bool sees[2];

            for (int half = 0; half < 2; half++) {
                sees[half] = own[half][k] <= -p->s[k] || any[half][k] <= p->r2[k] - p->s[k];
            }
            if (sees[0] || sees[1]) {
                bool one = sees[0] != sees[1] && leaf[chosen[q]] != own_leaf;
                int by = !one ? BY_BOTH : sees[0] ? BY_LOWER : BY_UPPER;

                out->source[by][out->n[by]++] = leaf[chosen[q]] * LEAF + k;
            }
        }
    }
}

static void plain_steps(uint16_t *out, const uint32_t *found, size_t n, uint32_t base)
{
    for (size_t k = 0; k < n; k++) {
        out[k] = (uint16_t)(found[k] - base);
    }
}

static void plain_turns(uint16_t *out, const uint32_t *lower, const uint32_t *upper, size_t n,
                        uint32_t base)
{
    for (size_t k = 0; k < n; k++) {
        out[2 * k] = (uint16_t)(lower[k] - base);
        out[2 * k + 1] = (uint16_t)(upper[k] - base);
    }
}

static const struct filter plain = {plain_eight,       plain_near_boxes,  plain_pack,  plain_lanes,
                                    plain_near_leaves, plain_near_points, plain_steps, plain_turns};

const struct filter *filter_plain(void)
{
    return &plain;
}

const struct filter *filter_best(void)
{
    const struct filter *wide = filter_avx512() ? filter_avx512() : filter_avx2();

    return wide ? wide : &plain;
}
