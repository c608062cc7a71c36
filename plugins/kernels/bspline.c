/* bspline.c -- Schoenberg's B-splines M4, M5, M6 in q = r / h, as sums of clamped powers.
 * Norms: J. J. Monaghan, Rep. Prog. Phys. 68 (2005) 1703, doi:10.1088/0034-4885/68/8/R01, section
 * 2; D. J. Price, J. Comput. Phys. 231 (2012) 759, doi:10.1016/j.jcp.2010.12.011, eqs. 6-8. */
#include "kernels.h"

#define SOURCE "Price 2012, doi:10.1016/j.jcp.2010.12.011, eqs. 6-8"

/* M_n(q) ~ sum_k (-1)^k binomial(n, k) max(0, n/2 - k - q)^(n-1), over the knots above 0 */
static const sph_kernel_term m4[] = {{1, 2, 3, 0}, {-4, 1, 3, 0}};
static const sph_kernel_term m5[] = {{1, 2.5, 4, 0}, {-5, 1.5, 4, 0}, {10, .5, 4, 0}};
static const sph_kernel_term m6[] = {{1, 3, 5, 0}, {-6, 2, 5, 0}, {15, 1, 5, 0}};

static const sph_item item[N_BSPLINES] = {
    {(uint32_t)sizeof(sph_item), SPH_ALL_DIMS, "cubic-spline",
     "B-spline M4, support 2 h; pairs beyond about 55 neighbours in 3D", SOURCE, SPH_NO_LIST,
     SPH_NO_LIST},
    {(uint32_t)sizeof(sph_item), SPH_ALL_DIMS, "quartic-spline", "B-spline M5, support 2.5 h",
     SOURCE, SPH_NO_LIST, SPH_NO_LIST},
    {(uint32_t)sizeof(sph_item), SPH_ALL_DIMS, "quintic-spline", "B-spline M6, support 3 h", SOURCE,
     SPH_NO_LIST, SPH_NO_LIST},
};

const sph_kernel bspline[N_BSPLINES] = {
    {(uint32_t)sizeof(sph_kernel),
     0,
     &item[0],
     2,
     {0, 1. / 6, 5 / (14 * PI), 1 / (4 * PI)},
     {SPH_NO_LIST, SPH_LIST(m4), SPH_LIST(m4), SPH_LIST(m4)}},
    {(uint32_t)sizeof(sph_kernel),
     0,
     &item[1],
     2.5,
     {0, 1. / 24, 96 / (1199 * PI), 1 / (20 * PI)},
     {SPH_NO_LIST, SPH_LIST(m5), SPH_LIST(m5), SPH_LIST(m5)}},
    {(uint32_t)sizeof(sph_kernel),
     0,
     &item[2],
     3,
     {0, 1. / 120, 7 / (478 * PI), 1 / (120 * PI)},
     {SPH_NO_LIST, SPH_LIST(m6), SPH_LIST(m6), SPH_LIST(m6)}},
};
