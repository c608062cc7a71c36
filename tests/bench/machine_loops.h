/* machine_loops.h -- the loops that are timed, for one vector width and type. machine_core.c includes
 * it once for each, with
 *   LOOP_NAME(op)               a function's name
 *   LOOP_TARGET                 the attribute that names the instruction set
 *   LOOP_REAL, LOOP_VECTOR      an element, a vector
 *   LOOP_SET, _FMA, _SQRT       intrinsics
 * Twelve chains of dependent steps: more than latency times ports, and with their two constants still
 * in the sixteen registers of the narrow sets. The constants come from outside, so that the compiler
 * can foresee nothing. */
#ifndef MACHINE_LOOPS_H
#define MACHINE_LOOPS_H

enum { CHAINS = 12 };
#define EACH_CHAIN(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7) X(8) X(9) X(10) X(11)
#define START_CHAIN(K) LOOP_VECTOR v##K = LOOP_SET((LOOP_REAL)(c->start + K));
#define SUM_CHAIN(K) sum += v##K;
#define FMA_CHAIN(K) v##K = LOOP_FMA(v##K, a, b);
#define SQRT_CHAIN(K) v##K = LOOP_SQRT(v##K + b);
#define DIV_CHAIN(K) v##K = a / v##K;

#define TIMED_LOOP(op, STEP)                                                                       \
    LOOP_TARGET static double LOOP_NAME(op)(long n, const struct constants *c)                     \
    {                                                                                              \
        const LOOP_VECTOR a = LOOP_SET((LOOP_REAL)c->a), b = LOOP_SET((LOOP_REAL)c->b);            \
        EACH_CHAIN(START_CHAIN)                                                                    \
        for (long k = 0; k < n; k++) {                                                             \
            EACH_CHAIN(STEP)                                                                       \
        }                                                                                          \
        LOOP_VECTOR sum = a + b;                                                                   \
        EACH_CHAIN(SUM_CHAIN)                                                                      \
        return (double)sum[0];                                                                     \
    }

#endif

TIMED_LOOP(fma, FMA_CHAIN)
TIMED_LOOP(sqrt, SQRT_CHAIN)
TIMED_LOOP(div, DIV_CHAIN)

#undef LOOP_NAME
#undef LOOP_TARGET
#undef LOOP_REAL
#undef LOOP_VECTOR
#undef LOOP_SET
#undef LOOP_FMA
#undef LOOP_SQRT
