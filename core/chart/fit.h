/* chart/fit.h -- what is read off a cloud of points (cost, error): powers, the front, an axis's range. */
#ifndef CHART_FIT_H
#define CHART_FIT_H

#include <stdbool.h>
#include <stddef.h>

/* y = factor x^exponent by least squares of the logarithms; pairs that are not positive and finite are
 * left out. False if fewer than two different x are left. */
bool fit_power(const double *x, const double *y, size_t n, double *exponent, double *factor);

/* The points that no other one beats in both: indices into x and y by rising x, falling y; of equal
 * points the first. `front` has room for n. Returns how many. Points that are not finite are none. */
size_t fit_front(const double *x, const double *y, size_t n, size_t *front);

/* The range of a logarithmic axis that shows [low, high] with some air: ends at 1, 2 or 5 times a power
 * of ten, over a factor of 4 at least. Both positive. */
void fit_range(double low, double high, double *first, double *last);

#endif
