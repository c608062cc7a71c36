/* test_kernels.c -- the kernels of the plugin "kernels" in the form that pair loops evaluate: unit
 * integral, moments, derivative, norms and central values, against the formulas of the literature
 * written down here once more, in long double. */
#include "config.h"

#include "plugins.h"
#include "registry/kernel_form.h"

#include <complex.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define PI 3.14159265358979323846264338327950288L

/* What the cubics in a table's cells of 3/1024 h miss of exp(-q^2), whose fourth derivative is 12 at
 * 0, by W(0): 12 (3/1024)^4 / 384 = 2.3e-12. */
#define TABLE 2.4e-12L
/* Their mean over a cell is w (3/1024)^4 / 720, and int q^4 w dq = 64 int q^4 w dq: at most so
 * much of a second moment (3D). */
#define TABLE_MOMENT 6.6e-12L

typedef long double complex number;

/* -- The literature ------------------------------------------------------------------------------- */

/* B-splines as Price (2012), eqs. 6-8 has them. A complex q for the derivative: Im W(q + i e) / e is
 * dW/dq to rounding, without a difference of near numbers. */
static number power(number x, int n)
{
    number y = 1;

    while (n-- > 0)
        y *= x;
    return y;
}

static number above(long double knot, number q, int n)
{
    return creall(q) < knot ? power(knot - q, n) : 0;
}

static number cubic(number q, int dim)
{
    (void)dim;
    return above(2, q, 3) / 4 - above(1, q, 3);
}

static number quartic(number q, int dim)
{
    (void)dim;
    return above(2.5L, q, 4) - 5 * above(1.5L, q, 4) + 10 * above(.5L, q, 4);
}

static number quintic(number q, int dim)
{
    (void)dim;
    return above(3, q, 5) - 6 * above(2, q, 5) + 15 * above(1, q, 5);
}

/* Wendland's functions as in table 1 of Dehnen & Aly (2012), of r = q / 2. */
static number c2(number q, int dim)
{
    const number r = q / 2;

    return dim == 1 ? above(1, r, 3) * (1 + 3 * r) : above(1, r, 4) * (1 + 4 * r);
}

static number c4(number q, int dim)
{
    const number r = q / 2;

    return dim == 1 ? above(1, r, 5) * (1 + 5 * r + 8 * r * r)
                    : above(1, r, 6) * (1 + 6 * r + 35 * r * r / 3);
}

static number c6(number q, int dim)
{
    const number r = q / 2;

    return dim == 1 ? above(1, r, 7) * (1 + 7 * r + 19 * r * r + 21 * r * r * r)
                    : above(1, r, 8) * (1 + 8 * r + 25 * r * r + 32 * r * r * r);
}

static number gauss(number q, int dim)
{
    (void)dim;
    return creall(q) < 3 ? cexpl(-q * q) : 0;
}

/* The norms: B-splines of Price (2012), eqs. 6-8; of Wendland's functions, for a support of 1, of
 * Dehnen & Aly (2012), table 1. The Gaussian's are in the plugin's README. H / h of their table 1,
 * where h is twice the standard deviation of W along an axis: to 1.5e-6. */
static const struct known {
    const char *name;
    number (*w)(number q, int dim);
    long double support, norm[4], ratio[4];
    bool tabulated;
} kernels[] = {
    {"cubic-spline",
     cubic,
     2,
     {0, 2 / 3.0L, 10 / (7 * PI), 1 / PI},
     {0, 1.732051L, 1.778002L, 1.825742L},
     false},
    {"quartic-spline",
     quartic,
     2.5L,
     {0, 1 / 24.0L, 96 / (1199 * PI), 1 / (20 * PI)},
     {0, 1.936492L, 1.977173L, 2.018932L},
     false},
    {"quintic-spline",
     quintic,
     3,
     {0, 1 / 120.0L, 7 / (478 * PI), 1 / (120 * PI)},
     {0, 2.121321L, 2.158131L, 2.195775L},
     false},
    {"wendland-c2",
     c2,
     2,
     {0, 5 / 8.0L, 7 / (4 * PI), 21 / (16 * PI)},
     {0, 1.620185L, 1.897367L, 1.936492L},
     false},
    {"wendland-c4",
     c4,
     2,
     {0, 3 / 4.0L, 9 / (4 * PI), 495 / (256 * PI)},
     {0, 1.936492L, 2.171239L, 2.207940L},
     false},
    {"wendland-c6",
     c6,
     2,
     {0, 55 / 64.0L, 78 / (28 * PI), 1365 / (512 * PI)},
     {0, 2.207940L, 2.415230L, 2.449490L},
     false},
    {"gaussian", gauss, 3, {0}, {0}, true},
};
#define N_KERNELS (sizeof(kernels) / sizeof(kernels[0]))

/* Integrals of q^(dim-1) exp(-q^2) to 3, by parts. */
static long double norm_of(const struct known *k, int dim)
{
    const long double e9 = expl(-9), root = sqrtl(PI);

    if (!k->tabulated)
        return k->norm[dim];
    return 1 / (dim == 1   ? root * erfl(3)
                : dim == 2 ? PI * (1 - e9)
                           : PI * root * erfl(3) - 6 * PI * e9);
}

/* -- Quadrature ----------------------------------------------------------------------------------- */

#define POINTS 10
static long double node[POINTS], weight[POINTS];

/* Gauss and Legendre, exact for polynomials up to degree 19. */
static void make_rule(void)
{
    for (int i = 0; i < POINTS; i++) {
        long double z = cosl(PI * (i + .75L) / (POINTS + .5L)), slope = 1;

        for (int step = 0; step < 100; step++) {
            long double p1 = 1, p2 = 0;
            for (int j = 0; j < POINTS; j++) {
                const long double p3 = p2;
                p2 = p1;
                p1 = ((2 * j + 1) * z * p2 - j * p3) / (j + 1);
            }
            slope = POINTS * (z * p1 - p2) / (z * z - 1);
            z -= p1 / slope;
        }
        node[i] = z;
        weight[i] = 2 / ((1 - z * z) * slope * slope);
    }
}

typedef long double integrand(const void *of, long double q);

static long double of_form(const void *of, long double q)
{
    return kernel_form_w(of, (double)q);
}

struct book {
    const struct known *kernel;
    int dim;
};

static long double of_book(const void *of, long double q)
{
    const struct book *b = of;

    return norm_of(b->kernel, b->dim) * creall(b->kernel->w(q, b->dim));
}

/* Integral over space of q^order W, in `parts` pieces: knots (multiples of 1/2) and the ends of a
 * table's cells lie between them. */
static long double moment(integrand *w, const void *of, long double support, int dim, int order,
                          int parts)
{
    static const long double area[4] = {0, 2, 2 * PI, 4 * PI};
    long double sum = 0;

    for (int p = 0; p < parts; p++) {
        const long double half = support / (2 * parts), middle = (2 * p + 1) * half;
        for (int i = 0; i < POINTS; i++) {
            const long double q = middle + half * node[i];
            sum += half * weight[i] * w(of, q) * powl(q, dim - 1 + order);
        }
    }
    return area[dim] * sum;
}

static int parts_of(const struct known *k)
{
    return k->tabulated ? (int)KERNEL_FORM_CELLS : (int)(2 * k->support + .5L);
}

/* -- Tests ---------------------------------------------------------------------------------------- */

static struct registry registry;

static int load(void **state)
{
    (void)state;
    make_rule();
    plugins_load(&registry, "kernels");
    return 0;
}

static int unload(void **state)
{
    (void)state;
    registry_fini(&registry);
    return 0;
}

/* Calls `test` for every kernel in every dimension. */
static void for_all(void (*test)(const struct known *k, int dim, const sph_kernel_form *f))
{
    for (size_t i = 0; i < N_KERNELS; i++) {
        for (int dim = 1; dim <= 3; dim++) {
            const struct entry *x = plugins_find(&registry, KIND_KERNEL, kernels[i].name);
            sph_kernel_form f;
            struct error e = {0};

            if (kernel_form_make(&f, entry_kernel(x), dim, &e))
                fail_msg("%s", e.text);
            assert_int_equal(f.dim, dim);
            test(&kernels[i], dim, &f);
            kernel_form_fini(&f);
        }
    }
}

/* A figure and its bar, for the log. */
static void within(const struct known *k, int dim, const char *what, long double error,
                   long double bar)
{
    print_message("%s in %d dimensions: %s off by %.1Le (bar %.0Le)\n", k->name, dim, what,
                  fabsl(error), bar);
    assert_true(fabsl(error) <= bar);
}

static void integral(const struct known *k, int dim, const sph_kernel_form *f)
{
    within(k, dim, "integral", moment(of_form, f, k->support, dim, 0, parts_of(k)) - 1, 1e-12L);
}

static void integrates_to_1(void **state)
{
    (void)state;
    for_all(integral);
}

/* The first moment of W along an axis: over both signs it vanishes since loops evaluate W at |r|; so
 * does that of the slope's along the axes across. What is left to try is that of q, and the second. */
static void moments(const struct known *k, int dim, const sph_kernel_form *f)
{
    const struct book b = {k, dim};

    for (int order = 1; order <= 2; order++) {
        const long double got = moment(of_form, f, k->support, dim, order, parts_of(k));
        const long double want =
            moment(of_book, &b, k->support, dim, order, (int)(12 * k->support + .5L));
        within(k, dim, order == 1 ? "moment of q" : "second moment", got / want - 1,
               k->tabulated ? TABLE_MOMENT : 1e-12L);
    }
}

static void has_the_moments_of_the_literature(void **state)
{
    (void)state;
    for_all(moments);
}

/* sum_x x W(|x|) over a cloud with its mirror image is 0 to the last bit: W has no side. */
static void sides(const struct known *k, int dim, const sph_kernel_form *f)
{
    double sum = 0;

    (void)dim;
    for (double x = .01; x < (double)k->support; x += .05)
        sum += x * kernel_form_w(f, fabs(x)) + -x * kernel_form_w(f, fabs(-x));
    assert_true(sum == 0);
}

static void first_moment_vanishes(void **state)
{
    (void)state;
    for_all(sides);
}

static void width(const struct known *k, int dim, const sph_kernel_form *f)
{
    const long double second = moment(of_form, f, k->support, dim, 2, parts_of(k));
    const long double sigma = sqrtl(second / dim);

    if (k->tabulated) {
        /* int q^2 W by parts, the cut's own term with it: dim / 2 - 3^dim e^-9 area norm / 2. */
        static const long double area[4] = {0, 2, 2 * PI, 4 * PI};
        const long double cut = area[dim] * norm_of(k, dim) * powl(3, dim) * expl(-9) / 2;
        within(k, dim, "closed second moment", second - (dim / 2.0L - cut), TABLE_MOMENT);
    } else {
        within(k, dim, "H/h of the table", k->support / (2 * sigma) - k->ratio[dim], 2e-6L);
    }
}

static void has_the_width_of_the_literature(void **state)
{
    (void)state;
    for_all(width);
}

static void centre(const struct known *k, int dim, const sph_kernel_form *f)
{
    const long double w0 = norm_of(k, dim) * creall(k->w(0, dim));

    within(k, dim, "W(0)", kernel_form_w(f, 0) / w0 - 1, 2e-14L);
    within(k, dim, "W'(0)", kernel_form_dw(f, 0), 1e-13L);
}

static void has_the_central_value_of_the_literature(void **state)
{
    (void)state;
    for_all(centre);
}

/* Whole shape and derivative, relative to W(0). The bar of a table's slope is what a cubic of cells
 * of 3/1024 h gives: 12 (3/1024)^3 3^.5 / 216 = 2.42e-9 of W(0). */
static void shape(const struct known *k, int dim, const sph_kernel_form *f)
{
    const long double w0 = norm_of(k, dim) * creall(k->w(0, dim)), e = 1e-20L;
    long double value = 0, slope = 0;

    for (long double q = .00137L; q < k->support - .0001L; q += .00371L) {
        const number w = norm_of(k, dim) * k->w((double)q + e * I, dim);
        value = fmaxl(value, fabsl(kernel_form_w(f, (double)q) - creall(w)));
        slope = fmaxl(slope, fabsl(kernel_form_dw(f, (double)q) - cimagl(w) / e));
    }
    within(k, dim, "W", value / w0, k->tabulated ? TABLE : 1e-13L);
    within(k, dim, "dW/dq", slope / w0, k->tabulated ? 2.5e-9L : 1e-12L);
}

static void is_the_function_of_the_literature(void **state)
{
    (void)state;
    for_all(shape);
}

/* The derivative against the function's own differences, of the form alone: Richardson's
 * extrapolation of central ones, away from the knots. */
static void differences(const struct known *k, int dim, const sph_kernel_form *f)
{
    const double d = k->tabulated ? 1e-2 : 2e-3;
    double worst = 0;

    for (double q = .1; q < (double)k->support - .1; q += .037) {
        const double near = (kernel_form_w(f, q + d / 2) - kernel_form_w(f, q - d / 2)) / d;
        const double far = (kernel_form_w(f, q + d) - kernel_form_w(f, q - d)) / (2 * d);
        const double half = fmod(q + d, .5);
        if (half > 2 * d)
            worst = fmax(worst, fabs(kernel_form_dw(f, q) - (4 * near - far) / 3));
    }
    within(k, dim, "dW/dq of differences", worst / kernel_form_w(f, 0),
           k->tabulated ? 5e-9L : 1e-9L);
}

static void derivative_is_that_of_the_function(void **state)
{
    (void)state;
    for_all(differences);
}

static void end(const struct known *k, int dim, const sph_kernel_form *f)
{
    const double support = (double)k->support, jump = k->tabulated ? exp(-9) : 0;

    (void)dim;
    assert_true(f->support == support);
    assert_true(kernel_form_w(f, support) == 0 && kernel_form_dw(f, support) == 0);
    assert_true(kernel_form_w(f, 9) == 0 && kernel_form_dw(f, 9) == 0);
    assert_true(fabs(kernel_form_w(f, support - 1e-9) / kernel_form_w(f, 0) - jump) < 1e-12);
    for (double q = 0; q < support - 1e-3; q += .01)
        assert_true(kernel_form_w(f, q) > 0 && kernel_form_dw(f, q) <= 1e-15);
}

static void ends_at_its_support(void **state)
{
    (void)state;
    for_all(end);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integrates_to_1),
        cmocka_unit_test(has_the_moments_of_the_literature),
        cmocka_unit_test(first_moment_vanishes),
        cmocka_unit_test(has_the_width_of_the_literature),
        cmocka_unit_test(has_the_central_value_of_the_literature),
        cmocka_unit_test(is_the_function_of_the_literature),
        cmocka_unit_test(derivative_is_that_of_the_function),
        cmocka_unit_test(ends_at_its_support),
    };

    return cmocka_run_group_tests(tests, load, unload);
}
