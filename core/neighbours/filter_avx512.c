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

/* Half of the lanes: what is nearest of them to each point, and what reaches furthest beyond it. */
struct nearest {
    __m512 any, own;
};

AVX512_INLINE struct nearest nearest_of(const __m512 *x, const struct lanes *t, int first, int dim,
                                        int uniform)
{
    struct nearest out = {_mm512_set1_ps(3e38f), _mm512_set1_ps(3e38f)};

#pragma GCC unroll 4
    for (int i = first; i < first + 4; i++) {
        __m512 d = _mm512_set1_ps(t->a2[i]);

#pragma GCC unroll 3
        for (int a = 0; a < dim; a++) {
            d = _mm512_fmadd_ps(_mm512_set1_ps(t->m2a[a][i]), x[a], d);
        }
        out.any = _mm512_min_ps(d, out.any);
        if (!uniform) {
            out.own = _mm512_min_ps(_mm512_sub_ps(d, _mm512_set1_ps(t->r2[i])), out.own);
        }
    }
    return out;
}

/* most: what `any` may be at most, r2 - s; least: what `own` may be, -s. */
AVX512_INLINE unsigned sees(struct nearest n, __m512 most, __m512 least, int uniform)
{
    unsigned mask = _mm512_cmp_ps_mask(n.any, most, _CMP_LE_OQ);

    return uniform ? mask : mask | _mm512_cmp_ps_mask(n.own, least, _CMP_LE_OQ);
}

AVX512_INLINE uint32_t *append(uint32_t *out, __m512i index, unsigned mask)
{
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32((__mmask16)mask, index));
    return out + __builtin_popcount(mask);
}

AVX512_INLINE void near_points(const struct packed_leaf *pack, const uint32_t *leaf,
                               const uint32_t *chosen, size_t n, const struct lanes *t, int dim,
                               int uniform, uint32_t own, struct found *out)
{
    const __m512i iota = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
    uint32_t *common = out->source[BY_BOTH] + out->n[BY_BOTH];
    uint32_t *lower = out->source[BY_LOWER] + out->n[BY_LOWER];
    uint32_t *upper = out->source[BY_UPPER] + out->n[BY_UPPER];

    for (size_t k = 0; k < n; k += 2) {
        uint32_t a = chosen[k], b = chosen[k + 1 < n ? k + 1 : k];
        const struct packed_leaf *p = &pack[a], *q = &pack[b];
        unsigned all = k + 1 < n ? 0xffff : 0xff, low, high, both_see; /* is there a second one? */
        __m512 x[3], s = both(p->s, q->s), r2 = both(p->r2, q->r2);
        __m512 least = _mm512_sub_ps(_mm512_setzero_ps(), s);
        __m512i index = _mm512_castsi256_si512(_mm256_set1_epi32((int)(leaf[a] * LEAF)));

        index = _mm512_inserti32x8(index, _mm256_set1_epi32((int)(leaf[b] * LEAF)), 1);
        index = _mm512_add_epi32(index, iota);
        if (uniform) {
            r2 = _mm512_max_ps(r2, _mm512_set1_ps(t->reach * t->reach));
        }
        r2 = _mm512_sub_ps(r2, s);
#pragma GCC unroll 3
        for (int c = 0; c < dim; c++) {
            x[c] = both(p->x[c], q->x[c]);
        }
        low = all & sees(nearest_of(x, t, 0, dim, uniform), r2, least, uniform);
        high = all & sees(nearest_of(x, t, 4, dim, uniform), r2, least, uniform);
        both_see = low & high;
        if (leaf[a] == own || leaf[b] == own) {
            both_see |= (low | high) & (leaf[a] == own ? 0xff : 0xff00);
        }
        common = append(common, index, both_see);
        lower = append(lower, index, low & ~both_see);
        upper = append(upper, index, high & ~both_see);
    }
    out->n[BY_BOTH] = (size_t)(common - out->source[BY_BOTH]);
    out->n[BY_LOWER] = (size_t)(lower - out->source[BY_LOWER]);
    out->n[BY_UPPER] = (size_t)(upper - out->source[BY_UPPER]);
}

AVX512 void filter_near_points_avx512(const struct packed_leaf *pack, const uint32_t *leaf,
                                      const uint32_t *chosen, size_t n, const struct lanes *t,
                                      int dim, uint32_t own, struct found *out)
{
    switch (2 * dim + (t->uniform != 0)) {
    case 2:
        near_points(pack, leaf, chosen, n, t, 1, 0, own, out);
        break;
    case 3:
        near_points(pack, leaf, chosen, n, t, 1, 1, own, out);
        break;
    case 4:
        near_points(pack, leaf, chosen, n, t, 2, 0, own, out);
        break;
    case 5:
        near_points(pack, leaf, chosen, n, t, 2, 1, own, out);
        break;
    case 6:
        near_points(pack, leaf, chosen, n, t, 3, 0, own, out);
        break;
    default:
        near_points(pack, leaf, chosen, n, t, 3, 1, own, out);
    }
}
#endif
