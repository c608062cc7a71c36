/* lanes_words.h -- the words in which sph/lanes-math.h is written, for one set (SPH_ISA) and
 * precision (SPH_F32_WORDS), natively: R of SPH_WIDTH lanes. */

#define SPH_CAT2(a, b) a##_##b
#define SPH_CAT(a, b) SPH_CAT2(a, b)
#define SPH_OF_ISA(name) SPH_CAT(name, SPH_ISA)
#define SPH_FN(type, name, arguments)                                                              \
    static inline __attribute__((always_inline, unused)) type SPH_OF_ISA(name) arguments

#if SPH_F32_WORDS
#define SPH_REAL float
#define SPH_WHOLE int32_t
#else
#define SPH_REAL double
#define SPH_WHOLE int64_t
#endif
#define R SPH_OF_ISA(lanes_real)
#define I SPH_OF_ISA(lanes_whole)
typedef SPH_REAL R __attribute__((vector_size(sizeof(SPH_REAL) * SPH_WIDTH)));
typedef SPH_WHOLE I __attribute__((vector_size(sizeof(SPH_REAL) * SPH_WIDTH)));

SPH_FN(R, lanes_num_, (double a))
{
    const R zero = {0};
    return zero + (SPH_REAL)a;
}

SPH_FN(I, lanes_int_, (int64_t a))
{
    const I zero = {0};
    return zero + (SPH_WHOLE)a;
}

SPH_FN(R, lanes_select_, (I m, R a, R b))
{
    return (R)((m & (I)a) | (~m & (I)b));
}

#define sph_num(a) SPH_OF_ISA(lanes_num_)(a)
#define sph_int(a) SPH_OF_ISA(lanes_int_)(a)
#define sph_select(m, a, b) SPH_OF_ISA(lanes_select_)((I)(m), (a), (b))
#define sph_bits(a) ((I)(a))
#define sph_of_bits(a) ((R)(a))
