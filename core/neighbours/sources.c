/* neighbours/sources.c -- checks clouds, and puts those out of all order into one of their own.
 * Reads the clouds; owns the copies. */
#include "neighbours/sources.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- Checks ------------------------------------------------------------------------------------ */

#define FAR 1e150 /* squares of distances must be numbers too */

/* A sum that is not finite if any of the values is too large or none: fast, and seldom bad. */
static bool all_near(const double *x, size_t n)
{
    double part[8] = {0}, sum = 0;
    size_t i = 0;

    for (; i + 8 <= n; i += 8) {
        for (size_t k = 0; k < 8; k++) {
            part[k] += x[i + k] * (1e308 / FAR);
        }
    }
    for (; i < n; i++) {
        sum += x[i] * (1e308 / FAR);
    }
    for (size_t k = 0; k < 8; k++) {
        sum += part[k];
    }
    return isfinite(sum);
}

static bool none_negative(const double *x, size_t n)
{
    int bad = 0;

    for (size_t i = 0; i < n; i++) {
        bad |= x[i] < 0;
    }
    return !bad;
}

int cloud_check(const struct cloud *c, const char *role, struct error *e)
{
    bool good = !c->h || (all_near(c->h, c->n) && none_negative(c->h, c->n));

    if (c->n > UINT32_MAX) {
        return error_set(e, EXIT_RUN, "%zu %s particles: at most %u are possible", c->n, role,
                         UINT32_MAX);
    }
    for (int a = 0; a < c->dim; a++) {
        good = good && all_near(c->x[a], c->n);
    }
    for (size_t i = 0; i < c->n && !good; i++) {
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

/* -- Sources ----------------------------------------------------------------------------------- */

static double largest_h(const struct cloud *c)
{
    double h = 0;

    for (size_t i = 0; i < c->n; i++) {
        h = c->h[i] > h ? c->h[i] : h;
    }
    return h;
}

static double mean_h(const struct cloud *c)
{
    double sum = 0;

    for (size_t i = 0; i < c->n; i++) {
        sum += c->h[i];
    }
    return c->n > 0 ? sum / (double)c->n : 0;
}

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

/* Whether the points stand in an order that is worth nothing, by one leaf in seven. Too few points
 * are not worth an order either. */
static bool scattered(const struct sources *s)
{
    size_t bad = 0, tried = 0;

    for (size_t leaf = 0; leaf < s->n_leaf && s->n_leaf > 64; leaf += 7) {
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
    double asked = factor * dst->scale * largest_h(dst);

    memset(s, 0, sizeof *s);
    s->dim = src->dim;
    s->n = src->n;
    s->n_leaf = (s->n + LEAF - 1) / LEAF;
    s->scale = symmetric ? factor * src->scale : 0;
    s->largest = symmetric ? s->scale * largest_h(src) : 0;
    s->typical = factor * dst->scale * mean_h(dst);
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

void sources_bounds(const struct sources *s, double *lo, double *hi)
{
    for (int a = 0; a < s->dim; a++) {
        lo[a] = INFINITY;
        hi[a] = -INFINITY;
        for (size_t i = 0; i < s->n; i++) {
            double x = s->x[a][i];

            lo[a] = x < lo[a] ? x : lo[a];
            hi[a] = x > hi[a] ? x : hi[a];
        }
    }
}
