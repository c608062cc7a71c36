/* tests/unit/test_chart.c -- charts: fits, the front, ranges of axes, tables of CSV, numbers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "io/cells.h"
#include "chart/fit.h"
#include "chart/results.h"

#include <math.h>
#include <string.h>

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

static void fits_a_power(void **state)
{
    const double x[] = {1, 2, 4, 8, 16}, good[] = {3, 1.5, 0.75, 0.375, 0.1875};
    /* The same with points that are none, and two that lie evenly beside the line. */
    const double holes[] = {3, (double)NAN, 0.75, 0, 0.1875};
    const double noisy[] = {3 * 1.1, 1.5, 0.75 / 1.1 / 1.1, 0.375, 0.1875 * 1.1};
    double exponent, factor;
    (void)state;
    assert_true(fit_power(x, good, 5, &exponent, &factor));
    assert_true(fabs(exponent - (-1)) < 1e-12);
    assert_true(fabs(factor - (3)) < 1e-12);
    assert_true(fit_power(x, holes, 5, &exponent, &factor));
    assert_true(fabs(exponent - (-1)) < 1e-12);
    assert_true(fit_power(x, noisy, 5, &exponent, &factor));
    assert_true(fabs(exponent - (-1)) < 1e-12); /* the noise is even about the middle */
    assert_true(fabs(factor - (3)) < 1e-12);
}

static void fits_nothing_without_two_costs(void **state)
{
    const double x[] = {2, 2, 5}, y[] = {1, 3, -1};
    double exponent, factor;
    (void)state;
    assert_false(fit_power(x, y, 0, &exponent, &factor));
    assert_false(fit_power(x, y, 1, &exponent, &factor));
    assert_false(fit_power(x, y, 2, &exponent, &factor)); /* one cost */
    assert_false(fit_power(x, y, 3, &exponent, &factor)); /* and an error that is none */
}

static void finds_the_front(void **state)
{
    const double x[] = {5, 1, 2, 2, 3, 1, (double)NAN, 4}, y[] = {1, 9, 4, 3, 3, 9, 0, 2};
    const size_t expected[] = {1, 3, 7, 0};
    size_t front[COUNT(x)];
    (void)state;
    assert_int_equal(fit_front(x, y, COUNT(x), front), COUNT(expected));
    assert_memory_equal(front, expected, sizeof expected);
    assert_int_equal(fit_front(x, y, 0, front), 0);
}

/* Against its definition, over points of a simple generator. */
static void front_is_what_none_beats(void **state)
{
    double x[200], y[200];
    size_t front[200];
    uint32_t seed = 1;
    (void)state;
    for (size_t i = 0; i < 200; i++) {
        x[i] = (double)((seed = seed * 1664525u + 1013904223u) >> 26);
        y[i] = (double)((seed = seed * 1664525u + 1013904223u) >> 26);
    }
    const size_t n = fit_front(x, y, 200, front);
    assert_true(n > 1);
    for (size_t k = 1; k < n; k++) {
        assert_true(x[front[k]] > x[front[k - 1]]);
        assert_true(y[front[k]] < y[front[k - 1]]);
    }
    for (size_t i = 0; i < 200; i++) {
        bool covered = false;
        for (size_t k = 0; k < n; k++)
            covered = covered || (x[front[k]] <= x[i] && y[front[k]] <= y[i]);
        assert_true(covered);
    }
}

static void ranges_hold_the_data(void **state)
{
    const double data[][4] = {
        {0.012, 3.4, 0.01, 5}, {1, 1, 0.5, 2}, {2e-7, 9.9e-7, 1e-7, 2e-6}, {30, 40, 10, 100}};
    double first, last;
    (void)state;
    for (size_t i = 0; i < COUNT(data); i++) {
        fit_range(data[i][0], data[i][1], &first, &last);
        assert_true(fabs(first / data[i][2] - 1) < 1e-9);
        assert_true(fabs(last / data[i][3] - 1) < 1e-9);
    }
    for (double x = 1e-9; x < 1e9; x *= 1.37) {
        fit_range(x, 1.01 * x, &first, &last);
        assert_true(first < x && last > 1.01 * x && last >= 4 * first * (1 - 1e-12));
        assert_true(last <= 40 * first);
    }
}

static void reads_csv(void **state)
{
    static const char text[] = "# made by hand\nname,error\r\n\"a, \"\"b\"\"\nc\",1\n\n# more\n,\n";
    struct cells t;
    struct error e;
    (void)state;
    assert_int_equal(cells_parse(&t, "t.csv", text, strlen(text), &e), 0);
    assert_int_equal(t.n_column, 2);
    assert_int_equal(t.n_row, 2);
    assert_int_equal(cells_column(&t, "error"), 1);
    assert_true(cells_column(&t, "cost") == (size_t)-1);
    assert_string_equal(cells_at(&t, 0, 0), "a, \"b\"\nc");
    assert_string_equal(cells_at(&t, 0, 1), "1");
    assert_string_equal(cells_at(&t, 1, 1), "");
    assert_int_equal(t.line[0], 3);
    assert_int_equal(t.line[1], 7);
    cells_free(&t);
}

static void refuses_csv(void **state)
{
    static const struct {
        const char *text, *why;
    } bad[] = {{"", "t.csv: is empty"},
               {"# only\n", "t.csv: is empty"},
               {"a,b\n1,2\n1\n", "t.csv:3: 1 cells"},
               {"a,b\n1,\"2\n", "t.csv:3: the text's closing"},
               {"a\n\xff\n", "t.csv: is no text"}};
    struct cells t;
    struct error e;
    (void)state;
    for (size_t i = 0; i < COUNT(bad); i++) {
        assert_int_equal(cells_parse(&t, "t.csv", bad[i].text, strlen(bad[i].text), &e), -1);
        assert_memory_equal(e.text, bad[i].why, strlen(bad[i].why));
        assert_int_equal(e.exit_code, EXIT_USAGE);
    }
}

static void numbers_come_back(void **state)
{
    const double value[] = {0.1, 1.0 / 3, 1e300, -2.5e-308, 450, 0};
    char text[32];
    (void)state;
    for (size_t i = 0; i < COUNT(value); i++)
        assert_true(chart_number(results_number(text, value[i])) == value[i]);
    assert_string_equal(results_number(text, 0.1), "0.1");
    assert_string_equal(results_number(text, (double)NAN), "");
    assert_true(isnan(chart_number("kdk")));
    assert_true(isnan(chart_number("")));
    assert_true(isnan(chart_number("1x")));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fits_a_power),         cmocka_unit_test(fits_nothing_without_two_costs),
        cmocka_unit_test(finds_the_front),      cmocka_unit_test(front_is_what_none_beats),
        cmocka_unit_test(ranges_hold_the_data), cmocka_unit_test(reads_csv),
        cmocka_unit_test(refuses_csv),          cmocka_unit_test(numbers_come_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
