/* tests/unit/test_glass.c -- glasses: inside, even, the same again, in all dimensions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/glass.h"

#include <math.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

static struct glass make(int dim, size_t n, bool periodic, uint64_t seed, uint64_t sweeps)
{
    struct glass g = {.dim = dim, .n = n, .seed = seed, .sweeps = sweeps, .noise = 1e-9};
    struct error e = {0};
    for (int c = 0; c < dim; c++) {
        g.min[c] = -1 - c;
        g.max[c] = 1;
        g.periodic[c] = periodic;
    }
    if (glass_make(&g, &e) < 0)
        fail_msg("%s", e.text);
    return g;
}

/* Least distance of two points, in spacings; by all pairs. */
static double least_distance(const struct glass *g)
{
    double least = INFINITY, volume = 1;
    for (int c = 0; c < g->dim; c++)
        volume *= g->max[c] - g->min[c];
    for (size_t i = 0; i < g->n; i++)
        for (size_t j = 0; j < i; j++) {
            double r2 = 0;
            for (int c = 0; c < g->dim; c++)
                r2 += (g->x[c][i] - g->x[c][j]) * (g->x[c][i] - g->x[c][j]);
            least = fmin(least, r2);
        }
    return sqrt(least) / pow(volume / (double)g->n, 1. / g->dim);
}

static void test_even(void **state)
{
    static const size_t n[] = {0, 100, 900, 2000};
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int periodic = 0; periodic < 2; periodic++) {
            struct glass g = make(dim, n[dim], periodic, 5, 120);
            for (int c = 0; c < dim; c++)
                for (size_t i = 0; i < g.n; i++)
                    assert_true(g.x[c][i] >= g.min[c] && g.x[c][i] < g.max[c]);
            assert_true(g.reached < .02);
            assert_true(least_distance(&g) > .5);
            glass_free(&g);
        }
}

/* The same seed gives the same points, another one others. */
static void test_seeds(void **state)
{
    struct glass a = make(2, 400, true, 1, 60), b = make(2, 400, true, 1, 60),
                 c = make(2, 400, true, 2, 60);
    (void)state;
    for (int k = 0; k < 2; k++) {
        assert_memory_equal(a.x[k], b.x[k], 400 * sizeof(double));
        assert_true(memcmp(a.x[k], c.x[k], 400 * sizeof(double)) != 0);
    }
    glass_free(&a);
    glass_free(&b);
    glass_free(&c);
}

static void test_threads(void **state)
{
    (void)state;
#ifdef _OPENMP
    omp_set_num_threads(1);
    struct glass a = make(3, 1000, false, 1, 20);
    omp_set_num_threads(3);
    struct glass b = make(3, 1000, false, 1, 20);
    for (int k = 0; k < 3; k++)
        assert_memory_equal(a.x[k], b.x[k], 1000 * sizeof(double));
    assert_true(a.reached == b.reached);
    glass_free(&a);
    glass_free(&b);
#else
    skip();
#endif
}

static void test_few(void **state)
{
    (void)state;
    for (size_t n = 1; n < 6; n++)
        for (int dim = 1; dim <= 3; dim++)
            for (int periodic = 0; periodic < 2; periodic++) {
                struct glass g = make(dim, n, periodic, n, 50);
                for (int c = 0; c < dim; c++)
                    for (size_t i = 0; i < n; i++)
                        assert_true(g.x[c][i] >= g.min[c] && g.x[c][i] < g.max[c]);
                glass_free(&g);
            }
}

/* A long thin box has room for many more cells than it has points. */
static void test_thin(void **state)
{
    struct glass g = {
        .dim = 3, .n = 50, .seed = 1, .sweeps = 20, .noise = .01, .max = {1e9, 1, 1e-3}};
    struct error e;
    (void)state;
    assert_int_equal(glass_make(&g, &e), 0);
    assert_int_equal(g.done, 20);
    glass_free(&g);
}

/* It stops when it is even enough. */
static void test_stops(void **state)
{
    struct glass g = {.dim = 2, .n = 900, .seed = 1, .sweeps = 1000, .noise = .05, .max = {1, 1}};
    struct error e;
    (void)state;
    assert_int_equal(glass_make(&g, &e), 0);
    assert_true(g.reached <= .05 && g.done < 100);
    glass_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_even), cmocka_unit_test(test_seeds), cmocka_unit_test(test_threads),
        cmocka_unit_test(test_few),  cmocka_unit_test(test_thin),  cmocka_unit_test(test_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
