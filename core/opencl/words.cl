/* opencl/words.cl -- the words of sph/lanes.h in OpenCL C, for one set of lanes: SPH_ISA (a suffix), SPH_WIDTH
 * (lanes of R: 8 or 1) and SPH_F32_WORDS (1: reals are floats) are defined by whoever puts this text into a
 * program, once for each set. Behind it sph/lanes-math.h and words_end.cl. What a word means follows SPH_ISA
 * as it is where the word is used. In the same order of operations as the native words. */
#ifndef SPH_WORDS
#define SPH_WORDS
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#if defined(__clang__) && __clang_major__ >= 12
#pragma clang fp contract(fast)
#endif
#define SPH_UNROLLED _Pragma("unroll")
typedef uint uint32_t;
typedef ulong uint64_t;
typedef int int32_t;
typedef long int64_t;
typedef struct {
    double time, dt;
    ulong step;
    uint dim;
} sph_moment;

#define SPH_CAT2(a, b) a##_##b
#define SPH_CAT(a, b) SPH_CAT2(a, b)
#define SPH_OF_ISA(name) SPH_CAT(name, SPH_ISA)
#define SPH_FN(type, name, arguments) static type SPH_OF_ISA(name) arguments

#define T SPH_OF_ISA(sph_real)
#define R SPH_OF_ISA(sph_lanes)
#define B SPH_OF_ISA(sph_mask)
#define SPH_INT SPH_OF_ISA(sph_int)
#define SPH_FORM SPH_OF_ISA(sph_form)
#define sph_num(a) ((R)(T)(a))
#define sph_select(m, a, b) SPH_OF_ISA(sph_select_)((B)(m), (a), (b))
#define sph_max(a, b) SPH_OF_ISA(sph_max_)((a), (b))
#define sph_min(a, b) SPH_OF_ISA(sph_min_)((a), (b))
#define sph_abs(a) SPH_OF_ISA(sph_abs_)(a)
#define sph_sign(a) SPH_OF_ISA(sph_sign_)(a)
#define sph_sqrt(a) SPH_OF_ISA(sph_sqrt_)(a)
#define sph_rsqrt(a) SPH_OF_ISA(sph_rsqrt_)(a)
#define sph_pow_where(m, a, b) SPH_OF_ISA(sph_pow_where_)((B)(m), (a), (b))
#define sph_ipow(a, n) SPH_OF_ISA(sph_ipow_)((a), (n))
#define sph_w(kernel, q) SPH_OF_ISA(sph_w_)((kernel), (q))
#define sph_dw(kernel, q) SPH_OF_ISA(sph_dw_)((kernel), (q))
#define sph_dw_q(kernel, q) SPH_OF_ISA(sph_dw_q_)((kernel), (q))
#define sph_grad(kernel, weight, r, hinv)                                                          \
    SPH_OF_ISA(sph_grad_)((kernel), (weight), (r), (hinv))
/* What a body computes out of reach, a NaN too, goes nowhere. SPH_ADDED, SPH_TAKEN: see pair_source.h. */
#define SPH_ADDED(value) (value)
#define SPH_TAKEN(value) (value)
#define sph_add(acc, value) ((acc) = sph_select(in, (acc) + SPH_ADDED(value), (acc)))
#define sph_sub(acc, value) ((acc) = sph_select(in, (acc) - SPH_TAKEN(value), (acc)))
#define sph_take_min(acc, value) ((acc) = sph_min(sph_select(in, (value), (acc)), (acc)))
#define sph_take_max(acc, value) ((acc) = sph_max(sph_select(in, (value), (acc)), (acc)))
#endif

#if SPH_F32_WORDS
typedef float T;
typedef int SPH_INT;
#define SPH_LEAST 1.17549435e-38
#else
typedef double T;
typedef long SPH_INT;
#define SPH_LEAST 2.2250738585072014e-308
#endif
#if SPH_WIDTH == 1
typedef T R;
typedef int B;
#define SPH_HOLDS(m) ((m) & 1)
#define I SPH_INT
#elif SPH_F32_WORDS
typedef float8 R;
typedef int8 B;
#define SPH_HOLDS(m) (m)
#define I B
#else
typedef double8 R;
typedef long8 B;
#define SPH_HOLDS(m) (m)
#define I B
#endif
/* What a body knows as K: all else of the kernel is in the functions. */
typedef struct {
    T support;
    __global const double *table;
} SPH_FORM;

SPH_FN(R, sph_select_, (B m, R a, R b))
{
    return SPH_HOLDS(m) ? a : b;
}
SPH_FN(R, sph_max_, (R a, R b))
{
    return a > b ? a : b;
}
SPH_FN(R, sph_min_, (R a, R b))
{
    return a < b ? a : b;
}
SPH_FN(R, sph_abs_, (R a))
{
    return fabs(a);
}
SPH_FN(R, sph_sign_, (R a))
{
    const R zero = sph_num(0.0), one = sph_num(1.0);
    return (a > zero ? one : zero) - (a < zero ? one : zero);
}
SPH_FN(R, sph_sqrt_, (R a))
{
    return sqrt(a);
}

/* As sph/lanes-rsqrt.h: the processor's estimate and a step, where the compiler lets us at it. */
#ifdef __has_builtin
#if SPH_WIDTH == 8 && SPH_F32_WORDS && defined(__AVX__)
#if __has_builtin(__builtin_ia32_rsqrtps256)
#define SPH_ESTIMATE __builtin_ia32_rsqrtps256(from.plain)
typedef float sph_plain_f32 __attribute__((vector_size(32)));
#define SPH_PLAIN sph_plain_f32
#endif
#elif SPH_WIDTH == 8 && !SPH_F32_WORDS && defined(__AVX512F__)
#if __has_builtin(__builtin_ia32_rsqrt14pd512_mask)
#define SPH_ESTIMATE __builtin_ia32_rsqrt14pd512_mask(from.plain, from.plain, (uchar)0xff)
typedef double sph_plain_f64 __attribute__((vector_size(64)));
#define SPH_PLAIN sph_plain_f64
#endif
#endif
#endif
SPH_FN(R, sph_rsqrt_, (R a))
{
#ifdef SPH_ESTIMATE
    union {
        R lanes;
        SPH_PLAIN plain;
    } from, to;
    from.lanes = a;
    to.plain = SPH_ESTIMATE;
    const R y = a < sph_num(SPH_LEAST) ? sph_num(0.0) : to.lanes;
    const R e = sph_num(1.0) - (a * y) * y;
#if SPH_F32_WORDS
    return y + (y * e) * (e * sph_num(0.375) + sph_num(0.5));
#else
    R p = e * sph_num(0.2734375) + sph_num(0.3125);
    p = p * e + sph_num(0.375);
    p = p * e + sph_num(0.5);
    return y + (y * e) * p;
#endif
#else
    return a < sph_num(SPH_LEAST) ? sph_num(0.0) : sph_num(1.0) / sqrt(a);
#endif
}
#undef SPH_ESTIMATE
#undef SPH_PLAIN
#undef SPH_LEAST

/* n is at most 15, and known where it is called. */
SPH_FN(R, sph_ipow_, (R a, uint n))
{
    R out = n & 1u ? a : sph_num(1.0);
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

/* A kernel's table at one place (sph_kernel_cubic in sph/kernel-value.h); slope: 0 or 1. */
SPH_FN(T, sph_cell_,
       (__global const double *table, T at, double support, double cells, uint n, double norm,
        int slope))
{
    const double q = at;
    if (!(q >= 0.0 && q < support))
        return (T)0.0;
    const double cell = q * cells;
    const uint k = cell < n - 1u ? (uint)cell : n - 1u;
    __global const double *p = table + 2 * (ulong)k;
    const double t = cell - k;
    const double c2 = 3.0 * (p[2] - p[0]) - 2.0 * p[1] - p[3];
    const double c3 = p[1] + p[3] - 2.0 * (p[2] - p[0]);
    return (T)(norm * (slope ? cells * (p[1] + t * (2.0 * c2 + 3.0 * c3 * t))
                             : p[0] + t * (p[1] + t * (c2 + c3 * t))));
}
#if SPH_WIDTH == 1
#define SPH_CELLS(q, ...) SPH_OF_ISA(sph_cell_)(K->table, (q), __VA_ARGS__)
#else
#define SPH_CELLS(q, ...)                                                                          \
    (R)(SPH_OF_ISA(sph_cell_)(K->table, (q).s0, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s1, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s2, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s3, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s4, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s5, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s6, __VA_ARGS__),                                      \
        SPH_OF_ISA(sph_cell_)(K->table, (q).s7, __VA_ARGS__))
#endif

/* -- Columns -------- */

#if SPH_WIDTH == 1
#define SPH_WHOLE int
#define SPH_D double
#define SPH_LOAD(p) (*(p))
#define SPH_STORE(a, p) (*(p) = (a))
#define SPH_REAL_OF(a) ((T)(a))
#define SPH_D_OF(a) ((double)(a))
#else
#define SPH_WHOLE int8
#define SPH_D double8
#define SPH_LOAD(p) vload8(0, (p))
#define SPH_STORE(a, p) vstore8((a), 0, (p))
#if SPH_F32_WORDS
#define SPH_REAL_OF(a) convert_float8(a)
#else
#define SPH_REAL_OF(a) convert_double8(a)
#endif
#define SPH_D_OF(a) convert_double8(a)
#endif

typedef SPH_WHOLE SPH_OF_ISA(sph_places);

/* What a destination has, and what is made of it: doubles; lanes from `lanes` on are no particles. */
SPH_FN(R, sph_load_, (__global const double *p))
{
    return SPH_REAL_OF(SPH_LOAD(p));
}
SPH_FN(void, sph_store_, (__global double *p, SPH_D a, uint lanes))
{
#if SPH_WIDTH > 1
    if (lanes < SPH_WIDTH) {
        double each[SPH_WIDTH];
        SPH_STORE(a, each);
        for (uint l = 0; l < lanes; l++)
            p[l] = each[l];
        return;
    }
#endif
    SPH_STORE(a, p);
}
SPH_FN(void, sph_sum_, (__global double *p, R a, uint lanes))
{
    SPH_OF_ISA(sph_store_)(p, SPH_LOAD(p) + SPH_D_OF(a), lanes);
}
SPH_FN(void, sph_least_, (__global double *p, R a, uint lanes))
{
    const SPH_D old = SPH_LOAD(p), new = SPH_D_OF(a);
    SPH_OF_ISA(sph_store_)(p, new < old || new != new ? new : old, lanes);
}
SPH_FN(void, sph_most_, (__global double *p, R a, uint lanes))
{
    const SPH_D old = SPH_LOAD(p), new = SPH_D_OF(a);
    SPH_OF_ISA(sph_store_)(p, new > old || new != new ? new : old, lanes);
}

/* What sources have: a for all lanes; a for the lower half of them, b for the upper. */
SPH_FN(R, sph_halves_, (T a, T b))
{
#if SPH_WIDTH == 1
    return a;
#elif defined(__clang__)
    return __builtin_shufflevector((R)a, (R)b, 0, 1, 2, 3, 12, 13, 14, 15);
#else
    return (R)(a, a, a, a, b, b, b, b);
#endif
}
SPH_FN(SPH_WHOLE, sph_whole_halves_, (int a, int b))
{
#if SPH_WIDTH == 1
    return a;
#elif defined(__clang__)
    return __builtin_shufflevector((int8)a, (int8)b, 0, 1, 2, 3, 12, 13, 14, 15);
#else
    return (int8)(a, a, a, a, b, b, b, b);
#endif
}
/* Positions of sweeps in floats are whole numbers of a quantum: their differences are exact. */
SPH_FN(SPH_WHOLE, sph_places_, (__global const int *p))
{
    return SPH_LOAD(p);
}
SPH_FN(R, sph_apart_, (SPH_WHOLE a, SPH_WHOLE b, T quantum))
{
    return SPH_REAL_OF(a - b) * quantum;
}
/* Who the destinations are from i on. */
SPH_FN(B, sph_numbers_, (uint i))
{
#if SPH_WIDTH == 1
    return (int)i;
#else
    return (B)(SPH_INT)i + (B)(0, 1, 2, 3, 4, 5, 6, 7);
#endif
}
SPH_FN(B, sph_near_, (R r2, R reach2))
{
    return r2 < reach2;
}
SPH_FN(B, sph_others_, (B number, uint j))
{
    return number != (B)(SPH_INT)j;
}
#define sph_load(p) SPH_OF_ISA(sph_load_)(p)
#define sph_sum(p, a, lanes) SPH_OF_ISA(sph_sum_)((p), (a), (lanes))
#define sph_least(p, a, lanes) SPH_OF_ISA(sph_least_)((p), (a), (lanes))
#define sph_most(p, a, lanes) SPH_OF_ISA(sph_most_)((p), (a), (lanes))
#define sph_halves(a, b) SPH_OF_ISA(sph_halves_)((T)(a), (T)(b))
#define sph_whole_halves(a, b) SPH_OF_ISA(sph_whole_halves_)((a), (b))
#define sph_places(p) SPH_OF_ISA(sph_places_)(p)
#define sph_apart(a, b, quantum) SPH_OF_ISA(sph_apart_)((a), (b), (quantum))
#define sph_numbers(i) SPH_OF_ISA(sph_numbers_)(i)
#define sph_near(r2, reach2) SPH_OF_ISA(sph_near_)((r2), (reach2))
#define sph_others(number, j) SPH_OF_ISA(sph_others_)((number), (j))
#undef SPH_WHOLE
#undef SPH_D
#undef SPH_LOAD
#undef SPH_STORE
#undef SPH_REAL_OF
#undef SPH_D_OF

/* For sph/lanes-math.h. */
#define sph_int(a) ((I)(SPH_INT)(a))
#if SPH_WIDTH == 1 && SPH_F32_WORDS
#define sph_bits(a) as_int(a)
#define sph_of_bits(i) as_float(i)
#elif SPH_WIDTH == 1
#define sph_bits(a) as_long(a)
#define sph_of_bits(i) as_double(i)
#elif SPH_F32_WORDS
#define sph_bits(a) as_int8(a)
#define sph_of_bits(i) as_float8(i)
#else
#define sph_bits(a) as_long8(a)
#define sph_of_bits(i) as_double8(i)
#endif
