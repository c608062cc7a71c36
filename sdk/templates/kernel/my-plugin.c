/* my-plugin.c -- Lucy's kernel, the first of SPH: with s = r / (2 h),
 *
 *   W ~ (1 + 3 s) (1 - s)^3,      0 <= s <= 1.
 *
 * Source: L. B. Lucy, Astron. J. 82 (1977) 1013, doi:10.1086/112164. */
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)
#define PI 3.14159265358979323846

/* A kernel is data where it can be, which makes it fast: a sum of terms coef max(0, knot - q)^power
 * of q = r / h. Every spline and every function of Wendland has that form. With t = 2 - q, which is
 * 2 (1 - s), Lucy's is
 *   (1 + 3 s) (1 - s)^3 = 4 (1 - s)^3 - 3 (1 - s)^4 = 4 (t / 2)^3 - 3 (t / 2)^4. */
static const sph_kernel_term terms[] = {
    SPH_KERNEL_TERM(4. / 8, 2, 3), /* coef, knot, power */
    SPH_KERNEL_TERM(-3. / 16, 2, 4),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin",
    .doc = "Lucy's kernel, support 2 h",
    .source = "Lucy 1977, doi:10.1086/112164",
};
static const sph_kernel kernel = {
    .size = SIZE(sph_kernel),
    .item = &item,
    .support = 2, /* in units of h */
    /* Of one, two and three dimensions: the integral is 1. The host checks that, and derives the
     * slope. For a kernel of another form, `value` and `slope` are functions: sph/kernel.h. */
    .norm = {0, 5. / 8, 5 / (4 * PI), 105 / (128 * PI)},
    .terms = {SPH_NO_LIST, SPH_LIST(terms), SPH_LIST(terms), SPH_LIST(terms)},
};

/* Called once, when the plugin is loaded. It registers, and does nothing else. */
static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_KERNEL, &kernel);
}

/* The one symbol that the plugin exports: name, version, licence, what it is, init, fini. */
SPH_PLUGIN("my-plugin", "0.1", "BSD-3-Clause", "Lucy's smoothing kernel", init, NULL)
