/* tests/unit/test_exact_sum.c -- sums without rounding: the same in any order, against sums that are known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/exact_sum.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static double number(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static int same(double a, double b)
{
    return (isnan(a) && isnan(b)) || (!(a < b) && !(a > b) && !isnan(a) && !isnan(b));
}

static double sum_of(const double *x, size_t n)
{
    struct exact_sum s = {{0}, 0, 0, 0, 0};
    for (size_t i = 0; i < n; i++)
        exact_add(&s, x[i]);
    return exact_value(&s);
}

static void known_sums(void **state)
{
    static const struct {
        double x[5], sum;
    } known[] = {{{0.0}, 0.0},
                 {{1.0, 2.0, -4.0}, -1.0},
                 {{0x1p1023, 1.0, -0x1p1023}, 1.0},
                 {{0x1p53, 1.0, 1.0, -0x1p53}, 2.0},
                 {{-0x1p1000, 0x1p-1074, 0x1p1000, 0x1p-1074}, 0x1p-1073},
                 {{DBL_MAX, DBL_MAX, -DBL_MAX}, DBL_MAX},
                 {{-DBL_MIN, DBL_MIN / 2}, -DBL_MIN / 2},
                 {{-0.1, -0.2, 0.1, 0.2}, 0.0},
                 {{DBL_MAX, DBL_MAX}, INFINITY},
                 {{-DBL_MAX, -DBL_MAX}, -INFINITY},
                 {{INFINITY, 1.0}, INFINITY},
                 {{-INFINITY, DBL_MAX}, -INFINITY},
                 {{INFINITY, -INFINITY}, NAN},
                 {{NAN, 1.0}, NAN}};
    (void)state;
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if (!same(sum_of(known[k].x, 5), known[k].sum))
            fail_msg("case %zu: %.17g, not %.17g", k, sum_of(known[k].x, 5), known[k].sum);
}

/* Numbers over many orders, with those that take them away again but for one. */
static void any_order(void **state)
{
    enum { N = 20001 };
    double *x = malloc(N * sizeof *x);
    uint64_t seed = 3;
    (void)state;
    assert_non_null(x);
    for (size_t i = 0; i + 1 < N; i += 2) {
        x[i] = ldexp(number(&seed) - 0.5, (int)(600.0 * number(&seed)) - 300);
        x[i + 1] = -x[i];
    }
    x[N - 1] = 0.7;
    for (int turn = 0; turn < 5; turn++) {
        for (size_t i = N - 1; i > 0; i--) {
            const size_t j = (size_t)(number(&seed) * (double)(i + 1));
            const double t = x[i];
            x[i] = x[j];
            x[j] = t;
        }
        assert_true(same(sum_of(x, N), 0.7));
    }
    free(x);
}

/* In parts, joined in any order, and long after carries should have been taken. */
static void parts(void **state)
{
    enum { PARTS = 7, EACH = 1000 };
    struct exact_sum part[PARTS] = {{{0}, 0, 0, 0, 0}}, up = {{0}, 0, 0, 0, 0},
                     down = {{0}, 0, 0, 0, 0}, whole = {{0}, 0, 0, 0, 0};
    uint64_t seed = 9;
    (void)state;
    for (int p = 0; p < PARTS; p++)
        for (int i = 0; i < EACH; i++) {
            const double x = (number(&seed) - 0.3) * pow(10.0, 60.0 * number(&seed) - 30.0);
            exact_add(&part[p], x);
            exact_add(&whole, x);
        }
    for (int p = 0; p < PARTS; p++) {
        exact_join(&up, &part[p]);
        exact_join(&down, &part[PARTS - 1 - p]);
    }
    assert_true(same(exact_value(&up), exact_value(&whole)));
    assert_true(same(exact_value(&down), exact_value(&whole)));
    assert_memory_equal(up.digit, down.digit, sizeof up.digit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(known_sums), cmocka_unit_test(any_order),
                                       cmocka_unit_test(parts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
