/* lanes_set.h -- the functions of one set and precision over arrays; the inside of lanes_sets.c. */

#include "lanes_words.h"

#include <sph/lanes-math.h>
#include <sph/lanes-rsqrt.h>

/* n is a multiple of SPH_WIDTH. */
#define OVER(name, value)                                                                          \
    static void SPH_OF_ISA(name)(const void *x, const void *y, void *out, size_t n)                \
    {                                                                                              \
        const SPH_REAL *p = x, *q = y;                                                             \
        for (size_t k = 0; k < n; k += SPH_WIDTH) {                                                \
            R a, b, c;                                                                             \
            memcpy(&a, p + k, sizeof(a));                                                          \
            memcpy(&b, q + k, sizeof(b));                                                          \
            (void)b;                                                                               \
            c = (value);                                                                           \
            memcpy((SPH_REAL *)out + k, &c, sizeof(c));                                            \
        }                                                                                          \
    }

OVER(over_exp, sph_exp(a))
OVER(over_log, sph_log(a))
OVER(over_pow, sph_pow(a, b))
OVER(over_sqrt, sph_sqrt(a))
OVER(over_rsqrt, sph_rsqrt(a))
OVER(over_quotient, sph_num(1.0) / sph_sqrt(a))

/* libm lane by lane, as a body would have to without these functions. */
SPH_FN(R, libm_lanes_, (R a, R b, int function))
{
    R out = a;
    for (int l = 0; l < SPH_WIDTH; l++)
#if SPH_F32_WORDS
        out[l] = function == LANES_EXP   ? expf(a[l])
                 : function == LANES_LOG ? logf(a[l])
                                         : powf(a[l], b[l]);
#else
        out[l] = function == LANES_EXP   ? exp(a[l])
                 : function == LANES_LOG ? log(a[l])
                                         : pow(a[l], b[l]);
#endif
    return out;
}

OVER(libm_exp, SPH_OF_ISA(libm_lanes_)(a, b, LANES_EXP))
OVER(libm_log, SPH_OF_ISA(libm_lanes_)(a, b, LANES_LOG))
OVER(libm_pow, SPH_OF_ISA(libm_lanes_)(a, b, LANES_POW))

static const struct lanes_set SPH_OF_ISA(lanes_set) = {
    .name = SPH_SET_NAME,
    .width = SPH_WIDTH,
    .f32 = SPH_F32_WORDS,
    .function = {SPH_OF_ISA(over_exp), SPH_OF_ISA(over_log), SPH_OF_ISA(over_pow),
                 SPH_OF_ISA(over_sqrt), SPH_OF_ISA(over_rsqrt), SPH_OF_ISA(over_quotient)},
    .libm = {SPH_OF_ISA(libm_exp), SPH_OF_ISA(libm_log), SPH_OF_ISA(libm_pow)},
};

#undef OVER
#undef R
#undef I
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
#undef SPH_REAL
#undef SPH_WHOLE
#undef SPH_FN
#undef SPH_CAT
#undef SPH_CAT2
#undef SPH_OF_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#undef SPH_SET_NAME
