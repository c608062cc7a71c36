/* neighbours/order.c -- puts points into linear cell order. Writes only the order.
 *
 * A counting sort into cells. Where the box is so empty that there would be more cells than
 * points, larger cells are taken. A cell that holds many points is halved across its longest
 * extent, and again, until there are eight in a part: close together in space, as the groups of
 * neighbour lists should be. So an outlier costs time and no memory, and the dense places of a
 * cloud with variable smoothing length are as well ordered as the thin ones. */
#include "neighbours/neighbours.h"

#include "neighbours/grid.h"
#include "neighbours/range.h"
#include "neighbours/sources.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELL_MOST 32 /* points of a cell that are sorted by x alone */
#define GROUP SPH_LANES

struct sorter {
    const struct cloud *c;
    const int64_t *id;
    uint32_t *order, *cell; /* [n] each: the order, the points' cells */
};

/* -- Within a cell ----------------------------------------------------------------------------- */

/* By x, then by id, then by index. */
static bool before(const struct sorter *s, uint32_t i, uint32_t j)
{
    const double *x = s->c->x[0];

    if (x[i] < x[j] || x[i] > x[j]) {
        return x[i] < x[j];
    }
    if (s->id && s->id[i] != s->id[j]) {
        return s->id[i] < s->id[j];
    }
    return i < j;
}

static void insertion_sort(const struct sorter *s, uint32_t *order, size_t n)
{
    for (size_t k = 1; k < n; k++) {
        uint32_t i = order[k];
        size_t q = k;

        for (; q > 0 && before(s, i, order[q - 1]); q--) {
            order[q] = order[q - 1];
        }
        order[q] = i;
    }
}

/* -- A crowded cell ---------------------------------------------------------------------------- */

/* A point of the crowd, by itself in memory. */
struct member {
    double x[3];
    uint32_t i;
};

struct crowd {
    const struct sorter *s;
    struct member *member;
    size_t first;   /* of the order: where the crowd stands */
    bool turned[3]; /* axes along which it is walked from high to low */
    uint64_t seed;
};

static inline bool member_before(const struct crowd *c, const struct member *a,
                                 const struct member *b, int axis)
{
    double p = a->x[axis], q = b->x[axis];
    bool below = p < q, above = q < p;

    if (below | above) {
        return below != c->turned[axis];
    }
    if (c->s->id && c->s->id[a->i] != c->s->id[b->i]) {
        return c->s->id[a->i] < c->s->id[b->i];
    }
    return a->i < b->i;
}

static void swap(struct member *a, struct member *b)
{
    struct member t = *a;

    *a = *b;
    *b = t;
}

/* One of [first, last), in the middle of three that were drawn. What is drawn changes the time, not
 * the result. */
static size_t draw_pivot(struct crowd *c, size_t first, size_t last, int axis)
{
    size_t p[3];

    for (int k = 0; k < 3; k++) {
        c->seed = c->seed * 6364136223846793005ull + 1442695040888963407ull;
        p[k] = first + (size_t)((c->seed >> 33) % (last - first));
    }
    for (int k = 0; k < 3; k++) {
        size_t a = p[(k + 1) % 3], b = p[(k + 2) % 3];
        bool above = member_before(c, &c->member[a], &c->member[p[k]], axis);
        bool below = member_before(c, &c->member[p[k]], &c->member[b], axis);

        if (above && below) {
            return p[k];
        }
    }
    return p[0];
}

/* Puts the first `want` along an axis, of [first, last), before the others (Hoare's FIND). */
static void part(struct crowd *c, size_t first, size_t last, size_t want, int axis)
{
    struct member *m = c->member;

    want += first;
    while (last - first > 1) {
        size_t low = first, pivot = draw_pivot(c, first, last, axis);

        swap(&m[pivot], &m[last - 1]);
        for (size_t k = first; k + 1 < last; k++) {
            struct member here = m[k];

            /* Changes places in any case: which are before the pivot no processor foresees. */
            m[k] = m[low];
            m[low] = here;
            low += member_before(c, &here, &m[last - 1], axis);
        }
        swap(&m[low], &m[last - 1]);
        if (want == low || want == low + 1) {
            return;
        }
        if (want < low) {
            last = low;
        } else {
            first = low + 1;
        }
    }
}

static int longest_axis(const struct crowd *c, size_t first, size_t last)
{
    double extent = -1;
    int axis = 0;

    for (int a = 0; a < c->s->c->dim; a++) {
        double lo = INFINITY, hi = -INFINITY;

        for (size_t k = first; k < last; k++) {
            double x = c->member[k].x[a];

            lo = x < lo ? x : lo;
            hi = x > hi ? x : hi;
        }
        if (hi - lo > extent) {
            extent = hi - lo;
            axis = a;
        }
    }
    return axis;
}

/* Halves members [first, last) across their longest extent until they are in groups, which begin at
 * multiples of eight of the whole order. */
static void halve(struct crowd *c, size_t first, size_t last)
{
    size_t begin = (c->first + first) / GROUP, end = (c->first + last + GROUP - 1) / GROUP, middle;

    if (end - begin < 2) {
        /* By x, as in any cell. */
        for (size_t k = first + 1; k < last; k++) {
            for (size_t q = k; q > first && member_before(c, &c->member[q], &c->member[q - 1], 0);
                 q--) {
                swap(&c->member[q], &c->member[q - 1]);
            }
        }
        return;
    }
    middle = (begin + (end - begin + 1) / 2) * GROUP - c->first;
    part(c, first, last, middle - first, longest_axis(c, first, last));
    halve(c, first, middle);
    halve(c, middle, last);
}

/* Sorts points [first, first + n), which crowd one cell, into groups. Cells are walked upwards
 * along x, and along the others in turns, so that the group at the border of two cells is close
 * together too. */
static int sort_crowd(struct sorter *s, size_t first, size_t n, bool turn)
{
    struct crowd c = {.s = s, .first = first, .turned = {false, turn, turn}, .seed = first};

    c.member = malloc(n * sizeof *c.member);
    if (!c.member) {
        return -1;
    }
    for (size_t k = 0; k < n; k++) {
        uint32_t i = s->order[first + k];

        c.member[k].i = i;
        for (int a = 0; a < s->c->dim; a++) {
            c.member[k].x[a] = s->c->x[a][i];
        }
    }
    halve(&c, 0, n);
    for (size_t k = 0; k < n; k++) {
        s->order[first + k] = c.member[k].i;
    }
    free(c.member);
    return 0;
}

/* -- All points, on several threads ------------------------------------------------------------ */

static void share(size_t n, size_t threads, size_t t, size_t *first, size_t *end)
{
    size_t each = (n + threads - 1) / threads;

    *first = t * each < n ? t * each : n;
    *end = (t + 1) * each < n ? (t + 1) * each : n;
}

/* Sorts all points into the cells, in the order in which they stand: each thread counts and moves
 * a share of them. count: [threads][g->n], of which the last thread's are then the ends of the
 * cells. */
static void share_sort(struct sorter *s, const struct grid *g, size_t threads, uint32_t *count)
{
    size_t n = s->c->n;
    uint32_t sum = 0;

#pragma omp parallel for schedule(static, 1) num_threads((int)threads) if (threads > 1)
    for (size_t t = 0; t < threads; t++) {
        uint32_t *mine = count + t * g->n;
        size_t first, end;

        share(n, threads, t, &first, &end);
        memset(mine, 0, g->n * sizeof *mine);
        for (size_t i = first; i < end; i++) {
            s->cell[i] = (uint32_t)grid_cell(g, s->c->x, i);
            mine[s->cell[i]]++;
        }
    }
    for (size_t k = 0; k < g->n; k++) {
        for (size_t t = 0; t < threads; t++) {
            uint32_t here = count[t * g->n + k];

            count[t * g->n + k] = sum;
            sum += here;
        }
    }
#pragma omp parallel for schedule(static, 1) num_threads((int)threads) if (threads > 1)
    for (size_t t = 0; t < threads; t++) {
        uint32_t *mine = count + t * g->n;
        size_t first, end;

        share(n, threads, t, &first, &end);
        for (size_t i = first; i < end; i++) {
            s->order[mine[s->cell[i]]++] = (uint32_t)i;
        }
    }
}

/* Sorts all points into cells of this edge, or of one that suits them if it is none. */
static int sort_all(struct sorter *s, double edge, size_t threads, struct error *e)
{
    double lo[3], hi[3];
    struct grid g;
    uint32_t *count, *ends;
    int status = 0;

    for (int a = 0; a < s->c->dim; a++) {
        struct range r = range_of(s->c->x[a], s->c->n, (int)threads);

        lo[a] = r.least;
        hi[a] = r.most;
    }
    if (!(edge > 0)) {
        edge = 0; /* as many cells as can be */
    }
    grid_init(&g, lo, hi, s->c->dim, edge, s->c->n);
    while (threads > 1 && threads * g.n > 4 * s->c->n) {
        threads--; /* counting must not cost more than the points */
    }
    count = malloc(threads * g.n * sizeof *count);
    if (!count) {
        return error_memory(e, "sorting particles into cells", threads * g.n * sizeof *count);
    }
    share_sort(s, &g, threads, count);
    ends = count + (threads - 1) * g.n;
#pragma omp parallel for schedule(dynamic, 64) num_threads((int)threads) if (threads > 1)          \
    reduction(min                                                                                  \
              : status)
    for (size_t k = 0; k < g.n; k++) {
        size_t begin = k ? ends[k - 1] : 0;
        if (ends[k] - begin <= CELL_MOST) {
            insertion_sort(s, s->order + begin, ends[k] - begin);
        } else if (sort_crowd(s, begin, ends[k] - begin, k % ((size_t)g.last[0] + 1) % 2) != 0) {
            status = -1;
        }
    }
    free(count);
    return status == 0 ? 0 : error_memory(e, "sorting particles into cells", g.n * sizeof *count);
}

int cell_order(const struct cloud *points, const int64_t *id, double cell, int threads,
               uint32_t *order, struct error *e)
{
    struct sorter s = {.c = points, .id = id, .order = order};
    size_t n = points->n;
    int status;

    if (cloud_check(points, "source", threads, e) != 0) {
        return -1;
    }
    if (n == 0) {
        return 0;
    }
    s.cell = malloc(n * sizeof *s.cell);
    if (!s.cell) {
        return error_memory(e, "sorting particles", n * sizeof *s.cell);
    }
    status = sort_all(&s, cell, threads > 1 && n > 4096 ? (size_t)threads : 1, e);
    free(s.cell);
    return status;
}
