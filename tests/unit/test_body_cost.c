/* test_body_cost.c -- operations counted in texts, against counts by hand. */
#include "opencl/body_cost.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* Counts are whole numbers. */
static void assert_count(double found, int expected)
{
    assert_int_equal((int)(found * 1000.0), expected * 1000);
}

static double flops(const char *text, int dim)
{
    return body_flops(&(struct body_text){.text = text, .dim = dim});
}

static void operators(void **state)
{
    (void)state;
    assert_count(flops("", 3), 0);
    assert_count(flops("R f = m_j * (p_i + p_j);", 3), 2);
    assert_count(flops("R a = -b; R c = a - b; c *= -a; c /= (-a);", 3), 3);
    assert_count(flops("k++; --k; x = y[k - 1] * 1e-3;", 3), 2);
    assert_count(flops("/* a + b */ x = a; // a * b\n#define N 3 + 4\ny = a / b;", 3), 1);
    assert_count(flops("if (a > b) x = a * b; else x = a / b;", 3), 2);
}

static void words(void **state)
{
    (void)state;
    assert_count(flops("sph_add(rho, m_j * sph_w(K, q));", 3), 1 + 1 + 8);
    assert_count(flops("x = sph_sqrt(a * a) + exp(b);", 3), 1 + 1 + 1 + 15);
    assert_count(flops("x = my_sph_add + sph_added;", 3), 1);
}

static void loops(void **state)
{
    (void)state;
    assert_count(
        flops("for (int c = 0; c < DIM; c++)\n    sph_add(v[c], w * dx[c]);\nx = a + b;", 3),
        3 * 2 + 1);
    assert_count(flops("for (int c = 0; c < DIM; c++)\n    sph_add(v[c], w * dx[c]);", 1), 2);
    assert_count(flops("for (int a = 0; a < DIM; a++) {\n    for (int b = 0; b < DIM; b++)\n"
                       "        g[a * DIM + b] = dx[a] * dx[b];\n    s += g[a];\n}\nt = u * v;",
                       2),
                 2 * 2 * 3 + 2 + 1);
    assert_count(flops("for (int n = 0; n <= 4; n++) x = x * y;", 3), 5);
    assert_count(flops("for (int n = 0; n < DIM * DIM; n++) x = x * y;", 3), 9);
    /* Nobody knows how often. */
    assert_count(flops("for (int n = 0; n < count; n++) x = x * y;", 3), 1);
}

static void macros(void **state)
{
    static const char prelude[] = "/* squares */\n"
                                  "#define SQUARE(a) ((a) * (a))\n"
                                  "#define BOTH(a, b) \\\n"
                                  "    (SQUARE(a) + \\\n"
                                  "     SQUARE(b))\n"
                                  "#define ROUNDS 4\n"
                                  "#define ENDLESS (1 + ENDLESS)\n";
    struct body_text b = {.prelude = prelude, .dim = 3};

    (void)state;
    b.text = "y = BOTH(x + 1.0, z);";
    assert_count(body_flops(&b), 1 + 1 + 2);
    b.text = "for (int n = 0; n <= ROUNDS; n++)\n    y = SQUARE(y);";
    assert_count(body_flops(&b), 5);
    b.text = "y = SQUARED(x);";
    assert_count(body_flops(&b), 0);
    b.text = "y = ENDLESS;";
    assert_true(body_flops(&b) < 100);
}

static void branches(void **state)
{
    static const struct body_known known[] = {{"limiter", 2}, {"riemann", 0}};
    struct body_text b = {.dim = 3, .known = known, .n_known = 2};

    (void)state;
    b.text = "if (limiter > 0.5) {\n    x = a * b; /* } */\n    y = a + b;\n}\nz = a - b;";
    assert_count(body_flops(&b), 3);
    b.text =
        "if (limiter < 0.5) {\n    x = a * b; /* } */\n    if (a) { y = a + b; }\n}\nz = a - b;";
    assert_count(body_flops(&b), 1);
    b.text = "if (riemann > 0.5)\n    x = a * b;\nelse\n    x = a + b - c;";
    assert_count(body_flops(&b), 2);
    b.text =
        "for (int c = 0; c < DIM; c++)\n    if (riemann > 0.5)\n        x[c] = a * b;\nz = a + b;";
    assert_count(body_flops(&b), 1);
    b.text = "if (riemannian > 0.5) x = a * b;";
    assert_count(body_flops(&b), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(operators), cmocka_unit_test(words),    cmocka_unit_test(loops),
        cmocka_unit_test(macros),    cmocka_unit_test(branches),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
