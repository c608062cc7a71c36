/* neighbours/boxes.c -- builds the tree of boxes. Reads the cloud; owns the tree's memory. */
#include "neighbours/boxes.h"

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

int boxes_check(const struct cloud *c, const char *role, struct error *e)
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

/* -- Building ---------------------------------------------------------------------------------- */

static void empty_box(struct box8 *b, size_t k)
{
    for (int a = 0; a < 3; a++) {
        b->lo[a][k] = INFINITY;
        b->hi[a][k] = -INFINITY;
    }
    b->reach[k] = 0;
}

static void leaf_box(const struct boxes *b, size_t leaf, struct box8 *out, size_t k)
{
    size_t first = leaf * BOXES_FAN, last = first + BOXES_FAN < b->n ? first + BOXES_FAN : b->n;

    empty_box(out, k);
    for (int a = 0; a < 3; a++) {
        double lo = INFINITY, hi = -INFINITY;

        for (size_t i = first; i < last && a < b->dim; i++) {
            double x = b->x[a][i];

            lo = x < lo ? x : lo;
            hi = x > hi ? x : hi;
        }
        out->lo[a][k] = a < b->dim ? lo : 0;
        out->hi[a][k] = a < b->dim ? hi : 0;
    }
    for (size_t i = first; i < last && b->scale > 0; i++) {
        double reach = b->scale * b->h[i];

        out->reach[k] = reach > out->reach[k] ? reach : out->reach[k];
    }
}

/* The box around eight sisters. */
static void parent_box(const struct box8 *child, struct box8 *out, size_t k)
{
    empty_box(out, k);
    for (size_t i = 0; i < BOXES_FAN; i++) {
        for (int a = 0; a < 3; a++) {
            double lo = child->lo[a][i], hi = child->hi[a][i];

            out->lo[a][k] = lo < out->lo[a][k] ? lo : out->lo[a][k];
            out->hi[a][k] = hi > out->hi[a][k] ? hi : out->hi[a][k];
        }
        out->reach[k] = child->reach[i] > out->reach[k] ? child->reach[i] : out->reach[k];
    }
}

static int boxes_alloc(struct boxes *b, struct error *e)
{
    size_t n = b->n_leaf;

    for (b->n_level = 0; b->n_level < BOXES_LEVELS; b->n_level++) {
        size_t blocks = (n + BOXES_FAN - 1) / BOXES_FAN, bytes = blocks * sizeof(struct box8);
        struct box8 *level = aligned_alloc(64, bytes);

        if (!level) {
            return error_memory(e, "the neighbour search's boxes", bytes);
        }
        b->level[b->n_level] = level;
        b->n_node[b->n_level] = n;
        n = blocks;
        if (blocks == 1) {
            b->n_level++;
            return 0;
        }
    }
    return error_set(e, EXIT_RUN, "too many particles for the neighbour search");
}

static void boxes_fill(struct boxes *b, int threads)
{
    for (int l = 0; l < b->n_level; l++) {
        size_t n = b->n_node[l], blocks = (n + BOXES_FAN - 1) / BOXES_FAN;

        (void)threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (blocks > 512)
        for (size_t q = 0; q < blocks; q++) {
            for (size_t k = 0; k < BOXES_FAN; k++) {
                size_t node = q * BOXES_FAN + k;

                if (node >= n) {
                    empty_box(&b->level[l][q], k);
                } else if (l == 0) {
                    leaf_box(b, node, &b->level[0][q], k);
                } else {
                    parent_box(&b->level[l - 1][node], &b->level[l][q], k);
                }
            }
        }
    }
}

/* Whether the points stand in an order that is worth nothing: many leaves much larger than a reach.
 * Too few points are not worth an order either. */
static bool scattered(const struct boxes *b, double typical)
{
    size_t bad = 0;

    if (b->n_leaf <= 64) {
        return false;
    }
    for (size_t leaf = 0; leaf < b->n_leaf; leaf++) {
        const struct box8 *box = &b->level[0][leaf / BOXES_FAN];
        size_t k = leaf % BOXES_FAN;
        double limit = 4 * (box->reach[k] > typical ? box->reach[k] : typical);

        for (int a = 0; a < b->dim; a++) {
            if (box->hi[a][k] - box->lo[a][k] > limit) {
                bad++;
                break;
            }
        }
    }
    return bad > b->n_leaf / 4;
}

/* Gives the tree an order of its own and copies of the points in it. */
static int boxes_reorder(struct boxes *b, const struct cloud *c, double typical, struct error *e)
{
    size_t columns = (size_t)b->dim + (b->scale > 0), bytes = columns * b->n * sizeof(double);
    struct cloud points = *c;
    double *copy;

    b->own_order = malloc(b->n * sizeof *b->own_order);
    b->copy = malloc(bytes);
    if (!b->own_order || !b->copy) {
        return error_memory(e, "the neighbour search's order", bytes);
    }
    if (cell_order(&points, NULL, typical, b->own_order, e) != 0) {
        return -1;
    }
    b->order = b->own_order;
    copy = b->copy;
    for (size_t k = 0; k < columns; k++) {
        const double *from = k < (size_t)b->dim ? c->x[k] : c->h;

        for (size_t i = 0; i < b->n; i++) {
            copy[i] = from[b->order[i]];
        }
        *(k < (size_t)b->dim ? &b->x[k] : &b->h) = copy;
        copy += b->n;
    }
    return 0;
}

int boxes_make(struct boxes *b, const struct cloud *cloud, double scale, double typical,
               int threads, struct error *e)
{
    memset(b, 0, sizeof *b);
    b->dim = cloud->dim;
    b->n = cloud->n;
    b->n_leaf = (b->n + BOXES_FAN - 1) / BOXES_FAN;
    b->scale = scale;
    b->h = cloud->h;
    for (int a = 0; a < b->dim; a++) {
        b->x[a] = cloud->x[a];
    }
    if (b->n == 0) {
        return 0;
    }
    if (boxes_alloc(b, e) != 0) {
        boxes_free(b);
        return -1;
    }
    boxes_fill(b, threads);
    if (typical > 0 && scattered(b, typical)) {
        if (boxes_reorder(b, cloud, typical, e) != 0) {
            boxes_free(b);
            return -1;
        }
        boxes_fill(b, threads);
    }
    return 0;
}

void boxes_free(struct boxes *b)
{
    for (int l = 0; l < BOXES_LEVELS; l++) {
        free(b->level[l]);
    }
    free(b->copy);
    free(b->own_order);
    memset(b, 0, sizeof *b);
}
