/* sph/lanes-scalar.h -- the words of lanes.h for one number at a time, with libm's functions: what the
 * reference loop (pair-reference.h) and the loops over points (point-loop.h) are made of. Included with
 * SPH_ISA (one_f64 or one_f80) and SPH_REAL (double or long double) defined. Truth is bit 0 of a mask, as
 * on a device. */

#include <sph/lanes-names.h>

#define R SPH_OF_ISA(sph_lanes)
#define B SPH_OF_ISA(sph_mask)
#define FORM SPH_OF_ISA(sph_form)

typedef SPH_REAL SPH_OF_ISA(sph_real);
typedef SPH_REAL R;
typedef int B;
typedef long long SPH_OF_ISA(sph_int);

SPH_INLINE R SPH_OF_ISA(sph_num_)(R a)
{
    return a;
}

SPH_INLINE R SPH_OF_ISA(sph_select_)(B m, R a, R b)
{
    return m & 1 ? a : b;
}

SPH_INLINE R SPH_OF_ISA(sph_max_)(R a, R b)
{
    return a > b ? a : b;
}

SPH_INLINE R SPH_OF_ISA(sph_min_)(R a, R b)
{
    return a < b ? a : b;
}

SPH_INLINE R SPH_OF_ISA(sph_add_where_)(B m, R sum, R a)
{
    return m & 1 ? sum + a : sum;
}

SPH_INLINE R SPH_OF_ISA(sph_sub_where_)(B m, R sum, R a)
{
    return m & 1 ? sum - a : sum;
}

SPH_INLINE R SPH_OF_ISA(sph_sqrt_)(R a)
{
    return sizeof(R) > 8 ? (R)__builtin_sqrtl(a) : (R)__builtin_sqrt((double)a);
}

SPH_INLINE R SPH_OF_ISA(sph_rsqrt_)(R a)
{
    return a > (R)0.0 ? (R)1.0 / SPH_OF_ISA(sph_sqrt_)(a) : (R)0.0;
}

SPH_INLINE R SPH_OF_ISA(sph_exp_)(R a)
{
    return sizeof(R) > 8 ? (R)__builtin_expl(a) : (R)__builtin_exp((double)a);
}

SPH_INLINE R SPH_OF_ISA(sph_log_)(R a)
{
    return sizeof(R) > 8 ? (R)__builtin_logl(a) : (R)__builtin_log((double)a);
}

SPH_INLINE R SPH_OF_ISA(sph_pow_)(R a, R b)
{
    return sizeof(R) > 8 ? (R)__builtin_powl(a, b) : (R)__builtin_pow((double)a, (double)b);
}

SPH_INLINE R SPH_OF_ISA(sph_pow_where_)(B m, R a, R b)
{
    return m & 1 ? SPH_OF_ISA(sph_pow_)(a, b) : (R)1.0;
}

SPH_INLINE R SPH_OF_ISA(sph_ipow_)(R a, uint32_t n)
{
    R out = (R)1.0;
    while (n-- > 0)
        out *= a;
    return out;
}

typedef struct FORM {
    const sph_kernel_form *form;
    R support;
} FORM;

SPH_INLINE void SPH_OF_ISA(sph_form_)(FORM *out, const sph_kernel_form *form)
{
    out->form = form;
    out->support = (R)form->support;
}

/* As sph_kernel_sum (kernel-value.h), in this precision. */
SPH_INLINE R SPH_OF_ISA(sph_kernel_)(const sph_kernel_form *form, R q, int slope)
{
    R sum = (R)0.0;
    if (form->n_table)
        return (R)sph_kernel_cubic(form, (double)q, slope);
    for (uint32_t k = 0; k < form->n_pieces; k++) {
        const sph_kernel_piece *p = &form->piece[k];
        const R t = (R)p->knot - q;
        R value = (R)0.0;
        if (!(t > (R)0.0))
            continue;
        for (uint32_t n = slope ? p->dn_coef : p->n_coef; n-- > 0;)
            value = value * t + (R)(slope ? p->d[n] : p->c[n]);
        sum += value * SPH_OF_ISA(sph_ipow_)(t, slope ? p->dpower : p->power);
    }
    return sum * (R)form->norm;
}

SPH_INLINE R SPH_OF_ISA(sph_w_)(const FORM *f, R q, int shape)
{
    (void)shape;
    return SPH_OF_ISA(sph_kernel_)(f->form, q, 0);
}

SPH_INLINE R SPH_OF_ISA(sph_dw_)(const FORM *f, R q, int shape)
{
    (void)shape;
    return SPH_OF_ISA(sph_kernel_)(f->form, q, 1);
}

SPH_INLINE R SPH_OF_ISA(sph_dw_q_)(const FORM *f, R q, int shape)
{
    return q > (R)0.0 ? SPH_OF_ISA(sph_dw_)(f, q, shape) / q : (R)0.0;
}

SPH_INLINE R SPH_OF_ISA(sph_grad_)(const FORM *f, R weight, R r, R hinv, uint32_t dim, int shape)
{
    return weight * SPH_OF_ISA(sph_ipow_)(hinv, dim + 2) *
           SPH_OF_ISA(sph_dw_q_)(f, r * hinv, shape);
}

#undef R
#undef B
#undef FORM
