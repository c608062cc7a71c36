/* bspline.c -- Schoenberg's B-splines M4, M5, M6 in q = r / h, as sums of clamped powers.
 * Norms: J. J. Monaghan, Rep. Prog. Phys. 68 (2005) 1703, doi:10.1088/0034-4885/68/8/R01, section
 * 2; D. J. Price, J. Comput. Phys. 231 (2012) 759, doi:10.1016/j.jcp.2010.12.011, eqs. 6-8. */
#include "kernels.h"

#define SOURCE "Price 2012, doi:10.1016/j.jcp.2010.12.011, eqs. 6-8"

/* M_n(q) ~ sum_k (-1)^k binomial(n, k) max(0, n/2 - k - q)^(n-1), over the knots above 0 */
static const sph_kernel_term m4[] = {SPH_KERNEL_TERM(1, 2, 3), SPH_KERNEL_TERM(-4, 1, 3)};
static const sph_kernel_term m5[] = {SPH_KERNEL_TERM(1, 2.5, 4), SPH_KERNEL_TERM(-5, 1.5, 4),
                                     SPH_KERNEL_TERM(10, .5, 4)};
static const sph_kernel_term m6[] = {SPH_KERNEL_TERM(1, 3, 5), SPH_KERNEL_TERM(-6, 2, 5),
                                     SPH_KERNEL_TERM(15, 1, 5)};

static const sph_item item[N_BSPLINES] = {
    {
        .size = (uint32_t)sizeof(sph_item),
        .dims = SPH_ALL_DIMS,
        .name = "cubic-spline",
        .doc = "B-spline M4, support 2 h; pairs beyond about 55 neighbours in 3D",
        .source = SOURCE,
    },
    {
        .size = (uint32_t)sizeof(sph_item),
        .dims = SPH_ALL_DIMS,
        .name = "quartic-spline",
        .doc = "B-spline M5, support 2.5 h",
        .source = SOURCE,
    },
    {
        .size = (uint32_t)sizeof(sph_item),
        .dims = SPH_ALL_DIMS,
        .name = "quintic-spline",
        .doc = "B-spline M6, support 3 h",
        .source = SOURCE,
    },
};

const sph_kernel bspline[N_BSPLINES] = {
    {
        .size = (uint32_t)sizeof(sph_kernel),
        .item = &item[0],
        .support = 2,
        .norm = {0, 1. / 6, 5 / (14 * PI), 1 / (4 * PI)},
        .terms = {SPH_NO_LIST, SPH_LIST(m4), SPH_LIST(m4), SPH_LIST(m4)},
    },
    {
        .size = (uint32_t)sizeof(sph_kernel),
        .item = &item[1],
        .support = 2.5,
        .norm = {0, 1. / 24, 96 / (1199 * PI), 1 / (20 * PI)},
        .terms = {SPH_NO_LIST, SPH_LIST(m5), SPH_LIST(m5), SPH_LIST(m5)},
    },
    {
        .size = (uint32_t)sizeof(sph_kernel),
        .item = &item[2],
        .support = 3,
        .norm = {0, 1. / 120, 7 / (478 * PI), 1 / (120 * PI)},
        .terms = {SPH_NO_LIST, SPH_LIST(m6), SPH_LIST(m6), SPH_LIST(m6)},
    },
};
