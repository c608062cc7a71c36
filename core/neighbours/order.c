/* neighbours/order.c -- puts points into linear cell order. Writes only the order.
 *
 * A counting sort into cells. Where the box is so empty that there would be more cells than
 * points, larger cells are taken first; a cell that holds many points is sorted into smaller
 * cells of its own, within the points' own bounds. So an outlier costs a level of recursion and
 * no memory, and the dense places of a cloud with variable smoothing length are as well ordered
 * as the thin ones. */
#include "neighbours/neighbours.h"

#include "neighbours/grid.h"
#include "neighbours/sources.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELL_MOST 32 /* points of a cell that are sorted by x alone */
#define CELL_AIM 16  /* points of a cell into which a full one is sorted */
#define DEPTH_MOST 64

struct sorter {
    const struct cloud *c;
    const int64_t *id;
    uint32_t *order, *scratch, *cell; /* [n] each: the order, its next state, the points' cells */
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

static void sift(const struct sorter *s, uint32_t *heap, size_t k, size_t n)
{
    uint32_t i = heap[k];

    for (size_t child = 2 * k + 1; child < n; child = 2 * k + 1) {
        if (child + 1 < n && before(s, heap[child], heap[child + 1])) {
            child++;
        }
        if (!before(s, i, heap[child])) {
            break;
        }
        heap[k] = heap[child];
        k = child;
    }
    heap[k] = i;
}

static void sort_by_x(const struct sorter *s, uint32_t *order, size_t n)
{
    if (n <= CELL_MOST) {
        insertion_sort(s, order, n);
        return;
    }
    for (size_t k = n / 2; k-- > 0;) {
        sift(s, order, k, n);
    }
    for (size_t last = n - 1; last > 0; last--) {
        uint32_t i = order[last];

        order[last] = order[0];
        order[0] = i;
        sift(s, order, 0, last);
    }
}

/* -- Cells ------------------------------------------------------------------------------------- */

/* The edge with about CELL_AIM points a cell, were they even; at most half the longest extent, so
 * that every level gets on. */
static double crowded_edge(const double *lo, const double *hi, int dim, size_t n)
{
    double longest = 0, volume = CELL_AIM / (double)n;
    int axes = 0;

    for (int a = 0; a < dim; a++) {
        longest = fmax(longest, hi[a] - lo[a]);
    }
    for (int a = 0; a < dim; a++) {
        double extent = hi[a] - lo[a];

        if (extent > 1e-3 * longest) {
            volume *= extent / longest;
            axes++;
        }
    }
    return fmin(longest * pow(volume, 1.0 / axes), longest / 2);
}

/* Sorts points [first, first + n) of the order into the grid's cells; ends[k] is then where cell k
 * ends. Stable. */
static void count_sort(struct sorter *s, const struct grid *g, size_t first, size_t n,
                       uint32_t *ends)
{
    uint32_t *order = s->order + first, *scratch = s->scratch + first, *cell = s->cell + first;
    uint32_t sum = 0;

    memset(ends, 0, g->n * sizeof *ends);
    for (size_t k = 0; k < n; k++) {
        cell[k] = (uint32_t)grid_cell(g, s->c->x, order[k]);
        ends[cell[k]]++;
    }
    for (size_t k = 0; k < g->n; k++) {
        uint32_t count = ends[k];

        ends[k] = sum;
        sum += count;
    }
    for (size_t k = 0; k < n; k++) {
        scratch[ends[cell[k]]++] = order[k];
    }
    memcpy(order, scratch, n * sizeof *order);
}

static void bounds(const struct sorter *s, size_t first, size_t n, double *lo, double *hi)
{
    for (int a = 0; a < s->c->dim; a++) {
        lo[a] = INFINITY;
        hi[a] = -INFINITY;
        for (size_t k = first; k < first + n; k++) {
            double x = s->c->x[a][s->order[k]];

            lo[a] = x < lo[a] ? x : lo[a];
            hi[a] = x > hi[a] ? x : hi[a];
        }
    }
}

/* Sorts points [first, first + n); `edge` is that of the cells wanted at the top, 0 below it. */
static int sort_cells(struct sorter *s, size_t first, size_t n, double edge, int depth,
                      struct error *e)
{
    double lo[3], hi[3], longest = 0;
    struct grid g;
    uint32_t *ends;
    size_t begin = 0;
    int status = 0;

    bounds(s, first, n, lo, hi);
    for (int a = 0; a < s->c->dim; a++) {
        longest = fmax(longest, hi[a] - lo[a]);
    }
    if (!(longest > 0) || depth > DEPTH_MOST || (depth > 0 && n <= CELL_MOST)) {
        sort_by_x(s, s->order + first, n);
        return 0;
    }
    if (!(edge > 0) || (depth > 0 && edge > longest / 2)) {
        edge = crowded_edge(lo, hi, s->c->dim, n);
    }
    grid_init(&g, lo, hi, s->c->dim, edge, n);
    ends = malloc(g.n * sizeof *ends);
    if (!ends) {
        return error_memory(e, "sorting particles into cells", g.n * sizeof *ends);
    }
    count_sort(s, &g, first, n, ends);
    for (size_t k = 0; k < g.n && status == 0; k++) {
        size_t m = ends[k] - begin;

        if (m > CELL_MOST) {
            status = sort_cells(s, first + begin, m, edge, depth + 1, e);
        } else if (m > 1) {
            sort_by_x(s, s->order + first + begin, m);
        }
        begin = ends[k];
    }
    free(ends);
    return status;
}

int cell_order(const struct cloud *points, const int64_t *id, double cell, uint32_t *order,
               struct error *e)
{
    struct sorter s = {.c = points, .id = id, .order = order};
    size_t n = points->n;
    int status;

    if (cloud_check(points, "source", e) != 0) {
        return -1;
    }
    if (n == 0) {
        return 0;
    }
    s.scratch = malloc(2 * n * sizeof *s.scratch);
    if (!s.scratch) {
        return error_memory(e, "sorting particles", 2 * n * sizeof *s.scratch);
    }
    s.cell = s.scratch + n;
    for (size_t i = 0; i < n; i++) {
        order[i] = (uint32_t)i;
    }
    status = sort_cells(&s, 0, n, cell, 0, e);
    free(s.scratch);
    return status;
}
