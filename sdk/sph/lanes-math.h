/* sph/lanes-math.h -- exp, log and pow in every lane at once. One text for the processor's vectors
 * and for OpenCL C; no libm, no intrinsics, no branches on lanes.
 *
 *   sph_exp(a)       at most 1 ulp off. Above its range inf. There is no gradual underflow: results
 *                    below 5e-308, for float 3e-38, are right or 0.
 *   sph_log(a)       at most 1 ulp off. 0 gives -inf, less gives NaN.
 *   sph_pow(a, b)    a^b for a >= 0, at most 2 ulp off (float: 1.5); less than 0 gives NaN. Its
 *                    range is sph_exp's. b = 0 gives 1 for every a; 1^b is 1 for every finite b.
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
 * with SPH_M_ is this file's own, and gone at its end.
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

#define SPH_M_EXP_OF_SUM(a, b) SPH_OF_ISA(sph_exp_of_sum_)((a), (b))
#define SPH_M_MANTISSA(a, exponent) SPH_OF_ISA(sph_mantissa_)((a), (exponent))
#define SPH_M_LOG_ENDS(a, p) SPH_OF_ISA(sph_log_ends_)((a), (p))
#define SPH_M_LOG_LONG(a, rest) SPH_OF_ISA(sph_log_long_)((a), (rest))
#define SPH_M_CUT(a, bits) sph_of_bits(sph_bits(a) & sph_int(bits))

#if SPH_F32_WORDS
#define SPH_M_FRACTION 23
#define SPH_M_INF 0x7f800000
#define SPH_M_MINUS_INF (-0x800000)
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
#define SPH_M_EXP_LEAST -86.7
#define SPH_M_LOG2E 1.44269502
#define SPH_M_LN2 0.693145751953125 /* 16 bits, so that a whole number of them is exact */
#define SPH_M_LN2_LOW 1.42860677e-06
#define SPH_M_2_3 0.625 /* 3 bits */
#define SPH_M_2_3_LOW 0.0416666679
#else
#define SPH_M_FRACTION 52
#define SPH_M_INF 0x7ff0000000000000
#define SPH_M_MINUS_INF (-0x10000000000000)
#define SPH_M_NAN 0x7ff8000000000000
#define SPH_M_POSITIVE 0x7fffffffffffffff
#define SPH_M_FRACTION_BITS 0x000fffffffffffff
#define SPH_M_ROOT_HALF 0x3fe6a09e667f3bcd
#define SPH_M_HALF (-0x8000000)        /* -1 << 27: keeps 26 bits */
#define SPH_M_THIRD (-0x4000000000)    /* -1 << 38: keeps 15 bits */
#define SPH_M_ROUND 6755399441055744.0 /* 1.5 * 2^52 */
#define SPH_M_ROUND_BITS 0x4338000000000000
#define SPH_M_BIAS 1022.0
#define SPH_M_NORMAL 2.2250738585072014e-308
#define SPH_M_LARGEST 1.7976931348623157e+308
#define SPH_M_SCALE 18014398509481984.0 /* 2^54 */
#define SPH_M_SCALE_LOG 54.0
#define SPH_M_EXP_MOST 710.0
#define SPH_M_EXP_LEAST -707.8
#define SPH_M_LOG2E 1.4426950408889634
#define SPH_M_LN2 0.6931471805598903 /* 42 bits */
#define SPH_M_LN2_LOW 5.497923018708371e-14
#define SPH_M_2_3 0.6640625 /* 8 bits */
#define SPH_M_2_3_LOW 0.0026041666666666665
#endif

/* exp(a + b), b small beside a, and a with few enough bits that a - k ln 2 is exact with the upper
 * part of ln 2 (Cody and Waite, Software Manual for the Elementary Functions, 1980). Where a is out
 * of range b does not matter, NaN neither; the range leaves room for a b of 0.2. */
SPH_FN(R, sph_exp_of_sum_, (R a, R b))
{
    const R shift = sph_num(SPH_M_ROUND + SPH_M_BIAS);
    /* The lowest bits of n are k and the exponent's bias. */
    const R n = (a + b) * sph_num(SPH_M_LOG2E) + shift;
    const R k = n - shift;
    const R high = a - k * sph_num(SPH_M_LN2);
    const R low = b - k * sph_num(SPH_M_LN2_LOW);
    const R r = high + low;
    const R lost = (high - r) + low;
    const R r2 = r * r;
    /* (exp(r) - 1 - r) / r^2 for |r| <= ln 2 / 2. In pairs (Estrin), here and below: fewer
     * operations wait for each other. */
#if SPH_F32_WORDS
    R p = r * sph_num(0.00836941879) + sph_num(0.041668456); /* 2^-27.6 */
    p = r2 * sph_num(0.00138131448) + p;
    p = p * r2 + (r * sph_num(0.166665152) + sph_num(0.49999994));
#else
    const R r4 = r2 * r2;
    R p = r * sph_num(2.511050317061261e-08) + sph_num(2.76332452138983e-07); /* 2^-56.2 */
    R q = r * sph_num(2.755724112944857e-06) + sph_num(2.4801485756089112e-05);
    q = q * r2 + (r * sph_num(0.0001984126988766238) + sph_num(0.0013888888949214145));
    p = p * r4 + q;
    q = r * sph_num(0.008333333333321855) + sph_num(0.041666666666517416);
    q = q * r2 + (r * sph_num(0.16666666666666674) + sph_num(0.5000000000000011));
    p = p * r4 + q;
#endif
    /* Twice, times 2^(k - 1): 2^k itself may be too large. */
    p = (r + (p * r2 + lost)) * sph_num(2.0) + sph_num(2.0);
    p = p * sph_of_bits(sph_bits(n) << SPH_M_FRACTION);
    p = sph_select(a < sph_num(SPH_M_EXP_LEAST), sph_num(0.0), p);
    return sph_select(a > sph_num(SPH_M_EXP_MOST), sph_of_bits(sph_int(SPH_M_INF)), p);
}

SPH_FN(R, sph_exp_, (R a))
{
    return SPH_M_EXP_OF_SUM(a, sph_num(0.0));
}

/* a = m 2^exponent, m in [sqrt(1/2), sqrt(2)), so that a near 1 has the exponent 0. For a > 0; for
 * others both are some numbers. */
SPH_FN(R, sph_mantissa_, (R a, R *exponent))
{
    const R normal = sph_num(SPH_M_NORMAL);
    const R bias =
        sph_select(a < normal, sph_num(SPH_M_ROUND + SPH_M_SCALE_LOG), sph_num(SPH_M_ROUND));
    a = sph_select(a < normal, a * sph_num(SPH_M_SCALE), a);
    /* Without the sign no difference overflows. */
    const I i = (sph_bits(a) & sph_int(SPH_M_POSITIVE)) - sph_int(SPH_M_ROOT_HALF);
    *exponent = sph_of_bits((i >> SPH_M_FRACTION) + sph_int(SPH_M_ROUND_BITS)) - bias;
    return sph_of_bits((i & sph_int(SPH_M_FRACTION_BITS)) + sph_int(SPH_M_ROOT_HALF));
}

/* The logarithm where it is no number; else p. */
SPH_FN(R, sph_log_ends_, (R a, R p))
{
    const R at_0 = sph_select(a < sph_num(0.0), sph_of_bits(sph_int(SPH_M_NAN)),
                              sph_of_bits(sph_int(SPH_M_MINUS_INF)));
    p = sph_select(a > sph_num(0.0), p, at_0);
    return sph_select(a <= sph_num(SPH_M_LARGEST), p, a);
}

/* log(1 + f) = 2 atanh(s), s = f / (2 + f), is 2 s + s z P(z), z = s^2. The first term is not
 * exact; but 2 s = f - s f, and s f = h - s h, h = f^2 / 2: what is added to f, which is, is small,
 * and all but h much smaller. */
SPH_FN(R, sph_log_, (R a))
{
    R k;
    const R m = SPH_M_MANTISSA(a, &k);
    const R f = m - sph_num(1.0);
    const R s = f / (m + sph_num(1.0));
    const R h = f * f * sph_num(0.5);
    const R z = s * s;
#if SPH_F32_WORDS
    R p = sph_num(0.299255937); /* 2^-29.3 */
    p = p * z + sph_num(0.399760783);
    p = p * z + sph_num(0.666667759);
#else
    const R z2 = z * z;
    R p = z * sph_num(0.15313164375076815) + sph_num(0.18183571541169416); /* 2^-58.6 */
    p = z2 * sph_num(0.1481051999082406) + p;
    R q = z * sph_num(0.2222219909089342) + sph_num(0.28571428729284787);
    q = q * z2 + (z * sph_num(0.39999999999519825) + sph_num(0.666666666666671));
    p = p * (z2 * z2) + q;
#endif
    p = k * sph_num(SPH_M_LN2_LOW) + s * (p * z + h);
    p = k * sph_num(SPH_M_LN2) + (f - (h - p));
    return SPH_M_LOG_ENDS(a, p);
}

/* The logarithm as a sum, with some 11 bits more than R has: its upper half, and *rest. As above,
 * but 2 s and the cubic term 2/3 s^3 are carried in two parts, and the first ones are exact. */
SPH_FN(R, sph_log_long_, (R a, R *rest))
{
    const R one = sph_num(1.0);
    R k;
    const R m = SPH_M_MANTISSA(a, &k);
    const R f = m - one;
    const R inverse = one / (m + one);
    const R quotient = f * inverse;
    /* s = t + u: t short enough for an exact t^3, u out of the remainder of the division. */
    const R t = SPH_M_CUT(quotient, SPH_M_THIRD);
    const R d_high = SPH_M_CUT(m + one, SPH_M_HALF);
    const R d_low = m - (d_high - one);
#if SPH_F32_WORDS
    /* There so short a t would leave u too coarse. */
    const R s_high = SPH_M_CUT(quotient, SPH_M_HALF);
    const R s_low = ((f - s_high * d_high) - s_high * d_low) * inverse;
    const R u = (s_high - t) + s_low;
#else
    const R s_high = t;
    const R s_low = ((f - s_high * d_high) - s_high * d_low) * inverse;
    const R u = s_low;
#endif
    const R s = s_high + s_low;
    const R z = s * s;
    const R third = (t * t * t) * sph_num(SPH_M_2_3);
    /* The quotient as divided is there sooner than s, and will do where little hangs on it. */
    const R y = quotient * quotient;
    const R third_low = u * ((y + t * (quotient + t)) * sph_num(SPH_M_2_3));
    /* 2/5 + 2/7 y + ... */
#if SPH_F32_WORDS
    R p = sph_num(0.233314827); /* 2^-35.6 */
    p = p * y + sph_num(0.285518259);
    p = p * y + sph_num(0.4000009);
#else
    const R y2 = y * y;
    R p = y * sph_num(0.13256857159385146) + sph_num(0.15386755578928307); /* 2^-66.2 */
    p = y2 * sph_num(0.13195975128689813) + p;
    R q = y * sph_num(0.18181784406529783) + sph_num(0.22222222519456103);
    q = q * y2 + (y * sph_num(0.28571428570102286) + sph_num(0.4000000000000225));
    p = p * (y2 * y2) + q;
#endif
    p = (s * z) * (p * z + sph_num(SPH_M_2_3_LOW)) + third_low;
    /* The exact terms, largest first; k ln 2 is 0 or more than the others (Fast2Sum: Dekker). */
    const R pair = s_high * sph_num(2.0) + third;
    const R pair_low = third - (pair - s_high * sph_num(2.0));
    const R whole = k * sph_num(SPH_M_LN2);
    const R high = SPH_M_CUT(whole + pair, SPH_M_HALF);
    const R low = k * sph_num(SPH_M_LN2_LOW) + (pair_low + s_low * sph_num(2.0));
    *rest = (((whole - high) + pair) + low) + p;
    return SPH_M_LOG_ENDS(a, high);
}

SPH_FN(R, sph_pow_, (R a, R b))
{
    R rest;
    const R high = SPH_M_LOG_LONG(a, &rest);
    const R b_high = SPH_M_CUT(b, SPH_M_HALF);
    const R p = SPH_M_EXP_OF_SUM(b_high * high, (b - b_high) * high + b * rest);
    return sph_select(b == sph_num(0.0), sph_num(1.0), p);
}

#undef SPH_M_EXP_OF_SUM
#undef SPH_M_MANTISSA
#undef SPH_M_LOG_ENDS
#undef SPH_M_LOG_LONG
#undef SPH_M_CUT
#undef SPH_M_FRACTION
#undef SPH_M_INF
#undef SPH_M_MINUS_INF
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
