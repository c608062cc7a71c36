/* rates.macros.h -- what the body of the rate sweep is written with, natively and on a device. */
/* The limited increment of a quantity from j to i, from its step over the pair and what one side's gradient gives
 * for it. minmod: the smaller of the two. van-leer: harmonic mean of the step and of the one beyond that
 * the gradient tells of. cap: most that it may be. */
#define GSPH_LIMIT(step, slope, cap)                                                               \
    sph_max(sph_min(limiter < 1.5 ? GSPH_MINMOD(step, slope)                                       \
                                  : GSPH_VAN_LEER(step, (2.0 * (slope) - (step))),                 \
                    cap),                                                                          \
            -(cap))
#define GSPH_MINMOD(a, b)                                                                          \
    sph_select((a) * (b) > sph_num(0.0), sph_select(sph_abs(a) < sph_abs(b), (a), (b)),            \
               sph_num(0.0))
#define GSPH_VAN_LEER(a, b)                                                                        \
    sph_select((a) * (b) > sph_num(0.0), 2.0 * (a) * (b) / ((a) + (b)), sph_num(0.0))
/* Most speeds of sound that the velocity may be changed by. */
#define GSPH_MOST_SOUND 5.0
/* Iterations of the exact solver: the worst of 200 000 random problems missed p* by 2e-5. */
#define GSPH_NEWTON 4
