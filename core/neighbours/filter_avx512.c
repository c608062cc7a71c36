/* neighbours/filter_avx512.c -- the innermost loops of the neighbour search for AVX-512: eight boxes
 * are one vector, and so are two leaves. The rest is filter_avx2.c. Pure. */
#include "neighbours/filter.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

#define AVX512 __attribute__((target("avx2,fma,avx512f,avx512dq,popcnt")))
#define AVX512_INLINE                                                                              \
    static inline __attribute__((always_inline, target("avx2,fma,avx512f,avx512dq,popcnt")))

AVX512_INLINE unsigned near_eight(const struct box8 *b, const struct query *q, int dim)
{
    __m512d gap = _mm512_setzero_pd(), zero = gap, reach;

#pragma GCC unroll 3
    for (int a = 0; a < dim; a++) {
        __m512d below = _mm512_sub_pd(_mm512_loadu_pd(b->lo[a]), _mm512_set1_pd(q->hi[a]));
        __m512d above = _mm512_sub_pd(_mm512_set1_pd(q->lo[a]), _mm512_loadu_pd(b->hi[a]));
        __m512d d = _mm512_max_pd(_mm512_max_pd(below, above), zero);

        gap = _mm512_fmadd_pd(d, d, gap);
    }
    reach = _mm512_max_pd(_mm512_loadu_pd(b->reach), _mm512_set1_pd(q->reach));
    reach = _mm512_mul_pd(reach, _mm512_set1_pd(1 + MARGIN));
    return (unsigned)_mm512_cmp_pd_mask(gap, _mm512_mul_pd(reach, reach), _CMP_LE_OQ);
}

AVX512 unsigned filter_near_boxes_avx512(const struct box8 *b, const struct query *q, int dim)
{
    if (dim == 3) {
        return near_eight(b, q, 3);
    }
    return dim == 2 ? near_eight(b, q, 2) : near_eight(b, q, 1);
}

/* Eight of one leaf and eight of another. */
AVX512_INLINE __m512 both(const float *p, const float *q)
{
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_load_ps(p)), _mm256_load_ps(q), 1);
}

/* Bit k: a lane sees point k of p; bit 8 + k: of q. */
AVX512_INLINE __mmask16 near_two(const struct packed_leaf *p, const struct packed_leaf *q,
                                 const struct lanes *t, int dim, int uniform)
{
    __m512 any = _mm512_set1_ps(3e38f), own = any, x[3], s = both(p->s, q->s), r2;

#pragma GCC unroll 3
    for (int a = 0; a < dim; a++) {
        x[a] = both(p->x[a], q->x[a]);
    }
#pragma GCC unroll 8
    for (int i = 0; i < LEAF; i++) {
        __m512 d = _mm512_set1_ps(t->a2[i]);

#pragma GCC unroll 3
        for (int a = 0; a < dim; a++) {
            d = _mm512_fmadd_ps(_mm512_set1_ps(t->m2a[a][i]), x[a], d);
        }
        any = _mm512_min_ps(d, any);
        if (!uniform) {
            own = _mm512_min_ps(_mm512_sub_ps(d, _mm512_set1_ps(t->r2[i])), own);
        }
    }
    r2 = both(p->r2, q->r2);
    if (uniform) {
        r2 = _mm512_max_ps(r2, _mm512_set1_ps(t->reach * t->reach));
        return _mm512_cmp_ps_mask(any, _mm512_sub_ps(r2, s), _CMP_LE_OQ);
    }
    return _mm512_cmp_ps_mask(any, _mm512_sub_ps(r2, s), _CMP_LE_OQ) |
           _mm512_cmp_ps_mask(own, _mm512_sub_ps(_mm512_setzero_ps(), s), _CMP_LE_OQ);
}

AVX512_INLINE size_t near_points(const struct packed_leaf *pack, const uint32_t *leaf,
                                 const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                                 int uniform, uint32_t *out)
{
    const __m512i iota = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
    size_t found = 0;

    for (size_t k = 0; k < n; k += 2) {
        uint32_t a = chosen[k], b = chosen[k + 1 < n ? k + 1 : k];
        unsigned mask = near_two(&pack[a], &pack[b], t, dim, uniform);
        __m512i first = _mm512_castsi256_si512(_mm256_set1_epi32((int)(leaf[a] * LEAF)));

        if (k + 1 == n) {
            mask &= 0xff; /* there is no second one */
        }
        first = _mm512_inserti32x8(first, _mm256_set1_epi32((int)(leaf[b] * LEAF)), 1);
        first = _mm512_maskz_compress_epi32((__mmask16)mask, _mm512_add_epi32(first, iota));
        _mm512_storeu_si512(out + found, first);
        found += (size_t)__builtin_popcount(mask);
    }
    return found;
}

AVX512 size_t filter_near_points_avx512(const struct packed_leaf *pack, const uint32_t *leaf,
                                        const uint32_t *chosen, size_t n, const struct lanes *t,
                                        int dim, uint32_t *out)
{
    switch (2 * dim + (t->uniform != 0)) {
    case 2:
        return near_points(pack, leaf, chosen, n, t, 1, 0, out);
    case 3:
        return near_points(pack, leaf, chosen, n, t, 1, 1, out);
    case 4:
        return near_points(pack, leaf, chosen, n, t, 2, 0, out);
    case 5:
        return near_points(pack, leaf, chosen, n, t, 2, 1, out);
    case 6:
        return near_points(pack, leaf, chosen, n, t, 3, 0, out);
    default:
        return near_points(pack, leaf, chosen, n, t, 3, 1, out);
    }
}
#endif
