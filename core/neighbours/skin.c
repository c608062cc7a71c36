/* neighbours/skin.c -- keeps positions and h in few bits, and tells what has changed since. Reads
 * clouds; owns what it keeps. */
#include "neighbours/skin.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 32
#define EXACT_NO UINT32_MAX
#define CODE_MOST 65535
#define ERROR_MOST 5e-4  /* of a block's smallest reach: what may be lost by rounding */
#define RATIO_LEAST 1e-6 /* h that are a smaller part of the block's largest would lose digits */

struct skin_block {
    double low[3], step[3];
    double h;       /* largest */
    double lost;    /* a position's error, at most */
    uint32_t exact; /* its place in `exact`, or EXACT_NO */
};

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* -- Codes of h -------------------------------------------------------------------------------- */

/* The upper 16 bits in use of a single precision number from 2^-32 to 1. */
static inline double ratio_of(uint32_t code)
{
    uint32_t bits = (code + (0x3f800u - CODE_MOST)) << 12;
    float ratio;

    memcpy(&ratio, &bits, sizeof ratio);
    return (double)ratio;
}

static uint16_t code_of(double ratio)
{
    float near = (float)ratio;
    uint32_t bits, code;

    memcpy(&bits, &near, sizeof bits);
    bits >>= 12;
    code = bits > 0x3f800u - CODE_MOST ? bits - (0x3f800u - CODE_MOST) : 0;
    code = code < CODE_MOST ? code : CODE_MOST;
    return (uint16_t)(code > 0 && ratio_of(code) > ratio ? code - 1 : code);
}

/* -- Keeping ----------------------------------------------------------------------------------- */

static void block_measure(struct skin_block *b, const struct cloud *c, size_t first, size_t last)
{
    double least = INFINITY, sum = 0;

    memset(b, 0, sizeof *b);
    b->exact = EXACT_NO;
    for (int a = 0; a < c->dim; a++) {
        double lo = INFINITY, hi = -INFINITY, lost;

        for (size_t i = first; i < last; i++) {
            lo = c->x[a][i] < lo ? c->x[a][i] : lo;
            hi = c->x[a][i] > hi ? c->x[a][i] : hi;
            sum += c->x[a][i] * 0; /* NAN if a number is none */
        }
        b->low[a] = lo;
        b->step[a] = (hi - lo) / CODE_MOST;
        /* Half a step, and the rounding of the sums. */
        lost = b->step[a] / 2 * (1 + 1e-6) + 8 * DBL_EPSILON * (fabs(lo) + fabs(hi));
        b->lost += lost * lost;
    }
    b->lost = sqrt(b->lost);
    for (size_t i = first; i < last; i++) {
        least = c->h[i] < least ? c->h[i] : least;
        b->h = c->h[i] > b->h ? c->h[i] : b->h;
        sum += c->h[i] * 0;
    }
    if (!(b->lost + sum <= ERROR_MOST * c->scale * least) || !(least >= RATIO_LEAST * b->h)) {
        b->exact = 0;
        b->lost = 0;
    }
}

static void block_encode(const struct skin_block *b, const struct cloud *c, size_t first,
                         size_t last, uint16_t *code)
{
    for (size_t k = 0; k < BLOCK; k++) {
        size_t i = smaller(first + k, last - 1);

        for (int a = 0; a < c->dim; a++) {
            double q = b->step[a] > 0 ? (c->x[a][i] - b->low[a]) / b->step[a] + 0.5 : 0;

            code[(size_t)a * BLOCK + k] = (uint16_t)(q < CODE_MOST ? q : CODE_MOST);
        }
        code[(size_t)c->dim * BLOCK + k] = code_of(b->h > 0 ? c->h[i] / b->h : 0);
    }
}

static void block_copy(const struct cloud *c, size_t first, size_t last, double *exact)
{
    for (int a = 0; a <= c->dim; a++) {
        const double *x = a < c->dim ? c->x[a] : c->h;

        for (size_t k = 0; k < BLOCK; k++) {
            exact[(size_t)a * BLOCK + k] = x[smaller(first + k, last - 1)];
        }
    }
}

static int reserve_blocks(struct skin *s, struct error *e)
{
    size_t codes = (size_t)(s->dim + 1) * BLOCK;

    if (s->n_block <= s->block_capacity) {
        return 0;
    }
    free(s->block);
    free(s->code);
    s->block = malloc(s->n_block * sizeof *s->block);
    s->code = malloc(s->n_block * codes * sizeof *s->code);
    s->block_capacity = s->block && s->code ? s->n_block : 0;
    return s->block_capacity
               ? 0
               : error_memory(e, "the places of particles", s->n_block * sizeof *s->block);
}

static int reserve_exact(struct skin *s, struct error *e)
{
    size_t bytes;

    s->n_exact = 0;
    for (size_t b = 0; b < s->n_block; b++) {
        if (s->block[b].exact != EXACT_NO) {
            s->block[b].exact = (uint32_t)s->n_exact++;
        }
    }
    if (s->n_exact <= s->exact_capacity) {
        return 0;
    }
    bytes = s->n_exact * (size_t)(s->dim + 1) * BLOCK * sizeof *s->exact;
    free(s->exact);
    s->exact = malloc(bytes);
    s->exact_capacity = s->exact ? s->n_exact : 0;
    return s->exact ? 0 : error_memory(e, "the places of particles", bytes);
}

int skin_keep(struct skin *s, const struct cloud *c, int threads, struct error *e)
{
    size_t columns = (size_t)c->dim + 1;

    if (s->dim != c->dim) {
        skin_fini(s);
    }
    (void)threads;
    s->dim = c->dim;
    s->n = c->n;
    s->n_block = (c->n + BLOCK - 1) / BLOCK;
    if (reserve_blocks(s, e) != 0) {
        s->n = SIZE_MAX; /* holds for no cloud */
        return -1;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (size_t b = 0; b < s->n_block; b++) {
        block_measure(&s->block[b], c, b * BLOCK, smaller(b * BLOCK + BLOCK, c->n));
    }
    if (reserve_exact(s, e) != 0) {
        s->n = SIZE_MAX;
        return -1;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (size_t b = 0; b < s->n_block; b++) {
        const struct skin_block *block = &s->block[b];
        size_t first = b * BLOCK, last = smaller(first + BLOCK, c->n);

        if (block->exact == EXACT_NO) {
            block_encode(block, c, first, last, s->code + b * columns * BLOCK);
        } else {
            block_copy(c, first, last, s->exact + block->exact * columns * BLOCK);
        }
    }
    return 0;
}

void skin_fini(struct skin *s)
{
    free(s->block);
    free(s->code);
    free(s->exact);
    memset(s, 0, sizeof *s);
}

size_t skin_bytes(const struct skin *s)
{
    size_t codes = (size_t)(s->dim + 1) * BLOCK;

    return s->block_capacity * (sizeof *s->block + codes * sizeof *s->code) +
           s->exact_capacity * codes * sizeof *s->exact;
}

/* -- What has changed -------------------------------------------------------------------------- */

/* Where a block's particles were, and less than their h. */
static inline __attribute__((always_inline)) void block_decode(const struct skin *s, size_t at,
                                                               double (*x)[BLOCK], double *h)
{
    const struct skin_block *b = &s->block[at];
    size_t columns = (size_t)s->dim + 1;
    const uint16_t *code = s->code + at * columns * BLOCK;

    if (b->exact != EXACT_NO) {
        const double *exact = s->exact + b->exact * columns * BLOCK;

        memcpy(x, exact, (size_t)s->dim * BLOCK * sizeof(double));
        memcpy(h, exact + (size_t)s->dim * BLOCK, BLOCK * sizeof *h);
        return;
    }
    for (int a = 0; a < s->dim; a++) {
#pragma omp simd
        for (size_t k = 0; k < BLOCK; k++) {
            x[a][k] = b->low[a] + (double)(int32_t)code[(size_t)a * BLOCK + k] * b->step[a];
        }
    }
    code += (size_t)s->dim * BLOCK;
#pragma omp simd
    for (size_t k = 0; k < BLOCK; k++) {
        /* Less that of code 0, which may stand for any smaller one. */
        h[k] = b->h * (ratio_of(code[k]) - 0x1p-31);
    }
}

static inline __attribute__((always_inline)) struct skin_change
block_change(const struct skin *s, size_t at, const struct cloud *c, double relative)
{
    size_t first = at * BLOCK, n = smaller(BLOCK, c->n - first);
    double x[3][BLOCK], h[BLOCK], most = 0, room = INFINITY, none = 0;

    block_decode(s, at, x, h);
#ifndef __clang__ /* which says that it cannot, and would do so as a warning */
#pragma omp simd reduction(max : most) reduction(min : room) reduction(+ : none)
#endif
    for (size_t k = 0; k < n; k++) {
        double r2 = 0, left;

        for (int a = 0; a < s->dim; a++) {
            double d = c->x[a][first + k] - x[a][k];

            r2 += d * d;
        }
        left = (1 + relative) * h[k] - c->h[first + k];
        most = r2 > most ? r2 : most;
        room = left < room ? left : room;
        none += (r2 + left) * 0;
    }
    return (struct skin_change){sqrt(most) + s->block[at].lost + none, room * c->scale};
}

typedef struct skin_change change_fn(const struct skin *s, size_t at, const struct cloud *c,
                                     double relative);

static struct skin_change change_plain(const struct skin *s, size_t at, const struct cloud *c,
                                       double relative)
{
    return block_change(s, at, c, relative);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) static struct skin_change
change_avx2(const struct skin *s, size_t at, const struct cloud *c, double relative)
{
    return block_change(s, at, c, relative);
}

static change_fn *change_best(void)
{
    return __builtin_cpu_supports("avx2") ? change_avx2 : change_plain;
}
#else
static change_fn *change_best(void)
{
    return change_plain;
}
#endif

struct skin_change skin_change(const struct skin *s, const struct cloud *c, double relative,
                               int threads)
{
    double moved = 0, room = INFINITY, none = 0;
    change_fn *change = change_best();

    (void)threads;
    if (s->n != c->n || (c->n > 0 && s->dim != c->dim)) {
        return (struct skin_change){NAN, NAN};
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)                    \
    reduction(max : moved) reduction(min : room) reduction(+ : none)
    for (size_t b = 0; b < s->n_block; b++) {
        struct skin_change here = change(s, b, c, relative);

        moved = here.moved > moved ? here.moved : moved;
        room = here.room < room ? here.room : room;
        none += here.moved * 0;
    }
    return (struct skin_change){moved + none, room};
}

bool skin_holds(const struct skin *s, const struct cloud *c, size_t n, double relative, int threads)
{
    double moved = 0, room = INFINITY;

    for (size_t k = 0; k < n; k++) {
        struct skin_change here = skin_change(&s[k], &c[k], relative, threads);

        if (!(here.moved < INFINITY)) {
            return false;
        }
        moved = here.moved > moved ? here.moved : moved;
        room = here.room < room ? here.room : room;
    }
    return 2 * moved <= room;
}
