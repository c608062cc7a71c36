/* sph/kernel-value.h -- a kernel's value and slope for one number at a time, for what a plugin does
 * once in a while; pair bodies use sph_w and sph_dw (lanes.h). All [any]. */
#ifndef SPH_KERNEL_VALUE_H
#define SPH_KERNEL_VALUE_H

#include <math.h>
#include <sph/batch.h>

/* For the two below, of a kernel that is a table: the cubic between the ends of a cell. */
static inline double sph_kernel_cubic(const sph_kernel_form *kernel, double q, int slope)
{
    const double *p;
    double cell, t, c2, c3;
    uint32_t k;
    if (!(q >= 0.0 && q < kernel->support))
        return 0.0;
    cell = q * kernel->cells;
    k = cell < kernel->n_table - 1 ? (uint32_t)cell : kernel->n_table - 1;
    p = kernel->table + 2 * (size_t)k;
    t = cell - k;
    c2 = 3.0 * (p[2] - p[0]) - 2.0 * p[1] - p[3];
    c3 = p[1] + p[3] - 2.0 * (p[2] - p[0]);
    return kernel->norm * (slope ? kernel->cells * (p[1] + t * (2.0 * c2 + 3.0 * c3 * t))
                                 : p[0] + t * (p[1] + t * (c2 + c3 * t)));
}

/* For the two below: one of the two sums of a kernel form. */
static inline double sph_kernel_sum(const sph_kernel_form *kernel, double q, int slope)
{
    double sum = 0.0;
    if (kernel->n_table)
        return sph_kernel_cubic(kernel, q, slope);
    for (uint32_t k = 0; k < kernel->n_pieces; k++) {
        const sph_kernel_piece *p = &kernel->piece[k];
        const double *c = slope ? p->d : p->c;
        double t = p->knot - q, value = 0.0;
        if (!(t > 0.0))
            continue;
        for (uint32_t n = slope ? p->dn_coef : p->n_coef; n-- > 0;)
            value = value * t + c[n];
        for (uint32_t n = slope ? p->dpower : p->power; n-- > 0;)
            value *= t;
        sum += value;
    }
    return sum * kernel->norm;
}

/* W at q = r / h, to be multiplied by h^-dim. */
static inline double sph_kernel_w(const sph_kernel_form *kernel, double q)
{
    return sph_kernel_sum(kernel, q, 0);
}

/* dW/dr at q = r / h, to be multiplied by h^-(dim+1). */
static inline double sph_kernel_dw(const sph_kernel_form *kernel, double q)
{
    return sph_kernel_sum(kernel, q, 1);
}

/* W' / q of a kernel of one piece: t^dpower (e[0] + e[1] t + ...) of dn_coef - 1 terms, since q =
 * knot - t divides the sum if W'(0) = 0. The number of terms; 0: it does not. */
static inline uint32_t sph_kernel_over_q(const sph_kernel_piece *p, double *e)
{
    double rest = 0.0, scale = 0.0;
    for (uint32_t k = 0; k < p->dn_coef; k++) {
        scale = fmax(scale, fabs(p->d[k]));
        rest = k + 1 < p->dn_coef ? (e[k] = (p->d[k] + rest) / p->knot) : p->d[k] + rest;
    }
    return p->dn_coef > 1 && fabs(rest) <= 1e-12 * scale ? p->dn_coef - 1 : 0;
}

#endif
