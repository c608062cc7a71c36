/* tests/unit/test_expression.c -- values, what is refused, and that nothing is printed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/expression.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const char *const names[] = {"x", "y", "z", "r"};

static double value(const char *text, double x, double y)
{
    struct expression *p;
    struct error e = {0};
    const double at[] = {x, y, 0, hypot(x, y)};
    if (expression_new(&p, text, names, 4, &e) < 0)
        fail_msg("%s", e.text);
    double result = expression_at(p, at);
    expression_free(p);
    return result;
}

static void test_values(void **state)
{
    (void)state;
    assert_true(value("-x/r", 3, 4) == -.6);
    assert_true(value("1e-6", 0, 0) == 1e-6);
    assert_true(value("r > 1 & r < 2", 1.5, 0) == 1);
    assert_true(value("r > 1 & r < 2", 3, 0) == 0);
    assert_true(value("r>1&r<2", 1.5, 0) == 1);
    assert_true(value("r > 1 && r < 2", 1.5, 0) == 1);
    assert_true(value("x < 0 | y < 0", 1, -1) == 1);
    assert_true(value("x < 0 | y < 0", 1, 1) == 0);
    assert_true(value("x < 0 || y < 0", 1, -1) == 1);
    assert_true(value("x < 0 | y < 0 & x > 2", -1, 1) == 1); /* & binds tighter */
    assert_true(value("!(x > 0)", 1, 0) == 0);
    assert_true(value("x != 1", 1, 0) == 0);
    assert_true(value("x < 0.5 ? 1 : 0.125", .2, 0) == 1);
    assert_true(value("x < 0.5 ? 1 : 0.125", .7, 0) == .125);
    assert_true(fabs(value("sin(pi*x)", .5, 0) - 1) < 1e-15);
    assert_true(value("max(x, y)^2", 3, 4) == 16);
    assert_true(isnan(value("0/x", 0, 0)));
    assert_true(isinf(value("1/x", 0, 0)));
    assert_true(value("x == 1", 1, 0) == 1);
    assert_true(value("x >= 1", 1, 0) == 1);
}

static bool is_told(const char *text)
{
    struct expression *p;
    struct error e = {0};
    if (expression_new(&p, text, names, 4, &e) < 0)
        fail_msg("%s: %s", text, e.text);
    char *c = expression_c(p, text, names, 4, "my_");
    const bool told = c != NULL;
    if (told && strstr(text, "x"))
        assert_non_null(strstr(c, "my_x"));
    free(c);
    expression_free(p);
    return told;
}

/* expression_c compares with the parser itself: what it tells is right. */
static void test_told(void **state)
{
    static const char *const told[] = {
        "1",
        " -x ^ 2 ",
        "2^-x",
        "2 ^ 3 ^ x",
        "-x * y - -y / 3",
        "1.5e-3 * (x + y) * z",
        "x < y == 0",
        "x < 0 | y < 0 & x > 2",
        "x < 0 || y < 0 && x > 2",
        "!(x > 0) + !y * 2",
        "!x != y",
        "x < 0 ? y < 0 ? 1 : 2 : x > 3 ? 3 : 4",
        "min(x, y, 3) + max(x) - sum(x, y, 1) / avg(x, y, z, 2)",
        "sin(pi * x) + cos(x) + tan(x) + atan(x) + atan2(y, x) + sinh(x) + cosh(x) + tanh(x) + asinh(x)",
        "asin(x) + acos(x) + acosh(abs(x) + 1) + atanh(x / 100)",
        "log(abs(x) + 1) + ln(abs(y) + 1) + log2(abs(x) + 2) + log10(abs(y) + 2) + exp(x / 50)",
        "sqrt(x) + sign(y) + abs(x)",
        "max(x, y)^2",
    };
    (void)state;
    for (size_t i = 0; i < COUNT(told); i++)
        if (!is_told(told[i]))
            fail_msg("not told: %s", told[i]);
    /* A constant of the parser's own that this knows nothing of. */
    assert_false(is_told("_e + x"));
}

static void test_uses(void **state)
{
    struct expression *p;
    struct error e;
    (void)state;
    assert_int_equal(expression_new(&p, "x + r", names, 4, &e), 0);
    assert_true(expression_uses(p, 0) && !expression_uses(p, 1) && expression_uses(p, 3));
    expression_free(p);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"", "empty"},
        {"  ", "empty"},
        {"x +", "ends too early"},
        {"(x", "ends too early"},
        {"x + q", "unknown name \"q\""},
        {"sqr(x)", "did you mean \"sqrt\"?"},
        {"x + * y", "column 5"},
        {"x)", "column 2"},
        {"x = 3", "\"==\" compares"},
        {"x, y", "2 values"},
        {"x $ y", "column 3"},
        {"\"x\"", "quotation mark"},
        {"x\n", "column 2"},
        {"\xc3\xa9", "column 1"},
        {"2 x", "column 3"},
        {"sin()", "column"},
        {"x ? 1", "ends too early"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct expression *p;
        struct error e = {0};
        if (expression_new(&p, cases[i].text, names, 4, &e) == 0)
            fail_msg("taken: %s", cases[i].text);
        assert_null(p);
        assert_int_equal(e.exit_code, EXIT_USAGE);
        if (!strstr(e.text, cases[i].part))
            fail_msg("\"%s\" does not hold \"%s\"", e.text, cases[i].part);
    }
}

static void test_long(void **state)
{
    struct expression *p;
    struct error e = {0};
    size_t n = 1 << 20;
    char *text = malloc(n + 1);
    (void)state;
    memset(text, '(', n);
    text[n] = '\0';
    assert_int_equal(expression_new(&p, text, names, 4, &e), -1);
    text[EXPRESSION_BYTES] = '\0';
    assert_int_equal(expression_new(&p, text, names, 4, &e), -1);
    memset(text, '-', EXPRESSION_BYTES - 1);
    strcpy(text + EXPRESSION_BYTES - 1, "x");
    if (expression_new(&p, text, names, 4, &e) == 0)
        expression_free(p);
    free(text);
}

/* muparser's errors come to us, and to no stream. */
static void test_quiet(void **state)
{
    struct expression *p;
    struct error e;
    (void)state;
    FILE *file = tmpfile();
    assert_non_null(file);
    fflush(stdout);
    fflush(stderr);
    int out = dup(1), err = dup(2);
    dup2(fileno(file), 1);
    dup2(fileno(file), 2);
    int status = expression_new(&p, "x + * q(", names, 4, &e);
    fflush(stdout);
    fflush(stderr);
    dup2(out, 1);
    dup2(err, 2);
    close(out);
    close(err);
    assert_int_equal(status, -1);
    assert_int_equal(lseek(fileno(file), 0, SEEK_END), 0);
    fclose(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),  cmocka_unit_test(test_told), cmocka_unit_test(test_uses),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_long), cmocka_unit_test(test_quiet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
