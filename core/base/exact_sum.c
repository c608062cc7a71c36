/* base/exact_sum.c -- see exact_sum.h. */
#include "base/exact_sum.h"
#include <math.h>
#include <string.h>

#define PENDING_MOST (1 << 29) /* a digit grows by less than 2^33 a number */

void exact_carry(struct exact_sum *s)
{
    int64_t carry = 0;
    for (int k = 0; k + 1 < EXACT_DIGITS; k++) {
        const int64_t here = s->digit[k] + carry;
        s->digit[k] = here & 0xffffffff;
        carry = (here - s->digit[k]) / ((int64_t)1 << 32);
    }
    s->digit[EXACT_DIGITS - 1] += carry; /* holds the sign */
    s->pending = 0;
}

void exact_add(struct exact_sum *s, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const unsigned exponent = (unsigned)(bits >> 52 & 0x7ff);
    uint64_t mantissa = bits & 0xfffffffffffffull;
    if (exponent == 0x7ff) {
        *(mantissa ? &s->none : bits >> 63 ? &s->below : &s->above) += 1;
        return;
    }
    mantissa |= exponent ? 1ull << 52 : 0;
    const unsigned place = exponent ? exponent - 1 : 0, shift = place % 32;
    int64_t *digit = s->digit + place / 32;
    const uint64_t low = mantissa << shift & 0xffffffff;
    const uint64_t middle = mantissa >> (32 - shift) & 0xffffffff;
    const uint64_t high = mantissa >> (32 - shift) >> 32;
    if (bits >> 63) {
        digit[0] -= (int64_t)low;
        digit[1] -= (int64_t)middle;
        digit[2] -= (int64_t)high;
    } else {
        digit[0] += (int64_t)low;
        digit[1] += (int64_t)middle;
        digit[2] += (int64_t)high;
    }
    if (++s->pending >= PENDING_MOST)
        exact_carry(s);
}

void exact_join(struct exact_sum *s, const struct exact_sum *other)
{
    struct exact_sum more = *other;
    exact_carry(s);
    exact_carry(&more);
    for (int k = 0; k < EXACT_DIGITS; k++)
        s->digit[k] += more.digit[k];
    s->none += more.none;
    s->above += more.above;
    s->below += more.below;
    exact_carry(s);
}

double exact_value(const struct exact_sum *s)
{
    struct exact_sum t = *s;
    if (t.none || (t.above && t.below))
        return NAN;
    if (t.above || t.below)
        return t.above ? INFINITY : -INFINITY;
    exact_carry(&t);
    const int negative = t.digit[EXACT_DIGITS - 1] < 0;
    if (negative) {
        for (int k = 0; k < EXACT_DIGITS; k++)
            t.digit[k] = -t.digit[k];
        exact_carry(&t);
    }
    int top = EXACT_DIGITS - 1;
    while (top > 0 && t.digit[top] == 0)
        top--;
    /* 64 bits at least are in the three highest digits. */
    double value = 0.0;
    for (int k = top < 2 ? 0 : top - 2; k <= top; k++)
        value += ldexp((double)t.digit[k], 32 * k - 1074);
    return negative ? -value : value;
}
