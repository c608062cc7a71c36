/* wendland.c -- Wendland's functions C2, C4, C6 with support 2 h, as powers of t = 2 - q, q = r /
 * h. W. Dehnen & H. Aly, MNRAS 425 (2012) 1068, doi:10.1111/j.1365-2966.2012.21439.x, table 1,
 * gives w(s) and its norm C for support 1; with s = 1 - q/2 = t/2, W = C 2^-d h^-d w. The functions
 * of one dimension are not those of two and three. */
#include "kernels.h"

#define SOURCE "Dehnen & Aly 2012, doi:10.1111/j.1365-2966.2012.21439.x, table 1"

/* coef s^power, s = t / 2; 2^-power is exact */
#define TERM(coef, power)                                                                          \
    {                                                                                              \
        (coef) / (double)(1 << (power)), 2, (power), 0                                             \
    }

/* In s: (1-s)^3 (1+3s) of table 1 is, with its s = 1 - ours, 4 s^3 - 3 s^4; and so on. */
static const sph_kernel_term c2_1d[] = {TERM(4, 3), TERM(-3, 4)};
static const sph_kernel_term c2[] = {TERM(5, 4), TERM(-4, 5)};
static const sph_kernel_term c4_1d[] = {TERM(14, 5), TERM(-21, 6), TERM(8, 7)};
static const sph_kernel_term c4[] = {TERM(56. / 3, 6), TERM(-88. / 3, 7), TERM(35. / 3, 8)};
static const sph_kernel_term c6_1d[] = {TERM(48, 7), TERM(-108, 8), TERM(82, 9), TERM(-21, 10)};
static const sph_kernel_term c6[] = {TERM(66, 8), TERM(-154, 9), TERM(121, 10), TERM(-32, 11)};

static const sph_item item[N_WENDLANDS] = {
    {
        .size = (uint32_t)sizeof(sph_item),
        .dims = SPH_ALL_DIMS,
        .name = "wendland-c2",
        .doc = "Wendland C2, support 2 h; never pairs",
        .source = SOURCE,
    },
    {
        .size = (uint32_t)sizeof(sph_item),
        .dims = SPH_ALL_DIMS,
        .name = "wendland-c4",
        .doc = "Wendland C4, support 2 h; never pairs",
        .source = SOURCE,
    },
    {
        .size = (uint32_t)sizeof(sph_item),
        .dims = SPH_ALL_DIMS,
        .name = "wendland-c6",
        .doc = "Wendland C6, support 2 h; never pairs",
        .source = SOURCE,
    },
};

const sph_kernel wendland[N_WENDLANDS] = {
    {
        .size = (uint32_t)sizeof(sph_kernel),
        .item = &item[0],
        .support = 2,
        .norm = {0, 5. / 4 / 2, 7 / PI / 4, 21 / (2 * PI) / 8},
        .terms = {SPH_NO_LIST, SPH_LIST(c2_1d), SPH_LIST(c2), SPH_LIST(c2)},
    },
    {
        .size = (uint32_t)sizeof(sph_kernel),
        .item = &item[1],
        .support = 2,
        .norm = {0, 3. / 2 / 2, 9 / PI / 4, 495 / (32 * PI) / 8},
        .terms = {SPH_NO_LIST, SPH_LIST(c4_1d), SPH_LIST(c4), SPH_LIST(c4)},
    },
    {
        .size = (uint32_t)sizeof(sph_kernel),
        .item = &item[2],
        .support = 2,
        .norm = {0, 55. / 32 / 2, 78 / (7 * PI) / 4, 1365 / (64 * PI) / 8},
        .terms = {SPH_NO_LIST, SPH_LIST(c6_1d), SPH_LIST(c6), SPH_LIST(c6)},
    },
};
