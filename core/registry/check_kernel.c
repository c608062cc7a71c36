/* registry/check_kernel.c -- checks a kernel: its knots and powers, and that it integrates to 1 in
 * each dimension that it claims. */
#include "registry/check.h"
#include "registry/kernel_form.h"

#include <math.h>

#define PI 3.14159265358979323846
#define POWER_MAX 64u
#define INTEGRAL_TOLERANCE 1e-10

/* Integral over space of max(0, knot - q)^power, with the area of the unit sphere 2, 2 pi, 4 pi:
 * int_0^k q^(d-1) (k - q)^p dq = k^(p+d) (d-1)! p! / (p+d)!. */
static double term_integral(double knot, uint32_t power, int dim)
{
    static const double area[4] = {0, 2, 2 * PI, 4 * PI};
    static const double factorial[4] = {0, 1, 1, 2};
    double x = area[dim] * factorial[dim] * pow(knot, power);

    for (int i = 1; i <= dim; i++)
        x *= knot / ((double)power + i);
    return x;
}

static int check_terms(const sph_kernel *k, int dim, double *largest, struct error *e)
{
    const sph_kernel_term *t = k->terms[dim].data;
    double sum = 0;

    *largest = 0;
    for (uint32_t i = 0; i < k->terms[dim].count; i++) {
        if (!isfinite(t[i].coef))
            return error_set(e, EXIT_REFUSED, "coef of terms[%d][%u] is not finite", dim, i);
        if (!(t[i].knot > 0 && t[i].knot <= k->support))
            return error_set(e, EXIT_REFUSED,
                             "knot of terms[%d][%u] is %g, not within 0 and the support %g", dim, i,
                             t[i].knot, k->support);
        /* With power 1 the derivative jumps at the knot. */
        if (t[i].power < 2 || t[i].power > POWER_MAX)
            return error_set(e, EXIT_REFUSED, "power of terms[%d][%u] is %u, not within 2 and %u",
                             dim, i, t[i].power, POWER_MAX);
        if (t[i].knot > *largest)
            *largest = t[i].knot;
        sum += t[i].coef * term_integral(t[i].knot, t[i].power, dim);
    }
    sum *= k->norm[dim];
    if (!(fabs(sum - 1) <= INTEGRAL_TOLERANCE))
        return error_set(e, EXIT_REFUSED, "integral in %d dimensions is %.12g, not 1", dim, sum);
    return 0;
}

/* Integral over space by Simpson's rule on the points between which loops lay cubics: right to
 * 1e-10 for what is smooth on that scale. */
static int check_function_integral(const sph_kernel *k, int dim, struct error *e)
{
    static const double area[4] = {0, 2, 2 * PI, 4 * PI};
    const uint32_t n = 2 * KERNEL_FORM_CELLS;
    const double step = k->support / n;
    double sum = 0;

    for (uint32_t i = 0; i <= n; i++) {
        const double q = step * i;
        const double w = k->value(q, (uint32_t)dim);
        if (!isfinite(w) || !isfinite(k->slope(q, (uint32_t)dim)))
            return error_set(e, EXIT_REFUSED, "%s at q = %g in %d dimensions is not finite",
                             isfinite(w) ? "slope" : "value", q, dim);
        sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * w * pow(q, dim - 1);
    }
    sum *= step / 3 * area[dim] * k->norm[dim];
    if (!(fabs(sum - 1) <= INTEGRAL_TOLERANCE))
        return error_set(e, EXIT_REFUSED, "integral in %d dimensions is %.12g, not 1", dim, sum);
    return 0;
}

/* The slope is that of the value, within what a central difference can tell. */
static int check_function_slope(const sph_kernel *k, int dim, struct error *e)
{
    const double d = 1e-5 * k->support;

    for (uint32_t i = 1; i < 64; i++) {
        const double q = k->support * i / 64;
        const double got = k->slope(q, (uint32_t)dim);
        const double want =
            (k->value(q + d, (uint32_t)dim) - k->value(q - d, (uint32_t)dim)) / (2 * d);
        const double scale = fabs(k->value(0, (uint32_t)dim)) / k->support;
        if (!(fabs(got - want) <= 1e-6 * (scale + fabs(want))))
            return error_set(e, EXIT_REFUSED,
                             "slope at q = %g in %d dimensions is %g, but the value changes by %g "
                             "there",
                             q, dim, got, want);
    }
    return 0;
}

static int check_function(const sph_kernel *k, int dim, struct error *e)
{
    if (!k->value || !k->slope)
        return error_set(e, EXIT_REFUSED, "%s is given, but %s is NULL",
                         k->value ? "value" : "slope", k->value ? "slope" : "value");
    if (k->terms[dim].count > 0)
        return error_set(e, EXIT_REFUSED, "terms[%d] and value are both given", dim);
    return check_function_integral(k, dim, e) || check_function_slope(k, dim, e) ? -1 : 0;
}

int check_kernel(const sph_kernel *k, struct error *e)
{
    sph_kernel_form form;
    double largest;

    if (!(k->support > 0 && isfinite(k->support)))
        return error_set(e, EXIT_REFUSED, "support is %g, not a positive number", k->support);
    for (int dim = 1; dim <= 3; dim++) {
        if (!(k->item->dims >> dim & 1u))
            continue;
        if (!(k->norm[dim] > 0 && isfinite(k->norm[dim])))
            return error_set(e, EXIT_REFUSED, "norm[%d] is %g, not a positive number", dim,
                             k->norm[dim]);
        if (k->value || k->slope) {
            if (check_function(k, dim, e))
                return -1;
            continue;
        }
        if (k->terms[dim].count == 0)
            return error_set(e, EXIT_REFUSED, "terms[%d] is empty, but dims claims %d dimensions",
                             dim, dim);
        if (check_terms(k, dim, &largest, e) || kernel_form_make(&form, k, dim, e))
            return -1;
        if (largest != k->support)
            return error_set(e, EXIT_REFUSED,
                             "support is %g, but the largest knot of terms[%d] is "
                             "%g",
                             k->support, dim, largest);
    }
    return 0;
}
