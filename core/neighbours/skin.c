/* neighbours/skin.c -- keeps positions and h in few bits, and tells what has changed since. Reads
 * clouds; owns what it keeps. */
#include "neighbours/skin.h"

#include "neighbours/range.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 64
#define EXACT_NO UINT32_MAX
#define CODE_MOST 65535
#define ERROR_MOST 5e-4  /* of a block's smallest reach: what may be lost by rounding */
#define RATIO_LEAST 1e-6 /* h that are a smaller part of the block's largest would lose digits */

#define SKIN_INLINE static inline __attribute__((always_inline))

struct skin_block {
    double low[3], step[3];
    double h;       /* largest */
    double lost;    /* a position's error, at most */
    uint32_t exact; /* its place in `exact`, or EXACT_NO */
    uint32_t coded; /* 0: it is not rounded, and has no codes */
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

static inline uint16_t code_of(double ratio)
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

SKIN_INLINE void block_measure(struct skin_block *b, const struct cloud *c, size_t first, size_t n)
{
    double least = INFINITY, most = 0, sum = 0;
    const double *h = c->h + first;

    memset(b, 0, sizeof *b);
    b->exact = EXACT_NO;
    b->coded = 1;
    for (int a = 0; a < c->dim; a++) {
        const double *x = c->x[a] + first;
        double lo = INFINITY, hi = -INFINITY, lost;

#ifndef __clang__ /* which says that it cannot, and would do so as a warning */
#pragma omp simd reduction(min : lo) reduction(max : hi) reduction(+ : sum)
#endif
        for (size_t k = 0; k < n; k++) {
            lo = x[k] < lo ? x[k] : lo;
            hi = x[k] > hi ? x[k] : hi;
            sum += x[k] * 0; /* NAN if a number is none */
        }
        b->low[a] = lo;
        b->step[a] = (hi - lo) / CODE_MOST;
        /* Half a step, and the rounding of the sums. */
        lost = b->step[a] / 2 * (1 + 1e-6) + 8 * DBL_EPSILON * (fabs(lo) + fabs(hi));
        b->lost += lost * lost;
    }
    b->lost = sqrt(b->lost);
#ifndef __clang__
#pragma omp simd reduction(min : least) reduction(max : most) reduction(+ : sum)
#endif
    for (size_t k = 0; k < n; k++) {
        least = h[k] < least ? h[k] : least;
        most = h[k] > most ? h[k] : most;
        sum += h[k] * 0;
    }
    b->h = most;
    if (!(b->lost + sum <= ERROR_MOST * c->scale * least) || !(least >= RATIO_LEAST * b->h)) {
        b->coded = 0;
        b->exact = 0;
        b->lost = 0;
    }
}

SKIN_INLINE void block_encode(const struct skin_block *b, const struct cloud *c, size_t first,
                              size_t n, bool even, uint16_t *code)
{
    const double *h = c->h + first, part = b->h > 0 ? 1 / b->h : 0;
    int columns = c->dim;

    for (int a = 0; a < c->dim; a++) {
        const double *x = c->x[a] + first, low = b->low[a];
        const double inverse = b->step[a] > 0 ? 1 / b->step[a] : 0;

#pragma omp simd
        for (size_t k = 0; k < n; k++) {
            double q = (x[k] - low) * inverse + 0.5;

            code[(size_t)a * BLOCK + k] = (uint16_t)(int32_t)(q < CODE_MOST ? q : CODE_MOST);
        }
    }
    if (!even) {
        columns++;
#pragma omp simd
        for (size_t k = 0; k < n; k++) {
            code[(size_t)c->dim * BLOCK + k] = code_of(h[k] * part);
        }
    }
    for (int a = 0; a < columns; a++) {
        for (size_t k = n; k < BLOCK; k++) {
            code[(size_t)a * BLOCK + k] = code[(size_t)a * BLOCK + n - 1];
        }
    }
}

static void block_copy(const struct cloud *c, size_t first, size_t n, double *exact)
{
    for (int a = 0; a <= c->dim; a++) {
        const double *x = a < c->dim ? c->x[a] : c->h;

        for (size_t k = 0; k < BLOCK; k++) {
            exact[(size_t)a * BLOCK + k] = x[first + smaller(k, n - 1)];
        }
    }
}

/* Codes of a block: its positions', its h's unless all are the same. */
static size_t codes_of(const struct skin *s)
{
    return (size_t)(s->dim + !s->even) * BLOCK;
}

static int reserve_blocks(struct skin *s, struct error *e)
{
    size_t codes = codes_of(s);

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

void skin_fini(struct skin *s)
{
    free(s->block);
    free(s->code);
    free(s->exact);
    memset(s, 0, sizeof *s);
}

size_t skin_bytes(const struct skin *s)
{
    size_t exact = (size_t)(s->dim + 1) * BLOCK;

    return s->block_capacity * (sizeof *s->block + codes_of(s) * sizeof *s->code) +
           s->exact_capacity * exact * sizeof *s->exact;
}

/* -- What has changed -------------------------------------------------------------------------- */

/* What is now against what was, of n particles of a block. */
SKIN_INLINE struct skin_change exact_change(const double *was, const struct cloud *c, size_t first,
                                            size_t n, double relative, int dim, bool fixed)
{
    const double *x[3], *h = fixed ? NULL : c->h + first, *was_h = was + (size_t)dim * BLOCK;
    double most = 0, room = INFINITY, none = 0;

    for (int a = 0; a < 3; a++) {
        x[a] = a < dim ? c->x[a] + first : NULL;
    }
#ifndef __clang__ /* which says that it cannot, and would do so as a warning */
#pragma omp simd reduction(max : most) reduction(min : room) reduction(+ : none)
#endif
    for (size_t k = 0; k < n; k++) {
        double left = (1 + relative) * was_h[k] - (fixed ? was_h[k] : h[k]), r2 = 0;

#pragma GCC unroll 3
        for (int a = 0; a < dim; a++) {
            double d = x[a][k] - was[(size_t)a * BLOCK + k];

            r2 += d * d;
        }
        most = r2 > most ? r2 : most;
        room = left < room ? left : room;
        none += (r2 + left) * 0;
    }
    return (struct skin_change){sqrt(most) + none, room * c->scale};
}

SKIN_INLINE struct skin_change exact_in(const double *was, const struct cloud *c, size_t first,
                                        size_t n, double relative, int dim)
{
    return c->h ? exact_change(was, c, first, n, relative, dim, false)
                : exact_change(was, c, first, n, relative, dim, true);
}

/* The same where the places are kept in codes; h are taken a little less than they were. */
SKIN_INLINE struct skin_change coded_change(const struct skin_block *b, const uint16_t *code,
                                            const struct cloud *c, size_t first, size_t n,
                                            double relative, int dim, bool fixed, bool even)
{
    const double *x[3], *h = fixed ? NULL : c->h + first;
    double most = 0, room = INFINITY, none = 0;

    for (int a = 0; a < 3; a++) {
        x[a] = a < dim ? c->x[a] + first : NULL;
    }
#ifndef __clang__ /* which says that it cannot, and would do so as a warning */
#pragma omp simd reduction(max : most) reduction(min : room) reduction(+ : none)
#endif
    for (size_t k = 0; k < n; k++) {
        /* Less that of code 0, which may stand for any smaller one. */
        double was = even ? b->h : b->h * (ratio_of(code[(size_t)dim * BLOCK + k]) - 0x1p-31);
        double left = fixed ? relative * was : (1 + relative) * was - h[k], r2 = 0;

#pragma GCC unroll 3
        for (int a = 0; a < dim; a++) {
            double d = b->low[a] + (double)(int32_t)code[(size_t)a * BLOCK + k] * b->step[a];

            d = x[a][k] - d;
            r2 += d * d;
        }
        most = r2 > most ? r2 : most;
        room = left < room ? left : room;
        none += (r2 + left) * 0;
    }
    return (struct skin_change){sqrt(most) + b->lost + none, room * c->scale};
}

/* In a dimension, with what is known of h written out. */
SKIN_INLINE struct skin_change coded_in(const struct skin_block *b, const uint16_t *code,
                                        const struct cloud *c, size_t first, size_t n,
                                        double relative, int dim, bool even)
{
    if (c->h) {
        return even ? coded_change(b, code, c, first, n, relative, dim, false, true)
                    : coded_change(b, code, c, first, n, relative, dim, false, false);
    }
    return even ? coded_change(b, code, c, first, n, relative, dim, true, true)
                : coded_change(b, code, c, first, n, relative, dim, true, false);
}

SKIN_INLINE struct skin_change block_change(const struct skin *s, size_t at, const struct cloud *c,
                                            double relative)
{
    const struct skin_block *b = &s->block[at];
    size_t first = at * BLOCK, n = smaller(BLOCK, c->n - first);
    size_t columns = (size_t)s->dim + 1;
    const uint16_t *code = s->code + at * codes_of(s);

    if (!b->coded) {
        const double *was = s->exact + b->exact * columns * BLOCK;

        return c->dim == 1   ? exact_in(was, c, first, n, relative, 1)
               : c->dim == 2 ? exact_in(was, c, first, n, relative, 2)
                             : exact_in(was, c, first, n, relative, 3);
    }
#define CODED(dim) coded_in(b, code, c, first, n, relative, dim, s->even)
    return s->dim == 1 ? CODED(1) : s->dim == 2 ? CODED(2) : CODED(3);
#undef CODED
}

/* -- For this processor ------------------------------------------------------------------------ */

/* The loops over a block's particles. */
struct skin_calls {
    void (*measure)(struct skin_block *b, const struct cloud *c, size_t first, size_t n);
    void (*encode)(const struct skin_block *b, const struct cloud *c, size_t first, size_t n,
                   bool even, uint16_t *code);
    struct skin_change (*change)(const struct skin *s, size_t at, const struct cloud *c,
                                 double relative);
};

#define SKIN_CALLS(name, target)                                                                   \
    target static void measure_##name(struct skin_block *b, const struct cloud *c, size_t first,   \
                                      size_t n)                                                    \
    {                                                                                              \
        block_measure(b, c, first, n);                                                             \
    }                                                                                              \
    target static void encode_##name(const struct skin_block *b, const struct cloud *c,            \
                                     size_t first, size_t n, bool even, uint16_t *code)            \
    {                                                                                              \
        block_encode(b, c, first, n, even, code);                                                  \
    }                                                                                              \
    target static struct skin_change change_##name(const struct skin *s, size_t at,                \
                                                   const struct cloud *c, double relative)         \
    {                                                                                              \
        return block_change(s, at, c, relative);                                                   \
    }                                                                                              \
    static const struct skin_calls calls_##name = {measure_##name, encode_##name, change_##name};

SKIN_CALLS(plain, )
#if defined(__x86_64__) && defined(__GNUC__)
SKIN_CALLS(avx2, __attribute__((target("avx2"))))

static const struct skin_calls *calls_best(void)
{
    return __builtin_cpu_supports("avx2") ? &calls_avx2 : &calls_plain;
}
#else
static const struct skin_calls *calls_best(void)
{
    return &calls_plain;
}
#endif

/* -- All blocks -------------------------------------------------------------------------------- */

int skin_keep(struct skin *s, const struct cloud *c, int threads, struct error *e)
{
    const struct skin_calls *calls = calls_best();
    size_t columns = (size_t)c->dim + 1;
    struct range h = range_of(c->h, c->n, threads);
    bool even = !(h.least < h.most);
    enum skin_form form = s->form;

    if (s->dim != c->dim || s->even != even) {
        skin_fini(s);
    }
    s->form = form;
    (void)threads;
    s->even = even;
    s->dim = c->dim;
    s->n = c->n;
    s->n_block = (c->n + BLOCK - 1) / BLOCK;
    if (reserve_blocks(s, e) != 0) {
        s->n = SIZE_MAX; /* holds for no cloud */
        return -1;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (size_t b = 0; b < s->n_block; b++) {
        calls->measure(&s->block[b], c, b * BLOCK, smaller(BLOCK, c->n - b * BLOCK));
        if (form != SKIN_SHORT) {
            s->block[b].exact = 0;
        }
        if (form == SKIN_EXACT) {
            s->block[b].coded = 0;
            s->block[b].lost = 0;
        }
    }
    if (reserve_exact(s, e) != 0) {
        s->n = SIZE_MAX;
        return -1;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (size_t b = 0; b < s->n_block; b++) {
        const struct skin_block *block = &s->block[b];
        size_t first = b * BLOCK, n = smaller(BLOCK, c->n - first);

        if (block->coded) {
            calls->encode(block, c, first, n, even, s->code + b * codes_of(s));
        }
        if (block->exact != EXACT_NO) {
            block_copy(c, first, n, s->exact + block->exact * columns * BLOCK);
        }
    }
    return 0;
}

struct skin_change skin_change(const struct skin *s, const struct cloud *c, double relative,
                               int threads)
{
    double moved = 0, room = INFINITY, none = 0;
    const struct skin_calls *calls = calls_best();

    (void)threads;
    if (s->n != c->n || (c->n > 0 && s->dim != c->dim)) {
        return (struct skin_change){NAN, NAN};
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)                    \
    reduction(max : moved) reduction(min : room) reduction(+ : none)
    for (size_t b = 0; b < s->n_block; b++) {
        struct skin_change here = calls->change(s, b, c, relative);

        moved = here.moved > moved ? here.moved : moved;
        room = here.room < room ? here.room : room;
        none += here.moved * 0;
    }
    return (struct skin_change){moved + none, room};
}

struct skin skin_part(const struct skin *s, size_t first, size_t n)
{
    struct skin part = *s;

    part.n = n;
    part.n_block = (n + BLOCK - 1) / BLOCK;
    part.block += first / BLOCK;
    part.code += first / BLOCK * codes_of(s);
    return part;
}

bool skin_places(const struct skin *s, size_t first, size_t n, double *const *x, double *h)
{
    const size_t columns = (size_t)s->dim + 1;

    if (s->n == SIZE_MAX || first > s->n || n > s->n - first) {
        return false;
    }
    for (size_t k = 0; k < n; k++) {
        const struct skin_block *b = &s->block[(first + k) / BLOCK];
        const double *was;

        if (b->exact == EXACT_NO) {
            return false;
        }
        was = s->exact + b->exact * columns * BLOCK + (first + k) % BLOCK;
        for (int a = 0; a < s->dim; a++) {
            x[a][k] = was[(size_t)a * BLOCK];
        }
        h[k] = was[(size_t)s->dim * BLOCK];
    }
    return true;
}

/* -- Into a checkpoint and out of it ----------------------------------------------------------- */

static bool skin_fits(const struct skin *s, size_t bytes, size_t codes, size_t exact)
{
    size_t columns = (size_t)s->dim + 1;

    if (s->dim < 0 || s->dim > 3 || bytes != s->n_block * sizeof *s->block ||
        codes != s->n_block * codes_of(s) || exact != s->n_exact * columns * BLOCK ||
        (s->n != SIZE_MAX && s->n_block != (s->n + BLOCK - 1) / BLOCK)) {
        return false;
    }
    for (size_t b = 0; b < s->n_block; b++) {
        if ((s->block[b].exact != EXACT_NO || !s->block[b].coded) &&
            s->block[b].exact >= s->n_exact) {
            return false;
        }
    }
    return true;
}

int skin_store(struct skin *s, struct store *store, struct error *e)
{
    size_t bytes = s->block ? s->n_block * sizeof *s->block : 0, dim = (size_t)s->dim;
    size_t codes = s->code ? s->n_block * codes_of(s) : 0;
    size_t exact = s->exact ? s->n_exact * (dim + 1) * BLOCK : 0;

    if (store_count(store, "dim", &dim, e) != 0 ||
        store_flags(store, "even", &s->even, 1, e) != 0 || store_count(store, "n", &s->n, e) != 0 ||
        store_count(store, "n_block", &s->n_block, e) != 0 ||
        store_count(store, "n_exact", &s->n_exact, e) != 0 ||
        store_array(store, "block", STORE_U8, &s->block, &bytes, 0, e) != 0 ||
        store_array(store, "code", STORE_U16, &s->code, &codes, 0, e) != 0 ||
        store_array(store, "exact", STORE_F64, &s->exact, &exact, 0, e) != 0) {
        return -1;
    }
    if (store->reading) {
        s->dim = (int)dim;
        s->block_capacity = s->n_block;
        s->exact_capacity = s->n_exact;
        if (!skin_fits(s, bytes, codes, exact)) {
            return store_broken(store, e, "%s is not what is kept of places", store->group);
        }
    }
    return 0;
}
