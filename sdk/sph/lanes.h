/* sph/lanes.h -- the words in which a pair body is written: R (a real in every lane), B (a mask),
 * I (an integer in every lane), and functions on them. Included by each-isa.h once for each
 * instruction set and precision, with SPH_ISA (a suffix), SPH_WIDTH (lanes of a vector) and
 * SPH_F32_WORDS (1: reals are floats) defined; the same words mean OpenCL's on a device.
 *
 *   T s = (T)1.0 - alpha;            one real, such as a parameter is
 *   R a = sph_num(0.1);              a constant in every lane; one that a float holds exactly
 *                                    needs none: 0.5 * a
 *   a + b, a * b, a / b, -a          as ever;  a < b, a >= b ... give a B;  m & n, m | n, ~m
 *   sph_select(m, a, b)              a where m holds, else b
 *   sph_min, sph_max, sph_abs, sph_sqrt, sph_rsqrt (1 / root; 0 of 0), sph_sign(a) (-1, 0, 1)
 *   sph_exp(a), sph_log(a), sph_pow(a, b) (a >= 0)
 *   sph_pow_where(m, a, b)           a^b where m holds, else 1
 *   sph_w(K, q), sph_dw(K, q)        kernel and its derivative in q = r / h, without powers of h
 *   sph_dw_q(K, q)                   the latter over q: for gradients along dx, without 1 / r. Some
 *                                    number at q = 0 (0 or the limit), where dx is 0
 *   sph_grad(K, a, r, hinv)          a h^-(DIM + 2) W'(q) / q at q = r hinv: times dx, a grad W
 *   sph_ipow(a, DIM)                 a small whole power
 * No branches on lanes, no calls to anything else. */

#include <sph/lanes-names.h>

#define T SPH_OF_ISA(sph_real)
#define R SPH_OF_ISA(sph_lanes)
#define B SPH_OF_ISA(sph_mask)
#define M SPH_OF_ISA(sph_lanes_in)
#define FORM SPH_OF_ISA(sph_form)
#define INT SPH_OF_ISA(sph_int)

#if SPH_F32_WORDS
typedef float T;
typedef int INT;
typedef INT B __attribute__((vector_size(4 * SPH_WIDTH), aligned(4)));
#else
typedef double T;
typedef long long INT;
typedef INT B __attribute__((vector_size(8 * SPH_WIDTH), aligned(8)));
#endif
typedef T R __attribute__((vector_size(sizeof(T) * SPH_WIDTH), aligned(sizeof(T))));

SPH_INLINE R SPH_OF_ISA(sph_num_)(T a)
{
    const R zero = {0};
    return zero + a;
}

SPH_INLINE B SPH_OF_ISA(sph_whole_)(INT a)
{
    const B zero = {0};
    return zero + a;
}

SPH_INLINE R SPH_OF_ISA(sph_select_)(B m, R a, R b)
{
#if defined(SPH_AVX512_WORDS) && SPH_F32_WORDS
    return (R)_mm256_mask_blend_ps(_mm256_movepi32_mask((__m256i)m), (__m256)b, (__m256)a);
#elif defined(SPH_AVX512_WORDS)
    return (R)_mm512_mask_blend_pd(_mm512_movepi64_mask((__m512i)m), (__m512d)b, (__m512d)a);
#elif defined(SPH_AVX2_WORDS) && SPH_F32_WORDS
    return (R)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)m);
#elif defined(SPH_AVX2_WORDS)
    return (R)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)m);
#elif defined(SPH_SSE2_WORDS) && SPH_F32_WORDS
    return (R)_mm_or_ps(_mm_and_ps((__m128)m, (__m128)a), _mm_andnot_ps((__m128)m, (__m128)b));
#elif defined(SPH_SSE2_WORDS)
    return (R)_mm_or_pd(_mm_and_pd((__m128d)m, (__m128d)a), _mm_andnot_pd((__m128d)m, (__m128d)b));
#else
    return (R)((m & (B)a) | (~m & (B)b));
#endif
}

SPH_INLINE R SPH_OF_ISA(sph_load_)(const T *p)
{
    return *(const R *)(const void *)p;
}

#if SPH_WIDTH == 8
/* *a in the lower half of the lanes, *b in the upper. */
SPH_INLINE R SPH_OF_ISA(sph_halves_)(const T *a, const T *b)
{
#if defined(SPH_AVX512_WORDS) && SPH_F32_WORDS
    return (R)_mm256_mask_broadcastss_ps(_mm256_broadcast_ss(a), 0xf0, _mm_load_ss(b));
#elif defined(SPH_AVX512_WORDS)
    return (R)_mm512_mask_broadcastsd_pd(_mm512_set1_pd(*a), 0xf0, _mm_load_sd(b));
#else
    return (R)_mm256_blend_ps(_mm256_broadcast_ss(a), _mm256_broadcast_ss(b), 0xf0);
#endif
}

#if SPH_F32_WORDS
SPH_INLINE B SPH_OF_ISA(sph_whole_halves_)(const INT *a, const INT *b)
{
#ifdef SPH_AVX512_WORDS
    return (B)_mm256_mask_broadcastd_epi32(_mm256_set1_epi32(*a), 0xf0, _mm_cvtsi32_si128(*b));
#else
    return (B)_mm256_blend_epi32(_mm256_set1_epi32(*a), _mm256_set1_epi32(*b), 0xf0);
#endif
}
#endif
#endif

#ifdef SPH_FORM_LIST
/* p[k[0]], p[k[1]]: what the loop over lists has in its lanes. */
SPH_INLINE R SPH_OF_ISA(sph_gather_)(const T *p, const uint32_t *k)
{
    const R out = {p[k[0]], p[k[1]]};
    return out;
}
#endif

/* -- What x86-64 has an instruction for that no compiler finds by itself ------------------------ */

#if defined(SPH_SSE2_WORDS) || defined(SPH_AVX2_WORDS) || defined(SPH_AVX512_WORDS)
#if defined(SPH_SSE2_WORDS) && SPH_F32_WORDS
#define SPH_MM(name) (R) _mm_##name##_ps
#define SPH_V(a) ((__m128)(a))
#elif defined(SPH_SSE2_WORDS)
#define SPH_MM(name) (R) _mm_##name##_pd
#define SPH_V(a) ((__m128d)(a))
#elif SPH_F32_WORDS
#define SPH_MM(name) (R) _mm256_##name##_ps
#define SPH_V(a) ((__m256)(a))
#elif SPH_WIDTH == 4
#define SPH_MM(name) (R) _mm256_##name##_pd
#define SPH_V(a) ((__m256d)(a))
#else
#define SPH_MM(name) (R) _mm512_maskz_##name##_pd
#define SPH_V(a) ((__m512d)(a))
#endif
#if defined(SPH_AVX512_WORDS) && !SPH_F32_WORDS
#define SPH_ALL 0xff,
#else
#define SPH_ALL
#endif
/* Of 8 doubles the form with a mask: of the plain one gcc says that it uses what is not set. */
SPH_INLINE R SPH_OF_ISA(sph_max_)(R a, R b)
{
    return SPH_MM(max)(SPH_ALL SPH_V(a), SPH_V(b));
}
SPH_INLINE R SPH_OF_ISA(sph_min_)(R a, R b)
{
    return SPH_MM(min)(SPH_ALL SPH_V(a), SPH_V(b));
}
#else
SPH_INLINE R SPH_OF_ISA(sph_max_)(R a, R b)
{
    return SPH_OF_ISA(sph_select_)((B)(a > b), a, b);
}
SPH_INLINE R SPH_OF_ISA(sph_min_)(R a, R b)
{
    return SPH_OF_ISA(sph_select_)((B)(a < b), a, b);
}
#endif

/* Which lanes take part in a pair, in the form that is cheapest to use: M; without the self pair, or
 * where there can be none (near). Sums are chosen after the addition, so that it and the product
 * before it become one instruction. */
#ifdef SPH_AVX512_WORDS
typedef unsigned char M;
#if SPH_F32_WORDS
SPH_INLINE M SPH_OF_ISA(sph_near_)(R r2, R reach2)
{
    return _mm256_cmp_ps_mask((__m256)r2, (__m256)reach2, _CMP_LT_OQ);
}
SPH_INLINE M SPH_OF_ISA(sph_within_)(R r2, R reach2, B number, B j)
{
    return (M)(SPH_OF_ISA(sph_near_)(r2, reach2) &
               ~_mm256_cmpeq_epi32_mask((__m256i)number, (__m256i)j));
}
SPH_INLINE B SPH_OF_ISA(sph_mask_of_)(M m)
{
    return (B)_mm256_movm_epi32(m);
}
SPH_INLINE R SPH_OF_ISA(sph_where_)(M m, R a, R b)
{
    return (R)_mm256_mask_blend_ps(m, (__m256)b, (__m256)a);
}
#else
SPH_INLINE M SPH_OF_ISA(sph_near_)(R r2, R reach2)
{
    return _mm512_cmp_pd_mask((__m512d)r2, (__m512d)reach2, _CMP_LT_OQ);
}
SPH_INLINE M SPH_OF_ISA(sph_within_)(R r2, R reach2, B number, B j)
{
    return (M)(SPH_OF_ISA(sph_near_)(r2, reach2) &
               ~_mm512_cmpeq_epi64_mask((__m512i)number, (__m512i)j));
}
SPH_INLINE B SPH_OF_ISA(sph_mask_of_)(M m)
{
    return (B)_mm512_movm_epi64(m);
}
SPH_INLINE R SPH_OF_ISA(sph_where_)(M m, R a, R b)
{
    return (R)_mm512_mask_blend_pd(m, (__m512d)b, (__m512d)a);
}
#endif
#else
typedef B M;
SPH_INLINE M SPH_OF_ISA(sph_near_)(R r2, R reach2)
{
    return (B)(r2 < reach2);
}
SPH_INLINE M SPH_OF_ISA(sph_within_)(R r2, R reach2, B number, B j)
{
    return SPH_OF_ISA(sph_near_)(r2, reach2) & ~(B)(number == j);
}
SPH_INLINE B SPH_OF_ISA(sph_mask_of_)(M m)
{
    return m;
}
SPH_INLINE R SPH_OF_ISA(sph_where_)(M m, R a, R b)
{
    return SPH_OF_ISA(sph_select_)(m, a, b);
}
#endif
SPH_INLINE R SPH_OF_ISA(sph_add_where_)(M m, R sum, R a)
{
    return SPH_OF_ISA(sph_where_)(m, sum + a, sum);
}
SPH_INLINE R SPH_OF_ISA(sph_sub_where_)(M m, R sum, R a)
{
    return SPH_OF_ISA(sph_where_)(m, sum - a, sum);
}

/* -- Functions --------------------------------------------------------------------------------- */

#define I B
#define SPH_FN(type, name, arguments) SPH_INLINE type SPH_OF_ISA(name) arguments
#define sph_num(a) SPH_OF_ISA(sph_num_)((T)(a))
#define sph_int(a) SPH_OF_ISA(sph_whole_)((INT)(a))
#define sph_select(m, a, b) SPH_OF_ISA(sph_select_)((B)(m), (a), (b))
#define sph_bits(a) ((I)(a))
#define sph_of_bits(i) ((R)(i))
#include <sph/lanes-math.h>
#include <sph/lanes-rsqrt.h>

/* a^b in the masked lanes, 1 in the others. A call, not inline: it is long. */
static __attribute__((noinline, unused)) R SPH_OF_ISA(sph_pow_where_)(B m, R a, R b)
{
    const R one = sph_num(1.0);
    return sph_select(m, sph_pow(sph_select(m, a, one), b), one);
}

#undef I
#undef SPH_FN
#undef sph_num
#undef sph_int
#undef sph_select
#undef sph_bits
#undef sph_of_bits
#undef sph_exp
#undef sph_log
#undef sph_pow
#undef sph_sqrt
#undef sph_rsqrt

SPH_INLINE R SPH_OF_ISA(sph_ipow_)(R a, uint32_t n)
{
    /* n is at most 15 and the same for every lane: four predictable branches. */
    R out = (n & 1u) ? a : SPH_OF_ISA(sph_num_)((T)1.0);
    a *= a;
    if (n & 2u)
        out *= a;
    a *= a;
    if (n & 4u)
        out *= a;
    a *= a;
    if (n & 8u)
        out *= a;
    return out;
}

/* -- Kernels ----------------------------------------------------------------------------------- */

/* A kernel's form as a loop keeps it: in its own precision, the norm in the coefficients. */
typedef struct FORM {
    const sph_kernel_form *form;
    T support;
    uint32_t n_pieces, en_coef; /* 0: W' / q is no such sum */
    struct {
        T knot;
        uint32_t power, n_coef, dpower, dn_coef;
        T c[SPH_KERNEL_COEFS], d[SPH_KERNEL_COEFS], e[SPH_KERNEL_COEFS]; /* e: of W' / q */
    } piece[SPH_KERNEL_KNOTS];
} FORM;

SPH_INLINE void SPH_OF_ISA(sph_form_)(FORM *out, const sph_kernel_form *form)
{
    out->form = form;
    out->support = (T)form->support;
    out->n_pieces = form->n_pieces;
    out->en_coef = 0;
    for (uint32_t k = 0; k < form->n_pieces; k++) {
        const sph_kernel_piece *p = &form->piece[k];
        out->piece[k].knot = (T)p->knot;
        out->piece[k].power = p->power;
        out->piece[k].n_coef = p->n_coef;
        out->piece[k].dpower = p->dpower;
        out->piece[k].dn_coef = p->dn_coef;
        for (uint32_t n = 0; n < SPH_KERNEL_COEFS; n++) {
            out->piece[k].c[n] = (T)(p->c[n] * form->norm);
            out->piece[k].d[n] = (T)(p->d[n] * form->norm);
        }
    }
    if (form->n_pieces == 1) {
        double e[SPH_KERNEL_COEFS];
        out->en_coef = sph_kernel_over_q(&form->piece[0], e);
        for (uint32_t n = 0; n < out->en_coef; n++)
            out->piece[0].e[n] = (T)(e[n] * form->norm);
    }
}

SPH_INLINE R SPH_OF_ISA(sph_sum_of_powers_)(R t, uint32_t power, uint32_t n, const T *c)
{
    R sum = SPH_OF_ISA(sph_num_)(c[n - 1]);
    for (uint32_t k = n - 1; k-- > 0;)
        sum = sum * t + c[k];
    return sum * SPH_OF_ISA(sph_ipow_)(t, power);
}

/* A kernel's table, lane by lane (slope: 0 or 1): the slow way, for kernels given as functions. */
static __attribute__((noinline, unused)) R SPH_OF_ISA(sph_cubic_)(const sph_kernel_form *kernel,
                                                                  R q, int slope)
{
    R out = q;
    for (int l = 0; l < SPH_WIDTH; l++)
        out[l] = (T)sph_kernel_cubic(kernel, (double)q[l], slope);
    return out;
}

/* shape: SPH_SHAPE_..., a constant where it is called. */
SPH_INLINE R SPH_OF_ISA(sph_w_)(const FORM *f, R q, int shape)
{
    const R zero = {0};
    R sum = zero;
    if (shape == SPH_SHAPE_C2 || shape == SPH_SHAPE_C4) {
        const R t = SPH_OF_ISA(sph_max_)(f->piece[0].knot - q, zero);
        return shape == SPH_SHAPE_C2 ? SPH_OF_ISA(sph_sum_of_powers_)(t, 4, 2, f->piece[0].c)
                                     : SPH_OF_ISA(sph_sum_of_powers_)(t, 6, 3, f->piece[0].c);
    }
    if (__builtin_expect(f->form->n_table != 0, 0))
        return SPH_OF_ISA(sph_cubic_)(f->form, q, 0);
    for (uint32_t k = 0; k < f->n_pieces; k++) {
        const R t = SPH_OF_ISA(sph_max_)(f->piece[k].knot - q, zero);
        sum +=
            SPH_OF_ISA(sph_sum_of_powers_)(t, f->piece[k].power, f->piece[k].n_coef, f->piece[k].c);
    }
    return sum;
}

SPH_INLINE R SPH_OF_ISA(sph_dw_)(const FORM *f, R q, int shape)
{
    const R zero = {0};
    R sum = zero;
    if (shape == SPH_SHAPE_C2 || shape == SPH_SHAPE_C4) {
        const R t = SPH_OF_ISA(sph_max_)(f->piece[0].knot - q, zero);
        return shape == SPH_SHAPE_C2 ? SPH_OF_ISA(sph_sum_of_powers_)(t, 3, 2, f->piece[0].d)
                                     : SPH_OF_ISA(sph_sum_of_powers_)(t, 5, 3, f->piece[0].d);
    }
    if (__builtin_expect(f->form->n_table != 0, 0))
        return SPH_OF_ISA(sph_cubic_)(f->form, q, 1);
    for (uint32_t k = 0; k < f->n_pieces; k++) {
        const R t = SPH_OF_ISA(sph_max_)(f->piece[k].knot - q, zero);
        const R d = SPH_OF_ISA(sph_sum_of_powers_)(t, f->piece[k].dpower, f->piece[k].dn_coef,
                                                   f->piece[k].d);
        /* A derivative of power 0 does not vanish by itself past its knot. */
        sum += f->piece[k].dpower
                   ? d
                   : SPH_OF_ISA(sph_select_)((B)(f->piece[k].knot - q > zero), d, zero);
    }
    return sum;
}

SPH_INLINE R SPH_OF_ISA(sph_dw_q_)(const FORM *f, R q, int shape)
{
    const R zero = {0};
    if (shape == SPH_SHAPE_C2 || shape == SPH_SHAPE_C4 || f->en_coef) {
        const R t = SPH_OF_ISA(sph_max_)(f->piece[0].knot - q, zero);
        return shape == SPH_SHAPE_C2   ? SPH_OF_ISA(sph_sum_of_powers_)(t, 3, 1, f->piece[0].e)
               : shape == SPH_SHAPE_C4 ? SPH_OF_ISA(sph_sum_of_powers_)(t, 5, 2, f->piece[0].e)
                                       : SPH_OF_ISA(sph_sum_of_powers_)(t, f->piece[0].dpower,
                                                                        f->en_coef, f->piece[0].e);
    }
    return SPH_OF_ISA(sph_select_)((B)(q > zero), SPH_OF_ISA(sph_dw_)(f, q, shape) / q, zero);
}

/* The weight meets the powers of h first: neither waits for r. */
SPH_INLINE R SPH_OF_ISA(sph_grad_)(const FORM *f, R weight, R r, R hinv, uint32_t dim, int shape)
{
    const R scale = SPH_OF_ISA(sph_ipow_)(hinv, dim + 2);
    if (shape == SPH_SHAPE_C2) {
        const R zero = {0}, t = SPH_OF_ISA(sph_max_)(f->piece[0].knot - r * hinv, zero);
        return t * t * t * (weight * (scale * f->piece[0].e[0]));
    }
    return SPH_OF_ISA(sph_dw_q_)(f, r * hinv, shape) * (weight * scale);
}

#undef SPH_MM
#undef SPH_V
#undef SPH_ALL
#undef T
#undef R
#undef B
#undef M
#undef FORM
#undef INT
