/* lanes_sets.h -- the functions of sph/lanes-math.h and lanes-rsqrt.h over arrays, for each
 * instruction set that this processor has, in double and float. */
#ifndef LANES_SETS_H
#define LANES_SETS_H

#include <stdbool.h>
#include <stddef.h>

enum lanes_function {
    LANES_EXP,
    LANES_LOG,
    LANES_POW,
    LANES_SQRT,
    LANES_RSQRT,
    LANES_QUOTIENT, /* 1 / sqrt(x), as the processor does it */
    LANES_FUNCTIONS
};

struct lanes_set {
    const char *name;
    int width;
    bool f32;
    /* Of x, pow of x and y; n is a multiple of 8. Both arrays are read. */
    void (*function[LANES_FUNCTIONS])(const void *x, const void *y, void *out, size_t n);
    /* exp, log and pow by libm, lane by lane. */
    void (*libm[LANES_POW + 1])(const void *x, const void *y, void *out, size_t n);
};

/* The k-th, or NULL past the last. */
const struct lanes_set *lanes_set(size_t k);

#endif
