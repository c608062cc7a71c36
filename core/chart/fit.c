/* chart/fit.c -- fits of powers, the front of Pareto, ranges of logarithmic axes. */
#include "chart/fit.h"

#include <math.h>

static bool is_good(double value)
{
    return isfinite(value) && value > 0;
}

bool fit_power(const double *x, const double *y, size_t n, double *exponent, double *factor)
{
    double m = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < n; i++)
        if (is_good(x[i]) && is_good(y[i])) {
            m++;
            sx += log(x[i]);
            sy += log(y[i]);
        }
    if (m < 2)
        return false;
    for (size_t i = 0; i < n; i++)
        if (is_good(x[i]) && is_good(y[i])) {
            const double dx = log(x[i]) - sx / m;
            sxx += dx * dx;
            sxy += dx * (log(y[i]) - sy / m);
        }
    if (!(sxx > 1e-20))
        return false;
    *exponent = sxy / sxx;
    *factor = exp(sy / m - *exponent * sx / m);
    return true;
}

size_t fit_front(const double *x, const double *y, size_t n, size_t *front)
{
    size_t m = 0;
    for (size_t i = 0; i < n; i++) {
        bool beaten = !isfinite(x[i]) || !isfinite(y[i]);
        for (size_t k = 0; k < n && !beaten; k++) {
            const bool as_good = x[k] <= x[i] && y[k] <= y[i];
            const bool better = x[k] < x[i] || y[k] < y[i];
            beaten = as_good && (better || k < i);
        }
        if (beaten)
            continue;
        size_t at = m++;
        for (; at > 0 && x[front[at - 1]] > x[i]; at--)
            front[at] = front[at - 1];
        front[at] = i;
    }
    return m;
}

/* The nearest of 1, 2, 5 times a power of ten below (or above). */
static double round_one(double value, bool down)
{
    static const double of[] = {1, 2, 5, 10};
    const double power = pow(10, floor(log10(value) + 1e-9));
    double best = down ? power : 10 * power;
    for (int i = 0; i < 4; i++) {
        if (down && of[i] * power <= value * (1 + 1e-9))
            best = of[i] * power;
        if (!down && of[3 - i] * power >= value * (1 - 1e-9))
            best = of[3 - i] * power;
    }
    return best;
}

void fit_range(double low, double high, double *first, double *last)
{
    *first = round_one(low / 1.15, true);
    *last = round_one(high * 1.15, false);
    while (*last < 4 * *first) {
        *first = round_one(*first / 1.2, true);
        *last = round_one(*last * 1.2, false);
    }
}
