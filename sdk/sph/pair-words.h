/* sph/pair-words.h -- switches the words of a pair body on for the loops of one instruction set, or
 * off again if they are on; the inside of pair-dims.h and of pair-reference.h. */
#ifndef SPH_WORDS_ON
#define SPH_WORDS_ON
#define T SPH_OF_ISA(sph_real)
#define R SPH_OF_ISA(sph_lanes)
#define B SPH_OF_ISA(sph_mask)
#define FORM SPH_OF_ISA(sph_form)
#define SPH_INT SPH_OF_ISA(sph_int)
#define SPH_ROOTS(r2) const R r = sph_sqrt(r2), rinv = sph_rsqrt(r2)
#define sph_num(a) SPH_OF_ISA(sph_num_)((T)(a))
#define sph_select(m, a, b) SPH_OF_ISA(sph_select_)((B)(m), (a), (b))
#define sph_max(a, b) SPH_OF_ISA(sph_max_)((a), (b))
#define sph_min(a, b) SPH_OF_ISA(sph_min_)((a), (b))
#define sph_abs(a) sph_max((a), -(a))
#define sph_sign(a)                                                                                \
    (sph_select((a) > sph_num(0.0), sph_num(1.0), sph_num(0.0)) -                                  \
     sph_select((a) < sph_num(0.0), sph_num(1.0), sph_num(0.0)))
#define sph_sqrt(a) SPH_OF_ISA(sph_sqrt_)(a)
#define sph_rsqrt(a) SPH_OF_ISA(sph_rsqrt_)(a)
#define sph_exp(a) SPH_OF_ISA(sph_exp_)(a)
#define sph_log(a) SPH_OF_ISA(sph_log_)(a)
#define sph_pow(a, b) SPH_OF_ISA(sph_pow_)((a), (b))
#define sph_pow_where(m, a, b) SPH_OF_ISA(sph_pow_where_)((B)(m), (a), (b))
#define sph_ipow(a, n) SPH_OF_ISA(sph_ipow_)((a), (n))
/* The shapes 3 and 4 are 1 and 2 with one smoothing length for all. */
#define SPH_UNIFORM (SPH_SHAPE > 2)
#define SPH_KERNEL_SHAPE (SPH_UNIFORM ? SPH_SHAPE - 2 : SPH_SHAPE)
#define sph_w(kernel, q) SPH_OF_ISA(sph_w_)((kernel), (q), SPH_KERNEL_SHAPE)
#define sph_dw(kernel, q) SPH_OF_ISA(sph_dw_)((kernel), (q), SPH_KERNEL_SHAPE)
#define sph_dw_q(kernel, q) SPH_OF_ISA(sph_dw_q_)((kernel), (q), SPH_KERNEL_SHAPE)
#define sph_grad(kernel, weight, r, hinv)                                                          \
    SPH_OF_ISA(sph_grad_)((kernel), (weight), (r), (hinv), DIM, SPH_KERNEL_SHAPE)
#define sph_add(acc, value) ((acc) = SPH_OF_ISA(sph_add_where_)(sph_within, (acc), (value)))
#define sph_sub(acc, value) ((acc) = SPH_OF_ISA(sph_sub_where_)(sph_within, (acc), (value)))
#define sph_take_min(acc, value) ((acc) = sph_min(sph_select(in, (value), (acc)), (acc)))
#define sph_take_max(acc, value) ((acc) = sph_max(sph_select(in, (value), (acc)), (acc)))
#else
#undef SPH_WORDS_ON
#undef T
#undef R
#undef B
#undef FORM
#undef SPH_INT
#undef SPH_ROOTS
#undef sph_num
#undef sph_select
#undef sph_max
#undef sph_min
#undef sph_abs
#undef sph_sign
#undef sph_sqrt
#undef sph_rsqrt
#undef sph_exp
#undef sph_log
#undef sph_pow
#undef sph_pow_where
#undef sph_ipow
#undef sph_w
#undef sph_dw
#undef sph_dw_q
#undef SPH_UNIFORM
#undef SPH_KERNEL_SHAPE
#undef sph_grad
#undef sph_add
#undef sph_sub
#undef sph_take_min
#undef sph_take_max
#endif
