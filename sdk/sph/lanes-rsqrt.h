/* sph/lanes-rsqrt.h -- sph_rsqrt(a): 1 / sqrt(a) in every lane, for the distances of pairs (r is a
 * times it); and sph_sqrt(a).
 *
 *   sph_rsqrt(a)   at most 1.5 ulp off, float 2. 0, and any a below the least normal number, gives
 *                  0: particles in one place pull nowhere. For a finite a; NaN gives NaN.
 *   sph_sqrt(a)    rounded correctly
 *
 * For the processor's vectors alone, in the words of lanes-math.h; SPH_WIDTH is the lanes of R:
 * doubles 8 (AVX-512), 4 (AVX2 and FMA), 2; floats 8 (AVX2), 4. An estimate and a step or two are
 * cheaper than the processor's root and quotient, which do not overlap with others of their kind;
 * 2 doubles are better off with these. With e = 1 - a y^2, 1 / sqrt(a) is y (1 - e)^(-1/2) =
 * y (1 + e/2 + 3/8 e^2 + 5/16 e^3 + 35/128 e^4 ...). The estimates of float and of AVX-512 are the
 * processor's own, which may differ in the last digit between makes of processors. Plugins need not
 * know which there are; builtins spare them the header of all instructions. */

#define sph_rsqrt(a) SPH_OF_ISA(sph_rsqrt_)(a)
#define sph_sqrt(a) SPH_OF_ISA(sph_sqrt_)(a)

SPH_FN(R, sph_sqrt_, (R a))
{
    R out = a;
    for (int l = 0; l < SPH_WIDTH; l++)
#if SPH_F32_WORDS
        out[l] = __builtin_sqrtf(a[l]);
#else
        out[l] = __builtin_sqrt(a[l]);
#endif
    return out;
}

SPH_FN(R, sph_rsqrt_, (R a))
{
#if SPH_F32_WORDS
    const R least = sph_num(1.17549435e-38);
#else
    const R least = sph_num(2.2250738585072014e-308);
#endif
#if SPH_F32_WORDS && defined(__x86_64__) && (SPH_WIDTH == 4 || SPH_WIDTH == 8)
    /* |e| < 2^-10.4 */
#if SPH_WIDTH == 8
    R y = __builtin_ia32_rsqrtps256(a);
#else
    R y = __builtin_ia32_rsqrtps(a);
#endif
    /* Not of what is too small: 0 from here on. */
    y = sph_select(a < least, sph_num(0.0), y);
    const R e = sph_num(1.0) - (a * y) * y;
    return y + (y * e) * (e * sph_num(0.375) + sph_num(0.5));
#elif !SPH_F32_WORDS && defined(__x86_64__) && SPH_WIDTH == 8
    /* |e| < 2^-13 */
    R y = __builtin_ia32_rsqrt14pd512_mask(a, a, 0xff);
    y = sph_select(a < least, sph_num(0.0), y);
    const R e = sph_num(1.0) - (a * y) * y;
    R p = e * sph_num(0.2734375) + sph_num(0.3125);
    p = p * e + sph_num(0.375);
    p = p * e + sph_num(0.5);
    return y + (y * e) * p;
#elif !SPH_F32_WORDS && SPH_WIDTH == 4
    /* No estimate here: half the exponent, and a straight line for the fraction, as bits. e is at
     * most 0.0683; a polynomial (minimax, 2^-20.3), then a step. */
    typedef uint64_t word __attribute__((vector_size(8 * SPH_WIDTH)));
    R y = sph_of_bits(sph_int(0x5fe6e850c7b537a9) - (I)((word)sph_bits(a) >> 1));
    y = sph_select(a < least, sph_num(0.0), y);
    R e = sph_num(1.0) - (a * y) * y;
    R p = e * sph_num(0.3139084383354839) + sph_num(0.3762798274332775);
    p = p * e + sph_num(0.4999984306088058);
    y = y * (p * e + sph_num(0.9999992529890033));
    e = sph_num(1.0) - (a * y) * y;
    return y + (y * e) * (e * sph_num(0.375) + sph_num(0.5));
#else
    return sph_select(a < least, sph_num(0.0), sph_num(1.0) / SPH_OF_ISA(sph_sqrt_)(a));
#endif
}
