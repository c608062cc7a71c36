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

/* Bounds of points [first, first + n) of the order. */
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

static double longest_extent(const struct sorter *s, const double *lo, const double *hi)
{
    double longest = 0;

    for (int a = 0; a < s->c->dim; a++) {
        longest = fmax(longest, hi[a] - lo[a]);
    }
    return longest;
}

/* Sorts points [first, first + n), which crowd one cell. */
static int sort_crowd(struct sorter *s, size_t first, size_t n, int depth)
{
    double lo[3], hi[3];
    struct grid g;
    uint32_t *ends;
    size_t begin = 0;
    int status = 0;

    if (n <= CELL_MOST || depth > DEPTH_MOST) {
        sort_by_x(s, s->order + first, n);
        return 0;
    }
    bounds(s, first, n, lo, hi);
    if (!(longest_extent(s, lo, hi) > 0)) {
        sort_by_x(s, s->order + first, n);
        return 0;
    }
    grid_init(&g, lo, hi, s->c->dim, crowded_edge(lo, hi, s->c->dim, n), n);
    ends = malloc(g.n * sizeof *ends);
    if (!ends) {
        return -1;
    }
    count_sort(s, &g, first, n, ends);
    for (size_t k = 0; k < g.n && status == 0; k++) {
        status = sort_crowd(s, first + begin, ends[k] - begin, depth + 1);
        begin = ends[k];
    }
    free(ends);
    return status;
}

/* -- All points, on several threads ------------------------------------------------------------ */

static void share(size_t n, size_t threads, size_t t, size_t *first, size_t *end)
{
    size_t each = (n + threads - 1) / threads;

    *first = t * each < n ? t * each : n;
    *end = (t + 1) * each < n ? (t + 1) * each : n;
}

static void all_bounds(const struct sorter *s, double *lo, double *hi, size_t threads)
{
    for (int a = 0; a < s->c->dim; a++) {
        const double *x = s->c->x[a];
        double least = INFINITY, most = -INFINITY;

        (void)threads;
#pragma omp parallel for schedule(static) num_threads((int)threads) if (threads > 1)               \
    reduction(min                                                                                  \
              : least) reduction(max                                                               \
                                 : most)
        for (size_t i = 0; i < s->c->n; i++) {
            least = x[i] < least ? x[i] : least;
            most = x[i] > most ? x[i] : most;
        }
        lo[a] = least;
        hi[a] = most;
    }
}

/* Like count_sort, of all points as they stand: each thread counts and moves a share of them.
 * count: [threads][g->n], of which the last thread's are then the ends of the cells. */
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

    all_bounds(s, lo, hi, threads);
    if (!(edge > 0)) {
        edge = longest_extent(s, lo, hi) > 0 ? crowded_edge(lo, hi, s->c->dim, s->c->n) : 1;
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
        int failed = sort_crowd(s, begin, ends[k] - begin, 1);

        status = failed < status ? failed : status;
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
    status = sort_all(&s, cell, threads > 1 && n > 4096 ? (size_t)threads : 1, e);
    free(s.scratch);
    return status;
}
