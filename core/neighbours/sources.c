/* neighbours/sources.c -- checks clouds, and puts those out of all order into one of their own.
 * Reads the clouds; owns the copies. */
#include "neighbours/sources.h"

#include "neighbours/range.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- Checks ------------------------------------------------------------------------------------ */

#define FAR 1e150 /* squares of distances must be numbers too */

#define SLICES 64 /* that threads share; sums are the same for any number of threads */
#define LANES 8

/* What there is to know of h; `good` if all numbers of the points are numbers that can be. */
struct survey {
    double sum, most;
    bool good;
};

/* A sum that is not finite if any of the values is too large or none: fast, and seldom bad. */
static double far_sum(const double *x, size_t n)
{
    double part[LANES] = {0}, sum = 0;
    size_t i = 0;

    for (; i + LANES <= n; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            part[k] += x[i + k] * (1e308 / FAR);
        }
    }
    for (; i < n; i++) {
        sum += x[i] * (1e308 / FAR);
    }
    for (size_t k = 0; k < LANES; k++) {
        sum += part[k];
    }
    return sum;
}

static struct survey survey_slice(const struct cloud *c, size_t first, size_t n)
{
    struct survey s = {.good = true};

    for (int a = 0; a < c->dim; a++) {
        s.good = s.good && isfinite(far_sum(c->x[a] + first, n));
    }
    if (c->h) {
        double sum = far_sum(c->h + first, n);
        struct range h = range_of(c->h + first, n, 1);

        s.good = s.good && isfinite(sum) && !(h.least < 0);
        s.most = h.most > 0 ? h.most : 0;
        s.sum = sum / (1e308 / FAR);
    }
    return s;
}

/* Points [first, n). */
static struct survey survey(const struct cloud *c, size_t first, int threads)
{
    size_t n = c->n - first, each = n / SLICES + 1;
    struct survey slice[SLICES], all = {.good = true};

    (void)threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && n > 4096)
    for (size_t k = 0; k < SLICES; k++) {
        size_t begin = k * each < n ? k * each : n;

        slice[k] = survey_slice(c, first + begin, n - begin < each ? n - begin : each);
    }
    for (size_t k = 0; k < SLICES; k++) {
        all.sum += slice[k].sum;
        all.most = slice[k].most > all.most ? slice[k].most : all.most;
        all.good = all.good && slice[k].good;
    }
    return all;
}

/* Finds the point that spoils a cloud that is not good; 0 if there is none after all. */
static int find_bad(const struct cloud *c, const char *role, struct error *e)
{
    for (size_t i = 0; i < c->n; i++) {
        for (int a = 0; a < c->dim; a++) {
            if (!(fabs(c->x[a][i]) < FAR)) {
                return error_set(e, EXIT_RUN, "%s particle %zu is nowhere: its %c is %g", role, i,
                                 "xyz"[a], c -> x[a][i]);
            }
        }
        if (c->h && !(c->h[i] >= 0 && c->h[i] < FAR)) {
            return error_set(e, EXIT_RUN, "%s particle %zu has a smoothing length of %g", role, i,
                             c->h[i]);
        }
    }
    return 0;
}

static int check(const struct cloud *c, size_t first, const char *role, int threads,
                 struct survey *s, struct error *e)
{
    if (c->n > UINT32_MAX) {
        return error_set(e, EXIT_RUN, "%zu %s particles: at most %u are possible", c->n, role,
                         UINT32_MAX);
    }
    *s = survey(c, first, threads);
    return s->good ? 0 : find_bad(c, role, e);
}

int cloud_check(const struct cloud *c, const char *role, int threads, struct error *e)
{
    struct survey s;

    return check(c, 0, role, threads, &s, e);
}

/* -- Sources ----------------------------------------------------------------------------------- */

/* Whether a leaf is much larger than a reach. */
static bool leaf_scattered(const struct sources *s, size_t leaf)
{
    double limit = s->typical;
    size_t first = leaf * LEAF, last = first + LEAF < s->n ? first + LEAF : s->n;

    for (size_t i = first; i < last && s->scale > 0; i++) {
        limit = s->scale * s->h[i] > limit ? s->scale * s->h[i] : limit;
    }
    for (int a = 0; a < s->dim; a++) {
        double lo = INFINITY, hi = -INFINITY;

        for (size_t i = first; i < last; i++) {
            lo = s->x[a][i] < lo ? s->x[a][i] : lo;
            hi = s->x[a][i] > hi ? s->x[a][i] : hi;
        }
        if (hi - lo > 4 * limit) {
            return true;
        }
    }
    return false;
}

/* Whether the points stand in an order that is worth nothing, by one leaf in seven, and fewer where
 * there are many. Too few points are not worth an order either. */
static bool scattered(const struct sources *s)
{
    size_t bad = 0, tried = 0, stride = 7 + s->n_leaf / 4096;

    for (size_t leaf = 0; leaf < s->n_leaf && s->n_leaf > 64; leaf += stride) {
        bad += leaf_scattered(s, leaf);
        tried++;
    }
    return bad > tried / 4;
}

/* Gives the search an order of its own and copies of the points in it. */
static int reorder(struct sources *s, const struct cloud *c, int threads, struct error *e)
{
    size_t columns = (size_t)s->dim + (s->scale > 0), bytes = columns * s->n * sizeof(double);
    double *copy;

    s->own_order = malloc(s->n * sizeof *s->own_order);
    s->copy = malloc(bytes);
    if (!s->own_order || !s->copy) {
        return error_memory(e, "the neighbour search's order", bytes);
    }
    if (cell_order(c, NULL, s->typical, threads, s->own_order, e) != 0) {
        return -1;
    }
    s->order = s->own_order;
    s->bytes = bytes + s->n * sizeof *s->own_order;
    copy = s->copy;
    for (size_t k = 0; k < columns; k++) {
        const double *from = k < (size_t)s->dim ? c->x[k] : c->h;

        for (size_t i = 0; i < s->n; i++) {
            copy[i] = from[s->order[i]];
        }
        *(k < (size_t)s->dim ? &s->x[k] : &s->h) = copy;
        copy += s->n;
    }
    return 0;
}

int sources_make(struct sources *s, const struct cloud *dst, const struct cloud *src,
                 bool symmetric, double factor, int threads, struct error *e)
{
    struct survey to, from;
    double asked;
    /* The sources may be the destinations, with ghosts behind them. */
    bool same = dst->n <= src->n && dst->h == src->h;

    memset(s, 0, sizeof *s);
    for (int a = 0; a < src->dim; a++) {
        same = same && dst->x[a] == src->x[a];
    }
    if (check(dst, 0, "destination", threads, &to, e) != 0 ||
        check(src, same ? dst->n : 0, "source", threads, &from, e) != 0) {
        return -1;
    }
    from.most = same && to.most > from.most ? to.most : from.most;
    asked = factor * dst->scale * to.most;
    s->dim = src->dim;
    s->n = src->n;
    s->n_leaf = (s->n + LEAF - 1) / LEAF;
    s->scale = symmetric ? factor * src->scale : 0;
    s->largest = symmetric ? s->scale * from.most : 0;
    s->typical = dst->n > 0 ? factor * dst->scale * to.sum / (double)dst->n : 0;
    s->query = asked > s->largest ? asked : s->largest;
    s->h = src->h;
    for (int a = 0; a < s->dim; a++) {
        s->x[a] = src->x[a];
    }
    if (s->typical > 0 && scattered(s) && reorder(s, src, threads, e) != 0) {
        sources_free(s);
        return -1;
    }
    return 0;
}

void sources_free(struct sources *s)
{
    free(s->copy);
    free(s->own_order);
    memset(s, 0, sizeof *s);
}

void sources_bounds(const struct sources *s, int threads, double *lo, double *hi)
{
    for (int a = 0; a < s->dim; a++) {
        struct range r = range_of(s->x[a], s->n, threads);

        lo[a] = r.least;
        hi[a] = r.most;
    }
}
