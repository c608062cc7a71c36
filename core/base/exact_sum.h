/* base/exact_sum.h -- sums of doubles without any rounding: the same whatever the order in which numbers are
 * added, and on however many processes. Fixed point over the whole range of doubles, as in R. M. Neal, "Fast
 * exact summation using small and large superaccumulators", arXiv:1505.05571 (2015), section 2. */
#ifndef BASE_EXACT_SUM_H
#define BASE_EXACT_SUM_H

#include <stdint.h>

/* Digits of 32 bits with room for carries; the lowest counts 2^-1074. */
#define EXACT_DIGITS 70

/* Begin with zeros. A NaN, or infinities of both signs, make the sum NaN. */
struct exact_sum {
    int64_t digit[EXACT_DIGITS];
    int64_t none, above, below; /* how many were NaN, and infinite */
    int64_t pending;            /* numbers added since carries were taken */
};

void exact_add(struct exact_sum *s, double value);
/* Takes carries, so that sums may be added digit by digit: 2^31 of them. */
void exact_carry(struct exact_sum *s);
void exact_join(struct exact_sum *s, const struct exact_sum *other);
/* The sum as a double, within its last bit. */
double exact_value(const struct exact_sum *s);

#endif
