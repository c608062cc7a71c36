/* sph/lanes-math.h -- exp, log and pow in every lane at once. One text for the processor's vectors
 * and for OpenCL C; no libm, no intrinsics, no branches on lanes.
 *
 *   sph_exp(a)       at most 1 ulp off. Above its range inf; results below exp(-708), for float
 *                    exp(-86.9), are 0: there is no gradual underflow.
 *   sph_log(a)       at most 1 ulp off. 0 gives -inf, less gives NaN.
 *   sph_pow(a, b)    a^b for a >= 0, at most 2 ulp off (float: 1.5); less than 0 gives NaN. Its
 *                    range is sph_exp's. b = 0 gives 1 for every a; 1^b is 1 for every number b.
 *   NaN gives NaN (but for b = 0). A device that flushes subnormal numbers takes them as 0 here.
 *
 * Included once for each instruction set and precision, where these words mean:
 *   R, I                  reals, and signed integers of their size, in every lane
 *   SPH_F32_WORDS         1: R is of float; 0: of double
 *   sph_num(a)            a constant in every lane; sph_int(a): likewise of I
 *   sph_select(m, a, b)   a where the comparison(s) m hold, else b
 *   sph_bits(a)           the bits of an R as I; sph_of_bits(i): back
 *   SPH_FN(type, name, arguments)
 *                         the head of a function of this set and precision; SPH_OF_ISA(name) is
 *                         what it is called there. On a device: name itself.
 * Each function has a macro, by which it is called without its set. Those for bodies (sph_exp,
 * sph_log, sph_pow) stay defined, and whoever switches the words off undefines them; what begins
 * with SPH_M_ or ends in an underscore is this file's own, and gone at its end.
 *
 * Every number here comes out right whether or not the compiler contracts a * b + c: where a
 * product must be exact, its factors have so few bits that it is. They are cut off as bits, which
 * no compiler rearranges (Dekker, doi:10.1007/BF01397083, splits by arithmetic). -ffast-math would
 * break these functions; -fno-signed-zeros and -fno-trapping-math do not.
 *
 * Polynomials: minimax, by Remez's algorithm with the weight that makes the relative error of the
 * function equal; coefficients rounded to R. Their errors are given. */

#define sph_exp(a) SPH_OF_ISA(sph_exp_)(a)
#define sph_log(a) SPH_OF_ISA(sph_log_)(a)
#define sph_pow(a, b) SPH_OF_ISA(sph_pow_)((a), (b))

#define sph_exp_of_sum_(a, b) SPH_OF_ISA(sph_exp_of_sum_)((a), (b))
#define sph_mantissa_(a, exponent) SPH_OF_ISA(sph_mantissa_)((a), (exponent))
#define sph_log_long_(a, low) SPH_OF_ISA(sph_log_long_)((a), (low))
#define SPH_M_CUT(a, bits) sph_of_bits(sph_bits(a) & sph_int(bits))

#if SPH_F32_WORDS
#define SPH_M_FRACTION 23
#define SPH_M_INF 0x7f800000
#define SPH_M_NAN 0x7fc00000
#define SPH_M_POSITIVE 0x7fffffff
#define SPH_M_FRACTION_BITS 0x007fffff
#define SPH_M_ROOT_HALF 0x3f3504f3 /* sqrt(1/2) */
#define SPH_M_HALF (-0x1000)       /* -1 << 12: keeps 12 bits */
#define SPH_M_THIRD (-0x20000)     /* -1 << 17: keeps 7 bits */
#define SPH_M_ROUND 12582912.0     /* 1.5 * 2^23: added, it rounds to whole numbers */
#define SPH_M_ROUND_BITS 0x4b400000
#define SPH_M_BIAS 126.0 /* the exponent of 1/2 */
#define SPH_M_NORMAL 1.17549435e-38
#define SPH_M_LARGEST 3.40282347e+38
#define SPH_M_SCALE 33554432.0 /* 2^25: makes a subnormal number a normal one */
#define SPH_M_SCALE_LOG 25.0
#define SPH_M_EXP_MOST 89.0
#define SPH_M_EXP_LEAST -86.9
#define SPH_M_LOG2E 1.44269502
#define SPH_M_LN2 0.693145751953125 /* 16 bits, so that a whole number of them is exact */
#define SPH_M_LN2_LOW 1.42860677e-06
#define SPH_M_2_3 0.625 /* 3 bits */
#define SPH_M_2_3_LOW 0.0416666679
#else
#define SPH_M_FRACTION 52
#define SPH_M_INF 0x7ff0000000000000
#define SPH_M_NAN 0x7ff8000000000000
#define SPH_M_POSITIVE 0x7fffffffffffffff
#define SPH_M_FRACTION_BITS 0x000fffffffffffff
#define SPH_M_ROOT_HALF 0x3fe6a09e667f3bcd
#define SPH_M_HALF (-0x8000000)       /* -1 << 27: keeps 26 bits */
#define SPH_M_THIRD (-0x4000000000)   /* -1 << 38: keeps 15 bits */
#define SPH_M_ROUND 6755399441055744.0 /* 1.5 * 2^52 */
#define SPH_M_ROUND_BITS 0x4338000000000000
#define SPH_M_BIAS 1022.0
#define SPH_M_NORMAL 2.2250738585072014e-308
#define SPH_M_LARGEST 1.7976931348623157e+308
#define SPH_M_SCALE 18014398509481984.0 /* 2^54 */
#define SPH_M_SCALE_LOG 54.0
#define SPH_M_EXP_MOST 710.0
#define SPH_M_EXP_LEAST -708.0
#define SPH_M_LOG2E 1.4426950408889634
#define SPH_M_LN2 0.6931471805598903 /* 42 bits */
#define SPH_M_LN2_LOW 5.497923018708371e-14
#define SPH_M_2_3 0.6640625 /* 8 bits */
#define SPH_M_2_3_LOW 0.0026041666666666665
#endif

/* exp(a + b), b small beside a, and a with few enough bits that a - k ln 2 is exact with the upper
 * part of ln 2 (Cody and Waite, Software Manual for the Elementary Functions, 1980): every R for
 * |k| = 1 to 2^11, float 2^8. */
SPH_FN(R, sph_exp_of_sum_, (R a, R b))
{
    const R shift = sph_num(SPH_M_ROUND + SPH_M_BIAS);
    const R most = sph_num(SPH_M_EXP_MOST);
    b = sph_select(a > most, sph_num(0.0), b);
    a = sph_select(a > most, most, a);
    const R sum = a + b;
    /* The lowest bits of n are k and the exponent's bias. */
    const R n = sum * sph_num(SPH_M_LOG2E) + shift;
    const R k = n - shift;
    const R high = a - k * sph_num(SPH_M_LN2);
    const R low = b - k * sph_num(SPH_M_LN2_LOW);
    const R r = high + low;
    const R lost = (high - r) + low;
    /* (exp(r) - 1 - r) / r^2 for |r| <= ln 2 / 2 */
#if SPH_F32_WORDS
    R p = sph_num(0.00138131448); /* 2^-27.6 */
    p = p * r + sph_num(0.00836941879);
    p = p * r + sph_num(0.041668456);
    p = p * r + sph_num(0.166665152);
    p = p * r + sph_num(0.49999994);
#else
    R p = sph_num(2.511050317061261e-08); /* 2^-56.2 */
    p = p * r + sph_num(2.76332452138983e-07);
    p = p * r + sph_num(2.755724112944857e-06);
    p = p * r + sph_num(2.4801485756089112e-05);
    p = p * r + sph_num(0.0001984126988766238);
    p = p * r + sph_num(0.0013888888949214145);
    p = p * r + sph_num(0.008333333333321855);
    p = p * r + sph_num(0.041666666666517416);
    p = p * r + sph_num(0.16666666666666674);
    p = p * r + sph_num(0.5000000000000011);
#endif
    p = sph_num(1.0) + (r + (p * (r * r) + lost));
    /* Twice, times 2^(k - 1): 2^k itself may be too large. */
    p = (p + p) * sph_of_bits(sph_bits(n) << SPH_M_FRACTION);
    return sph_select(sum < sph_num(SPH_M_EXP_LEAST), sph_num(0.0), p);
}

SPH_FN(R, sph_exp_, (R a))
{
    return sph_exp_of_sum_(a, sph_num(0.0));
}

/* a = m 2^exponent, m in [sqrt(1/2), sqrt(2)), so that a near 1 has the exponent 0. For a > 0; for
 * others both are some numbers. */
SPH_FN(R, sph_mantissa_, (R a, R *exponent))
{
    const R normal = sph_num(SPH_M_NORMAL);
    const R bias = sph_select(a < normal, sph_num(SPH_M_ROUND + SPH_M_SCALE_LOG),
                              sph_num(SPH_M_ROUND));
    a = sph_select(a < normal, a * sph_num(SPH_M_SCALE), a);
    /* Without the sign no difference overflows. */
    const I i = (sph_bits(a) & sph_int(SPH_M_POSITIVE)) - sph_int(SPH_M_ROOT_HALF);
    *exponent = sph_of_bits((i >> SPH_M_FRACTION) + sph_int(SPH_M_ROUND_BITS)) - bias;
    return sph_of_bits((i & sph_int(SPH_M_FRACTION_BITS)) + sph_int(SPH_M_ROOT_HALF));
}

/* log(1 + f) = 2 atanh(s), s = f / (2 + f), is 2 s + s z P(z), z = s^2. The first term is not
 * exact; but 2 s = f - s f, and s f = h - s h, h = f^2 / 2: what is added to f, which is, is small,
 * and all but h much smaller. */
SPH_FN(R, sph_log_, (R a))
{
    R k;
    const R f = sph_mantissa_(a, &k) - sph_num(1.0);
    const R s = f / (f + sph_num(2.0));
    const R h = f * f * sph_num(0.5);
    const R z = s * s;
#if SPH_F32_WORDS
    R p = sph_num(0.299255937); /* 2^-29.3 */
    p = p * z + sph_num(0.399760783);
    p = p * z + sph_num(0.666667759);
#else
    R p = sph_num(0.1481051999082406); /* 2^-58.6 */
    p = p * z + sph_num(0.15313164375076815);
    p = p * z + sph_num(0.18183571541169416);
    p = p * z + sph_num(0.2222219909089342);
    p = p * z + sph_num(0.28571428729284787);
    p = p * z + sph_num(0.39999999999519825);
    p = p * z + sph_num(0.666666666666671);
#endif
    p = k * sph_num(SPH_M_LN2_LOW) + s * (p * z + h);
    p = k * sph_num(SPH_M_LN2) + (f - (h - p));
    const R at_0 = sph_select(a < sph_num(0.0), sph_of_bits(sph_int(SPH_M_NAN)),
                              -sph_of_bits(sph_int(SPH_M_INF)));
    p = sph_select(a > sph_num(0.0), p, at_0);
    return sph_select(a <= sph_num(SPH_M_LARGEST), p, a);
}

/* The logarithm of a > 0 as a sum, with some 11 bits more than R has: the result, and *low. As
 * above, but 2 s and the cubic term 2/3 s^3 are carried in two parts. */
SPH_FN(R, sph_log_long_, (R a, R *low))
{
    const R one = sph_num(1.0);
    R k;
    const R m = sph_mantissa_(a, &k);
    /* s = (m - 1) / (m + 1): its upper half, and the rest out of the remainder. */
    const R f = m - one;
    const R inverse = one / (m + one);
    const R cut = f * inverse;
    const R s_high = SPH_M_CUT(cut, SPH_M_HALF);
    const R d_high = SPH_M_CUT(m + one, SPH_M_HALF);
    const R d_low = m - (d_high - one);
    const R s_low = ((f - s_high * d_high) - s_high * d_low) * inverse;
    const R s = s_high + s_low;
    const R z = s * s;
    /* s^3 = t^3 + u (3 t s + u^2), s = t + u, and t^3 is exact. */
    const R t = SPH_M_CUT(cut, SPH_M_THIRD);
    const R u = (s_high - t) + s_low;
    const R cube = t * t * t;
    const R cube_low = u * (sph_num(3.0) * t * s + u * u);
    /* 2/5 + 2/7 z + ... */
#if SPH_F32_WORDS
    R p = sph_num(0.233314827); /* 2^-35.6 */
    p = p * z + sph_num(0.285518259);
    p = p * z + sph_num(0.4000009);
#else
    R p = sph_num(0.13195975128689813); /* 2^-66.2 */
    p = p * z + sph_num(0.13256857159385146);
    p = p * z + sph_num(0.15386755578928307);
    p = p * z + sph_num(0.18181784406529783);
    p = p * z + sph_num(0.22222222519456103);
    p = p * z + sph_num(0.28571428570102286);
    p = p * z + sph_num(0.4000000000000225);
#endif
    p = s * z * (p * z + sph_num(SPH_M_2_3_LOW)) + cube_low * sph_num(SPH_M_2_3);
    p = (s_low + s_low) + p + k * sph_num(SPH_M_LN2_LOW);
    /* The exact terms, largest first: k ln 2 is 0 or more than the others. (Fast2Sum: Dekker.) */
    const R third = cube * sph_num(SPH_M_2_3);
    const R pair = (s_high + s_high) + third;
    const R pair_low = third - (pair - (s_high + s_high));
    const R whole = k * sph_num(SPH_M_LN2);
    const R high = whole + pair;
    *low = (pair - (high - whole)) + (pair_low + p);
    return high;
}

SPH_FN(R, sph_pow_, (R a, R b))
{
    const R zero = sph_num(0.0), inf = sph_of_bits(sph_int(SPH_M_INF));
    /* Past 2^64 only 1 has a power that is a number; and no product overflows. */
    const R far = sph_num(18446744073709551616.0);
    R c = sph_select(b > far, far, b);
    c = sph_select(c < -far, -far, c);
    R low;
    const R high = sph_log_long_(a, &low);
    const R l_high = SPH_M_CUT(high, SPH_M_HALF);
    const R c_high = SPH_M_CUT(c, SPH_M_HALF);
    R p = sph_exp_of_sum_(c_high * l_high,
                          c_high * ((high - l_high) + low) + (c - c_high) * high);
    p = sph_select(((a == zero) & (b > zero)) | ((a == inf) & (b < zero)), zero, p);
    p = sph_select(((a == zero) & (b < zero)) | ((a == inf) & (b > zero)), inf, p);
    return sph_select((a >= zero) | (b == zero), p, sph_of_bits(sph_int(SPH_M_NAN)));
}

#undef sph_exp_of_sum_
#undef sph_mantissa_
#undef sph_log_long_
#undef SPH_M_CUT
#undef SPH_M_FRACTION
#undef SPH_M_INF
#undef SPH_M_NAN
#undef SPH_M_POSITIVE
#undef SPH_M_FRACTION_BITS
#undef SPH_M_ROOT_HALF
#undef SPH_M_HALF
#undef SPH_M_THIRD
#undef SPH_M_ROUND
#undef SPH_M_ROUND_BITS
#undef SPH_M_BIAS
#undef SPH_M_NORMAL
#undef SPH_M_LARGEST
#undef SPH_M_SCALE
#undef SPH_M_SCALE_LOG
#undef SPH_M_EXP_MOST
#undef SPH_M_EXP_LEAST
#undef SPH_M_LOG2E
#undef SPH_M_LN2
#undef SPH_M_LN2_LOW
#undef SPH_M_2_3
#undef SPH_M_2_3_LOW
