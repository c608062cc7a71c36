/* neighbours/filter_avx2.c -- the neighbour search's inner loops for AVX2 and FMA. Pure. */
#include "neighbours/filter.h"

#include <math.h>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

#define AVX2 __attribute__((target("avx2,fma,popcnt")))
#define AVX2_INLINE static inline __attribute__((always_inline, target("avx2,fma,popcnt")))

/* Of four vectors the least of each. */
AVX2_INLINE __m256d avx2_least4(__m256d a, __m256d b, __m256d c, __m256d d)
{
    __m256d x = _mm256_min_pd(_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    __m256d y = _mm256_min_pd(_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));

    return _mm256_min_pd(_mm256_permute2f128_pd(x, y, 0x20), _mm256_permute2f128_pd(x, y, 0x31));
}

AVX2_INLINE __m256d avx2_most4(__m256d a, __m256d b, __m256d c, __m256d d)
{
    __m256d x = _mm256_max_pd(_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    __m256d y = _mm256_max_pd(_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));

    return _mm256_max_pd(_mm256_permute2f128_pd(x, y, 0x20), _mm256_permute2f128_pd(x, y, 0x31));
}

/* The least and the largest of each of four leaves of a column. */
AVX2_INLINE void avx2_range4(const double *x, __m256d *least, __m256d *most)
{
    __m256d lo[4], hi[4];

#pragma GCC unroll 4
    for (int k = 0; k < 4; k++) {
        __m256d a = _mm256_loadu_pd(x + k * LEAF), b = _mm256_loadu_pd(x + k * LEAF + 4);

        lo[k] = _mm256_min_pd(a, b);
        hi[k] = _mm256_max_pd(a, b);
    }
    *least = avx2_least4(lo[0], lo[1], lo[2], lo[3]);
    *most = avx2_most4(hi[0], hi[1], hi[2], hi[3]);
}

AVX2 static void avx2_eight(struct box8 *out, double *least, const struct points *p, size_t leaf)
{
    size_t first = leaf * LEAF;

    if (first + LEAF * LEAF > p->n) {
        filter_plain()->eight(out, least, p, leaf);
        return;
    }
    for (int k = 0; k < LEAF; k += 4) {
        __m256d lo = _mm256_setzero_pd(), hi = lo, scale = _mm256_set1_pd(p->scale);

        for (int a = 0; a < 3; a++) {
            if (a < p->dim) {
                avx2_range4(p->x[a] + first + k * LEAF, &lo, &hi);
            } else {
                lo = hi = _mm256_setzero_pd();
            }
            _mm256_storeu_pd(&out->lo[a][k], lo);
            _mm256_storeu_pd(&out->hi[a][k], hi);
        }
        lo = hi = _mm256_setzero_pd();
        if (p->scale > 0) {
            avx2_range4(p->h + first + k * LEAF, &lo, &hi);
        }
        _mm256_storeu_pd(&out->reach[k], _mm256_mul_pd(hi, scale));
        _mm256_storeu_pd(&least[k], _mm256_mul_pd(lo, scale));
    }
}

AVX2_INLINE unsigned avx2_near_four(const struct box8 *b, int k, const struct query *q, int dim)
{
    __m256d gap = _mm256_setzero_pd(), zero = gap, reach;

#pragma GCC unroll 3
    for (int a = 0; a < dim; a++) {
        __m256d below = _mm256_sub_pd(_mm256_load_pd(&b->lo[a][k]), _mm256_set1_pd(q->hi[a]));
        __m256d above = _mm256_sub_pd(_mm256_set1_pd(q->lo[a]), _mm256_load_pd(&b->hi[a][k]));
        __m256d d = _mm256_max_pd(_mm256_max_pd(below, above), zero);

        gap = _mm256_fmadd_pd(d, d, gap);
    }
    reach = _mm256_max_pd(_mm256_load_pd(&b->reach[k]), _mm256_set1_pd(q->reach));
    reach = _mm256_mul_pd(reach, _mm256_set1_pd(1 + MARGIN));
    return (unsigned)_mm256_movemask_pd(
        _mm256_cmp_pd(gap, _mm256_mul_pd(reach, reach), _CMP_LE_OQ));
}

AVX2 static unsigned avx2_near_boxes(const struct box8 *b, const struct query *q, int dim)
{
    if (dim == 3) {
        return avx2_near_four(b, 0, q, 3) | avx2_near_four(b, 4, q, 3) << 4;
    }
    if (dim == 2) {
        return avx2_near_four(b, 0, q, 2) | avx2_near_four(b, 4, q, 2) << 4;
    }
    return avx2_near_four(b, 0, q, 1) | avx2_near_four(b, 4, q, 1) << 4;
}

/* Eight doubles, moved and scaled, as floats. */
AVX2_INLINE __m256 avx2_float(const double *x, double centre, double inverse)
{
    __m256d c = _mm256_set1_pd(centre), f = _mm256_set1_pd(inverse);
    __m128 low = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(x), c), f));
    __m128 high = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(x + 4), c), f));

    return _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
}

AVX2_INLINE float avx2_least(__m256 x)
{
    __m128 m = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));

    m = _mm_min_ps(m, _mm_movehl_ps(m, m));
    return _mm_cvtss_f32(_mm_min_ss(m, _mm_movehdup_ps(m)));
}

AVX2_INLINE float avx2_most(__m256 x)
{
    __m128 m = _mm_max_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));

    m = _mm_max_ps(m, _mm_movehl_ps(m, m));
    return _mm_cvtss_f32(_mm_max_ss(m, _mm_movehdup_ps(m)));
}

/* Of two vectors, halves of which are compared: the smaller ones, in turns. */
AVX2_INLINE __m256 avx2_fold(__m256 x, __m256 y)
{
    return _mm256_min_ps(_mm256_unpacklo_ps(x, y), _mm256_unpackhi_ps(x, y));
}

AVX2_INLINE __m256 avx2_fold2(__m256 x, __m256 y)
{
    __m256d a = _mm256_castps_pd(x), b = _mm256_castps_pd(y);

    return _mm256_min_ps(_mm256_castpd_ps(_mm256_unpacklo_pd(a, b)),
                         _mm256_castpd_ps(_mm256_unpackhi_pd(a, b)));
}

/* The least of each of eight vectors. */
AVX2_INLINE __m256 avx2_least8(const __m256 *v)
{
    __m256 low = avx2_fold2(avx2_fold(v[0], v[1]), avx2_fold(v[2], v[3]));
    __m256 high = avx2_fold2(avx2_fold(v[4], v[5]), avx2_fold(v[6], v[7]));

    return _mm256_min_ps(_mm256_permute2f128_ps(low, high, 0x20),
                         _mm256_permute2f128_ps(low, high, 0x31));
}

AVX2_INLINE void avx2_transpose(const __m256 *row, __m256 *column)
{
    __m256 a[8], b[8];

#pragma GCC unroll 4
    for (int k = 0; k < 8; k += 2) {
        a[k] = _mm256_unpacklo_ps(row[k], row[k + 1]);
        a[k + 1] = _mm256_unpackhi_ps(row[k], row[k + 1]);
    }
#pragma GCC unroll 2
    for (int k = 0; k < 8; k += 4) {
        b[k] = _mm256_shuffle_ps(a[k], a[k + 2], 0x44);
        b[k + 1] = _mm256_shuffle_ps(a[k], a[k + 2], 0xee);
        b[k + 2] = _mm256_shuffle_ps(a[k + 1], a[k + 3], 0x44);
        b[k + 3] = _mm256_shuffle_ps(a[k + 1], a[k + 3], 0xee);
    }
#pragma GCC unroll 4
    for (int k = 0; k < 4; k++) {
        column[k] = _mm256_permute2f128_ps(b[k], b[k + 4], 0x20);
        column[k + 4] = _mm256_permute2f128_ps(b[k], b[k + 4], 0x31);
    }
}

/* Fills a leaf's pack; the least of x, y, z, -x, -y, -z, -reach. */
AVX2_INLINE __m256 avx2_pack_one(struct packed_leaf *p, const struct sources *s,
                                 const struct frame *f, uint32_t leaf, int dim)
{
    size_t first = (size_t)leaf * LEAF, last = first + LEAF < s->n ? first + LEAF : s->n;
    __m256 zero = _mm256_setzero_ps(), s2 = zero, reach = zero;
    __m256 far = _mm256_set1_ps((float)FILTER_FAR),
           v[8] = {zero, zero, zero, zero, zero, zero, zero, zero};
    double room[LEAF];

#pragma GCC unroll 3
    for (int a = 0; a < dim; a++) {
        const double *from = filter_eight(s->x[a], first, last, room);
        __m256 x = avx2_float(from, f->centre[a], f->inverse);

        x = _mm256_max_ps(_mm256_min_ps(x, far), _mm256_sub_ps(zero, far));
        _mm256_store_ps(p->x[a], x);
        s2 = _mm256_fmadd_ps(x, x, s2);
        v[a] = x;
        v[a + 3] = _mm256_sub_ps(zero, x);
    }
    if (s->scale > 0) {
        reach = avx2_float(filter_eight(s->h, first, last, room), 0, f->inverse * s->scale);
        v[6] = _mm256_sub_ps(zero, reach);
    }
    _mm256_store_ps(p->s, s2);
    _mm256_store_ps(p->r2, _mm256_mul_ps(reach, reach));
    for (size_t i = last - first; i < LEAF; i++) {
        p->s[i] = INFINITY;
    }
    return avx2_least8(v);
}

AVX2_INLINE void avx2_pack_dim(struct packed_leaf *p, struct packed_box8 *box,
                               const struct sources *s, const struct frame *f, const uint32_t *leaf,
                               size_t n, int dim)
{
    __m256 row[8], zero = _mm256_setzero_ps(), far = _mm256_set1_ps(INFINITY);

    for (size_t k = 0; k < LEAF; k++) {
        row[k] =
            k < n ? avx2_pack_one(&p[k], s, f, leaf[k], dim) : _mm256_blend_ps(far, zero, 0xc0);
    }
    avx2_transpose(row, row);
#pragma GCC unroll 3
    for (int a = 0; a < dim; a++) {
        _mm256_store_ps(box->lo[a], row[a]);
        _mm256_store_ps(box->hi[a], _mm256_sub_ps(zero, row[a + 3]));
    }
    _mm256_store_ps(box->reach, _mm256_sub_ps(zero, row[6]));
}

AVX2 static void avx2_pack(struct packed_leaf *p, struct packed_box8 *box, const struct sources *s,
                           const struct frame *f, const uint32_t *leaf, size_t n)
{
    if (s->dim == 3) {
        avx2_pack_dim(p, box, s, f, leaf, n, 3);
    } else if (s->dim == 2) {
        avx2_pack_dim(p, box, s, f, leaf, n, 2);
    } else {
        avx2_pack_dim(p, box, s, f, leaf, n, 1);
    }
}

AVX2 static void avx2_lanes(struct lanes *t, const struct cloud *c, double scale,
                            const struct frame *f, size_t first, size_t last)
{
    double room[LEAF];
    __m256d low = _mm256_setzero_pd(), high = low, inverse = _mm256_set1_pd(f->inverse);
    __m256 reach = avx2_float(filter_eight(c->h, first, last, room), 0, scale * f->inverse);

    for (int a = 0; a < c->dim; a++) {
        const double *from = filter_eight(c->x[a], first, last, room);
        __m256d centre = _mm256_set1_pd(f->centre[a]);
        __m256d x = _mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(from), centre), inverse);
        __m256d y = _mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(from + 4), centre), inverse);
        __m256 near =
            _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(x)), _mm256_cvtpd_ps(y), 1);

        low = _mm256_fmadd_pd(x, x, low);
        high = _mm256_fmadd_pd(y, y, high);
        _mm256_storeu_ps(t->m2a[a], _mm256_mul_ps(near, _mm256_set1_ps(-2)));
        t->lo[a] = avx2_least(near);
        t->hi[a] = avx2_most(near);
    }
    _mm256_storeu_ps(t->a2, _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)),
                                                 _mm256_cvtpd_ps(high), 1));
    _mm256_storeu_ps(t->r2, _mm256_mul_ps(reach, reach));
    t->reach = avx2_most(reach);
    t->uniform = t->reach <= UNIFORM * avx2_least(reach);
}

/* For every byte the numbers of its set bits, lowest first, a byte each. */
#define BIT(m, b) ((uint64_t)((m) >> (b)&1))
#define BELOW(m, b)                                                                                \
    (((b) > 0) * BIT(m, 0) + ((b) > 1) * BIT(m, 1) + ((b) > 2) * BIT(m, 2) +                       \
     ((b) > 3) * BIT(m, 3) + ((b) > 4) * BIT(m, 4) + ((b) > 5) * BIT(m, 5) +                       \
     ((b) > 6) * BIT(m, 6))
#define PUT(m, b) (BIT(m, b) * (b) << 8 * BELOW(m, b))
#define SET1(m)                                                                                    \
    PUT(m, 0) | PUT(m, 1) | PUT(m, 2) | PUT(m, 3) | PUT(m, 4) | PUT(m, 5) | PUT(m, 6) | PUT(m, 7)
#define SET4(m) SET1(m), SET1((m) + 1), SET1((m) + 2), SET1((m) + 3)
#define SET16(m) SET4(m), SET4((m) + 4), SET4((m) + 8), SET4((m) + 12)
#define SET64(m) SET16(m), SET16((m) + 16), SET16((m) + 32), SET16((m) + 48)
static const uint64_t set_bits[256] = {SET64(0), SET64(64), SET64(128), SET64(192)};

/* Writes base + k for every set bit k of the mask (and rubbish up to 8 places on). */
AVX2_INLINE size_t avx2_put(uint32_t *out, uint32_t base, unsigned mask)
{
    __m256i k =
        _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)&set_bits[mask]));

    _mm256_storeu_si256((__m256i *)(void *)out, _mm256_add_epi32(k, _mm256_set1_epi32((int)base)));
    return (size_t)__builtin_popcount(mask);
}

AVX2_INLINE size_t avx2_leaves(const struct packed_box8 *boxes, size_t n, const struct lanes *t,
                               int dim, uint32_t *out)
{
    __m256 zero = _mm256_setzero_ps(), own = _mm256_set1_ps(t->reach);
    __m256 margin = _mm256_set1_ps(1 + (float)MARGIN);
    size_t found = 0;

    for (size_t q = 0; q < n; q += LEAF) {
        const struct packed_box8 *b = &boxes[q / LEAF];
        __m256 gap = zero, reach = _mm256_max_ps(_mm256_load_ps(b->reach), own);

#pragma GCC unroll 3
        for (int a = 0; a < dim; a++) {
            __m256 below = _mm256_sub_ps(_mm256_load_ps(b->lo[a]), _mm256_set1_ps(t->hi[a]));
            __m256 above = _mm256_sub_ps(_mm256_set1_ps(t->lo[a]), _mm256_load_ps(b->hi[a]));
            __m256 d = _mm256_max_ps(_mm256_max_ps(below, above), zero);

            gap = _mm256_fmadd_ps(d, d, gap);
        }
        reach = _mm256_mul_ps(reach, margin);
        reach = _mm256_mul_ps(reach, reach);
        found += avx2_put(out + found, (uint32_t)q,
                          (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(gap, reach, _CMP_LE_OQ)));
    }
    return found;
}

AVX2 static size_t avx2_near_leaves(const struct packed_box8 *boxes, size_t n,
                                    const struct lanes *t, int dim, uint32_t *out)
{
    if (dim == 3) {
        return avx2_leaves(boxes, n, t, 3, out);
    }
    return dim == 2 ? avx2_leaves(boxes, n, t, 2, out) : avx2_leaves(boxes, n, t, 1, out);
}

/* low, high: bits of the points that the lower half of the lanes sees, and the upper; of the group's own
 * places both see what one sees. */
AVX2_INLINE void avx2_found(struct found *out, uint32_t base, bool own, unsigned low, unsigned high)
{
    unsigned common = own ? low | high : low & high;

    out->n[BY_BOTH] += avx2_put(out->source[BY_BOTH] + out->n[BY_BOTH], base, common);
    out->n[BY_LOWER] += avx2_put(out->source[BY_LOWER] + out->n[BY_LOWER], base, low & ~common);
    out->n[BY_UPPER] += avx2_put(out->source[BY_UPPER] + out->n[BY_UPPER], base, high & ~common);
}

AVX2_INLINE unsigned avx2_verdict(const struct packed_leaf *p, const struct lanes *t, int uniform,
                                  __m256 any, __m256 own)
{
    __m256 s = _mm256_load_ps(p->s), r2 = _mm256_load_ps(p->r2), hit;

    if (uniform) {
        r2 = _mm256_max_ps(r2, _mm256_set1_ps(t->reach * t->reach));
        hit = _mm256_cmp_ps(any, _mm256_sub_ps(r2, s), _CMP_LE_OQ);
    } else {
        hit = _mm256_or_ps(_mm256_cmp_ps(any, _mm256_sub_ps(r2, s), _CMP_LE_OQ),
                           _mm256_cmp_ps(own, _mm256_sub_ps(_mm256_setzero_ps(), s), _CMP_LE_OQ));
    }
    return (unsigned)_mm256_movemask_ps(hit);
}

/* Two leaves at a time, for they share what is loaded of the lanes: half of them, from `first` on. */
AVX2_INLINE void avx2_two(const struct packed_leaf *p, const struct packed_leaf *q,
                          const struct lanes *t, int dim, int uniform, int first, unsigned *mask)
{
    __m256 any0 = _mm256_set1_ps(3e38f), any1 = any0, own0 = any0, own1 = any0;

#pragma GCC unroll 4
    for (int i = first; i < first + 4; i++) {
        __m256 d0 = _mm256_broadcast_ss(&t->a2[i]), d1 = d0;

#pragma GCC unroll 3
        for (int a = 0; a < dim; a++) {
            __m256 m2a = _mm256_broadcast_ss(&t->m2a[a][i]);

            d0 = _mm256_fmadd_ps(m2a, _mm256_load_ps(p->x[a]), d0);
            d1 = _mm256_fmadd_ps(m2a, _mm256_load_ps(q->x[a]), d1);
        }
        any0 = _mm256_min_ps(d0, any0);
        any1 = _mm256_min_ps(d1, any1);
        if (!uniform) {
            __m256 r2 = _mm256_broadcast_ss(&t->r2[i]);

            own0 = _mm256_min_ps(_mm256_sub_ps(d0, r2), own0);
            own1 = _mm256_min_ps(_mm256_sub_ps(d1, r2), own1);
        }
    }
    mask[0] = avx2_verdict(p, t, uniform, any0, own0);
    mask[1] = avx2_verdict(q, t, uniform, any1, own1);
}

AVX2_INLINE void avx2_points(const struct packed_leaf *pack, const uint32_t *leaf,
                             const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                             int uniform, uint32_t own, struct found *out)
{
    unsigned low[2], high[2];

    for (size_t q = 0; q < n; q += 2) {
        uint32_t a = chosen[q], b = chosen[q + 1 < n ? q + 1 : q];

        avx2_two(&pack[a], &pack[b], t, dim, uniform, 0, low);
        avx2_two(&pack[a], &pack[b], t, dim, uniform, 4, high);
        avx2_found(out, leaf[a] * LEAF, leaf[a] == own, low[0], high[0]);
        if (q + 1 < n) {
            avx2_found(out, leaf[b] * LEAF, leaf[b] == own, low[1], high[1]);
        }
    }
}

AVX2 static void avx2_near_points(const struct packed_leaf *pack, const uint32_t *leaf,
                                  const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                                  uint32_t own, struct found *out)
{
    switch (2 * dim + (t->uniform != 0)) {
    case 2:
        avx2_points(pack, leaf, chosen, n, t, 1, 0, own, out);
        break;
    case 3:
        avx2_points(pack, leaf, chosen, n, t, 1, 1, own, out);
        break;
    case 4:
        avx2_points(pack, leaf, chosen, n, t, 2, 0, own, out);
        break;
    case 5:
        avx2_points(pack, leaf, chosen, n, t, 2, 1, own, out);
        break;
    case 6:
        avx2_points(pack, leaf, chosen, n, t, 3, 0, own, out);
        break;
    default:
        avx2_points(pack, leaf, chosen, n, t, 3, 1, own, out);
    }
}

AVX2 static void avx2_steps(uint16_t *out, const uint32_t *found, size_t n, uint32_t base)
{
    __m256i b = _mm256_set1_epi32((int)base);

    for (size_t k = 0; k < n; k += 16) {
        const __m256i *from = (const __m256i *)(const void *)(found + k);
        __m256i low = _mm256_sub_epi32(_mm256_loadu_si256(from), b);
        __m256i high = _mm256_sub_epi32(_mm256_loadu_si256(from + 1), b);
        __m256i both = _mm256_packus_epi32(low, high); /* a half from each, in turns */

        _mm256_storeu_si256((__m256i *)(void *)(out + k), _mm256_permute4x64_epi64(both, 0xd8));
    }
}

AVX2 static void avx2_turns(uint16_t *out, const uint32_t *lower, const uint32_t *upper, size_t n,
                            uint32_t base)
{
    __m256i b = _mm256_set1_epi32((int)base);

    for (size_t k = 0; k < n; k += 8) {
        __m256i low = _mm256_loadu_si256((const __m256i *)(const void *)(lower + k));
        __m256i high = _mm256_loadu_si256((const __m256i *)(const void *)(upper + k));

        high = _mm256_slli_epi32(_mm256_sub_epi32(high, b), 16);
        low = _mm256_blend_epi16(high, _mm256_sub_epi32(low, b), 0x55);
        _mm256_storeu_si256((__m256i *)(void *)(out + 2 * k), low);
    }
}

static const struct filter avx2 = {avx2_eight,       avx2_near_boxes,  avx2_pack,  avx2_lanes,
                                   avx2_near_leaves, avx2_near_points, avx2_steps, avx2_turns};

static const struct filter avx512 = {
    avx2_eight,       filter_near_boxes_avx512,  avx2_pack,  avx2_lanes,
    avx2_near_leaves, filter_near_points_avx512, avx2_steps, avx2_turns};

const struct filter *filter_avx512(void)
{
    return filter_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")
               ? &avx512
               : NULL;
}

const struct filter *filter_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                   __builtin_cpu_supports("popcnt")
               ? &avx2
               : NULL;
}

#else

const struct filter *filter_avx2(void)
{
    return NULL;
}

const struct filter *filter_avx512(void)
{
    return NULL;
}
#endif
