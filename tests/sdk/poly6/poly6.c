/* poly6.c -- two kernels: poly6, as data, and a Gaussian that ends at 3 h, as functions. And the
 * function that measures the moments of any kernel. README has the equations. */
#include <math.h>
#include <sph/kernel-value.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)
#define PI 3.14159265358979323846

/* With t = 2 - q: (1 - (q/2)^2)^3 = (t - t^2/4)^3, since 1 - q^2/4 = t (4 - t) / 4. */
static const sph_kernel_term terms[] = {
    SPH_KERNEL_TERM(1, 2, 3),
    SPH_KERNEL_TERM(-3. / 4, 2, 4),
    SPH_KERNEL_TERM(3. / 16, 2, 5),
    SPH_KERNEL_TERM(-1. / 64, 2, 6),
};

static const sph_item poly6_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "poly6",
    .doc = "(1 - (q/2)^2)^3, support 2 h",
    .source = "Mueller, Charypar & Gross 2003, doi:10.2312/SCA03/154-159, eq. 20",
};
static const sph_kernel poly6 = {
    .size = SIZE(sph_kernel),
    .item = &poly6_item,
    .support = 2,
    .norm = {0, 35. / 64, 1 / PI, 315 / (512 * PI)},
    .terms = {SPH_NO_LIST, SPH_LIST(terms), SPH_LIST(terms), SPH_LIST(terms)},
};

/* The Gaussian's norms are no constants of the language, and a descriptor is one: erf 3 and exp -9 as
 * numbers, which `moments` proves. */
#define ERF_3 0.99997790950300141456
#define EXP_9 1.2340980408667954949763669e-4
#define SQRT_PI 1.7724538509055160273

static double gauss_value(double q, uint32_t dim)
{
    (void)dim;
    return exp(-q * q);
}

static double gauss_slope(double q, uint32_t dim)
{
    (void)dim;
    return -2 * q * exp(-q * q);
}

static const sph_item gauss_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "gauss",
    .doc = "Gaussian, cut off at 3 h",
    .source = "Gingold & Monaghan 1977, doi:10.1093/mnras/181.3.375",
};
static const sph_kernel gauss = {
    .size = SIZE(sph_kernel),
    .item = &gauss_item,
    .support = 3,
    .norm = {0, 1 / (SQRT_PI * ERF_3), 1 / (PI * (1 - EXP_9)),
             1 / (PI * (SQRT_PI * ERF_3 - 6 * EXP_9))},
    .value = gauss_value,
    .slope = gauss_slope,
};

/* -- Moments: sums over the particles, as a scheme would sum them; and integrals over the kernel. The
 * scene puts its recipe together from this function alone. */

enum { M, LATTICE_0, LATTICE_2, LATTICE_SLOPE, INTEGRAL_0, INTEGRAL_2 };
static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass; density 1 is taken", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("lattice_0", "", "sum of m W", SPH_SCALAR, SPH_DST_SUM, 0),
    SPH_PROP("lattice_2", "", "sum of m W (r / h)^2", SPH_SCALAR, SPH_DST_SUM, 0),
    SPH_PROP("lattice_slope", "", "sum of -m r dW/dr / d: 1, by parts, up to the kernel's end",
             SPH_SCALAR, SPH_DST_SUM, 0),
    SPH_PROP("integral_0", "", "integral of W over space", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("integral_2", "", "integral of W (r / h)^2", SPH_SCALAR, SPH_DST_WRITE, 0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_J(S, V, M_) S(m, M)
#define SPH_LOOP_SUM(S, V, M_) S(s0, LATTICE_0) S(s2, LATTICE_2) S(slope, LATTICE_SLOPE)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "moments.body.h"
#include <sph/pair-loop.h>

/* Integral of W q^n over space, in units of h: Simpson's rule in q. */
static double integral(const sph_kernel_form *kernel, int n)
{
    const double shell[4] = {0, 2, 2 * PI, 4 * PI};
    const int cells = 2000;
    const double step = kernel->support / cells;
    double sum = 0;

    for (int k = 0; k <= cells; k++) {
        /* Up to the end from inside, where a kernel may jump. */
        const double q = k < cells ? k * step : nextafter(kernel->support, 0);
        const double weight = k == 0 || k == cells ? 1 : k % 2 ? 4 : 2;
        sum += weight * sph_kernel_w(kernel, q) * pow(q, (double)kernel->dim - 1 + n);
    }
    return sum * step / 3 * shell[kernel->dim];
}

static sph_status integrate(const sph_batch *b)
{
    const double zeroth = integral(b->kernel, 0), second = integral(b->kernel, 2);

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        ((double *)b->dst[INTEGRAL_0].data)[i] = zeroth;
        ((double *)b->dst[INTEGRAL_2].data)[i] = second;
    }
    return SPH_OK;
}

static const sph_item moments_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "moments",
    .doc = "moments of the scene's kernel: sums over a lattice, and integrals",
    .source = "README",
    .props = SPH_LIST(props),
};
static const sph_function moments = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &moments_item,
    .run = sweep,
    .after = integrate,
    .reach = SPH_GATHER,
    .reach_scale = 1,
};

static sph_status init(const sph_host *host)
{
    sph_status status = host->register_item(host, SPH_KIND_KERNEL, &poly6);

    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_KERNEL, &gauss);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_FUNCTION, &moments);
    return status;
}

SPH_PLUGIN("poly6", "0.1", "BSD-3-Clause", "the kernels poly6 and gauss", init, NULL)
