/* sph/pair-dims.h -- one instruction set's loops of a sweep, for each dimension; the inside of
 * pair-loop.h, with its words for the body switched on here and off again below. */

#define R SPH_OF_ISA(sph_lanes)
#define B SPH_OF_ISA(sph_mask)
#define sph_num(a) SPH_OF_ISA(sph_num_)(a)
#define sph_select(m, a, b) SPH_OF_ISA(sph_select_)((B)(m), (a), (b))
#define sph_max(a, b) SPH_OF_ISA(sph_select_)((B)((a) > (b)), (a), (b))
#define sph_min(a, b) SPH_OF_ISA(sph_select_)((B)((a) < (b)), (a), (b))
#define sph_abs(a) SPH_OF_ISA(sph_select_)((B)((a) < sph_num(0.0)), -(a), (a))
#define sph_sign(a)                                                                                \
    (sph_select((a) > sph_num(0.0), sph_num(1.0), sph_num(0.0)) -                                  \
     sph_select((a) < sph_num(0.0), sph_num(1.0), sph_num(0.0)))
#define sph_sqrt(a) SPH_OF_ISA(sph_sqrt_)(a)
#define sph_pow_where(m, a, b) SPH_OF_ISA(sph_pow_where_)((B)(m), (a), (b))
#define sph_ipow(a, n) SPH_OF_ISA(sph_ipow_)((a), (n))
#define sph_w(kernel, q) SPH_OF_ISA(sph_w_)((kernel), (q))
#define sph_dw(kernel, q) SPH_OF_ISA(sph_dw_)((kernel), (q))
#define sph_add(acc, value) ((acc) += sph_select(in, (value), sph_num(0.0)))
#define sph_take_min(acc, value) ((acc) = sph_min(sph_select(in, (value), (acc)), (acc)))
#define sph_take_max(acc, value) ((acc) = sph_max(sph_select(in, (value), (acc)), (acc)))

#define DIM 1
#define SPH_LOOP_NAME(suffix) SPH_CAT(SPH_CAT(SPH_LOOP, suffix), 1)
#include <sph/pair-group.h>
#undef DIM
#undef SPH_LOOP_NAME

#define DIM 2
#define SPH_LOOP_NAME(suffix) SPH_CAT(SPH_CAT(SPH_LOOP, suffix), 2)
#include <sph/pair-group.h>
#undef DIM
#undef SPH_LOOP_NAME

#define DIM 3
#define SPH_LOOP_NAME(suffix) SPH_CAT(SPH_CAT(SPH_LOOP, suffix), 3)
#include <sph/pair-group.h>
#undef DIM
#undef SPH_LOOP_NAME

#undef R
#undef B
#undef sph_num
#undef sph_select
#undef sph_max
#undef sph_min
#undef sph_abs
#undef sph_sign
#undef sph_sqrt
#undef sph_pow_where
#undef sph_ipow
#undef sph_w
#undef sph_dw
#undef sph_add
#undef sph_take_min
#undef sph_take_max
