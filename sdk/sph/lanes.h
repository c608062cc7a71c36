/* sph/lanes.h -- the words in which a pair body is written: R (a real in every lane), B (a mask),
 * and functions on them. Included by pair-loop.h once for each instruction set, with SPH_ISA (a
 * suffix) and SPH_WIDTH (lanes of a vector) defined; the same words mean OpenCL vectors on a
 * device.
 *
 *   R a = sph_num(0.5);              a constant in every lane (a * 0.5 needs none)
 *   a + b, a * b, a / b, -a          as ever;  a < b, a >= b ... give a B;  m & n, m | n, ~m
 *   sph_select(m, a, b)              a where m holds, else b
 *   sph_min, sph_max, sph_abs, sph_sqrt, sph_sign(a) (-1, 0, 1)
 *   sph_pow_where(m, a, b)           a^b where m holds, else 1: each lane that needs it costs
 *   sph_w(K, q), sph_dw(K, q)        kernel and its derivative in q = r / h, without powers of h
 *   sph_ipow(a, DIM)                 a small whole power
 * No branches on lanes, no calls to anything else. */

#define SPH_CAT2(a, b) a##_##b
#define SPH_CAT(a, b) SPH_CAT2(a, b)
#define SPH_OF_ISA(name) SPH_CAT(name, SPH_ISA)
#define SPH_INLINE static inline __attribute__((always_inline, unused))

#define R SPH_OF_ISA(sph_lanes)
#define B SPH_OF_ISA(sph_mask)

typedef double R __attribute__((vector_size(8 * SPH_WIDTH), aligned(8)));
typedef long long B __attribute__((vector_size(8 * SPH_WIDTH), aligned(8)));

SPH_INLINE R SPH_OF_ISA(sph_num_)(double a)
{
    const R zero = {0};
    return zero + a;
}

SPH_INLINE R SPH_OF_ISA(sph_select_)(B m, R a, R b)
{
    return (R)((m & (B)a) | (~m & (B)b));
}

SPH_INLINE R SPH_OF_ISA(sph_load_)(const double *p)
{
    return *(const R *)(const void *)p;
}

SPH_INLINE R SPH_OF_ISA(sph_sqrt_)(R a)
{
    R out = a;
    for (int l = 0; l < SPH_WIDTH; l++)
        out[l] = __builtin_sqrt(a[l]);
    return out;
}

/* libm lane by lane: right to its own rounding, and slow; for bodies that cannot do without. */
SPH_INLINE R SPH_OF_ISA(sph_pow_where_)(B m, R a, R b)
{
    R out = SPH_OF_ISA(sph_num_)(1.0);
    for (int l = 0; l < SPH_WIDTH; l++)
        if (m[l])
            out[l] = __builtin_pow(a[l], b[l]);
    return out;
}

SPH_INLINE R SPH_OF_ISA(sph_ipow_)(R a, uint32_t n)
{
    /* n is at most 15 and the same for every lane: four predictable branches. */
    R out = (n & 1u) ? a : SPH_OF_ISA(sph_num_)(1.0);
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

SPH_INLINE R SPH_OF_ISA(sph_sum_of_powers_)(R t, uint32_t power, uint32_t n, const double *c)
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
        out[l] = sph_kernel_cubic(kernel, q[l], slope);
    return out;
}

SPH_INLINE R SPH_OF_ISA(sph_w_)(const sph_kernel_form *kernel, R q)
{
    const R zero = {0};
    R sum = zero;
    if (__builtin_expect(kernel->n_table != 0, 0))
        return SPH_OF_ISA(sph_cubic_)(kernel, q, 0);
    for (uint32_t k = 0; k < kernel->n_pieces; k++) {
        const sph_kernel_piece *p = &kernel->piece[k];
        R t = p->knot - q;
        t = SPH_OF_ISA(sph_select_)((B)(t > zero), t, zero);
        sum += SPH_OF_ISA(sph_sum_of_powers_)(t, p->power, p->n_coef, p->c);
    }
    return sum * kernel->norm;
}

SPH_INLINE R SPH_OF_ISA(sph_dw_)(const sph_kernel_form *kernel, R q)
{
    const R zero = {0};
    R sum = zero;
    if (__builtin_expect(kernel->n_table != 0, 0))
        return SPH_OF_ISA(sph_cubic_)(kernel, q, 1);
    for (uint32_t k = 0; k < kernel->n_pieces; k++) {
        const sph_kernel_piece *p = &kernel->piece[k];
        R t = p->knot - q;
        B in = (B)(t > zero);
        t = SPH_OF_ISA(sph_select_)(in, t, zero);
        R d = SPH_OF_ISA(sph_sum_of_powers_)(t, p->dpower, p->dn_coef, p->d);
        /* A derivative of power 0 does not vanish by itself past its knot. */
        sum += SPH_OF_ISA(sph_select_)(in, d, zero);
    }
    return sum * kernel->norm;
}

#undef R
#undef B
