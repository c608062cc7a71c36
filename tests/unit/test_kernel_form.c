/* test_kernel_form.c -- compiled kernels: the limits of the form, and tables of those that are given
 * as functions. The kernels themselves: test_kernels.c. */
#include "config.h"

#include "plugins.h"
#include "registry/kernel_form.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static struct registry registry;

static int load(void **state)
{
    (void)state;
    plugins_load(&registry, "kernels");
    return 0;
}

static int unload(void **state)
{
    (void)state;
    registry_fini(&registry);
    return 0;
}

static sph_kernel_form compiled(const char *name, int dim)
{
    const struct entry *x = plugins_find(&registry, KIND_KERNEL, name);
    sph_kernel_form f;
    struct error e = {0};

    if (kernel_form_make(&f, entry_kernel(x), dim, &e))
        fail_msg("%s", e.text);
    assert_int_equal(f.dim, dim);
    return f;
}

/* Terms in any order, of one knot or several, are put where they belong. */
static void terms_are_gathered_by_knot(void **state)
{
    static const sph_kernel_term terms[] = {
        {1, 1, 3, 0}, {2, 3, 5, 0}, {4, 1, 2, 0}, {8, 3, 5, 0}, {16, 2, 2, 0}};
    const sph_item item = {.name = "a", .dims = SPH_DIM2};
    const sph_kernel k = {.item = &item,
                          .support = 3,
                          .norm = {0, 0, .5, 0},
                          .terms = {SPH_NO_LIST, SPH_NO_LIST, SPH_LIST(terms), SPH_NO_LIST}};
    sph_kernel_form f;
    struct error e = {0};

    (void)state;
    assert_int_equal(kernel_form_make(&f, &k, 2, &e), 0);
    assert_int_equal(f.n_pieces, 3);
    assert_true(f.piece[0].knot == 3 && f.piece[1].knot == 2 && f.piece[2].knot == 1);
    assert_true(f.piece[0].power == 5 && f.piece[0].n_coef == 1 && f.piece[0].c[0] == 10);
    assert_true(f.piece[2].power == 2 && f.piece[2].n_coef == 2);
    assert_true(f.piece[2].c[0] == 4 && f.piece[2].c[1] == 1);
    assert_true(f.piece[2].dpower == 1 && f.piece[2].d[0] == -8 && f.piece[2].d[1] == -3);
    assert_true(fabs(kernel_form_w(&f, .5) -
                     .5 * (10 * pow(2.5, 5) + 16 * pow(1.5, 2) + 4 * .25 + .125)) < 1e-11);
    assert_int_not_equal(kernel_form_make(&f, &k, 3, &e), 0);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_string_equal(e.text, "kernel \"a\" does not work in 3 dimensions");
}

static void what_does_not_fit_is_refused(void **state)
{
    static const sph_kernel_term knots[] = {
        {1, 5, 3, 0}, {1, 4, 3, 0}, {1, 3, 3, 0}, {1, 2, 3, 0}, {1, 1, 3, 0}};
    static const sph_kernel_term powers[] = {{1, 2, 2, 0}, {1, 2, 8, 0}};
    const sph_item item = {.name = "a", .dims = SPH_DIM1 | SPH_DIM2};
    const sph_kernel k = {.item = &item,
                          .support = 5,
                          .norm = {0, 1, 1, 0},
                          .terms = {SPH_NO_LIST, SPH_LIST(knots), SPH_LIST(powers), SPH_NO_LIST}};
    sph_kernel_form f;
    struct error e = {0};

    (void)state;
    assert_int_not_equal(kernel_form_make(&f, &k, 1, &e), 0);
    assert_non_null(strstr(e.text, "more than 4 different knots"));
    assert_int_not_equal(kernel_form_make(&f, &k, 2, &e), 0);
    assert_non_null(strstr(e.text, "span the powers 2 to 8"));
}

/* -- Kernels given as functions ------------------------------------------------------------------- */

/* Wendland C2 with support 2, as a function: its table against the same kernel as data. */
static double wendland_value(double q, uint32_t dim)
{
    const double t = 1 - q / 2;

    return dim == 1 ? t * t * t * (1 + 1.5 * q) : t * t * t * t * (1 + 2 * q);
}

static double wendland_slope(double q, uint32_t dim)
{
    const double t = 1 - q / 2;

    return dim == 1 ? -3 * q * t * t : -5 * q * t * t * t;
}

static double steeper(double q, uint32_t dim)
{
    return 1.01 * wendland_slope(q, dim);
}

static double nothing(double q, uint32_t dim)
{
    (void)dim;
    return q > 1 ? NAN : 0;
}

static sph_kernel as_function;
static const sph_item as_function_item = {.size = sizeof(sph_item),
                                          .dims = SPH_ALL_DIMS,
                                          .name = "function",
                                          .doc = "a kernel given as a function"};

static sph_status register_function(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_KERNEL, &as_function);
}

static const sph_plugin *function_entry(void)
{
    static const sph_plugin plugin = {sizeof(sph_plugin),
                                      SPH_PLUGIN_MAGIC,
                                      SPH_ABI_MAJOR,
                                      SPH_ABI_MINOR,
                                      "functions",
                                      "1",
                                      "none",
                                      "a kernel",
                                      register_function,
                                      NULL};
    return &plugin;
}

static void reset_function(void)
{
    as_function = (sph_kernel){.size = sizeof(sph_kernel),
                               .item = &as_function_item,
                               .support = 2,
                               .norm = {0, 5. / 8, 7 / (4 * PI), 21 / (16 * PI)},
                               .value = wendland_value,
                               .slope = wendland_slope};
}

static void functions_are_tabulated(void **state)
{
    struct registry r;
    struct error e = {0};

    (void)state;
    reset_function();
    assert_int_equal(registry_init(&r, &e), 0);
    if (registry_add(&r, "/mock/functions.so", function_entry, NULL, NULL, &e))
        fail_msg("%s", e.text);
    for (int dim = 1; dim <= 3; dim++) {
        sph_kernel_form f, data = compiled("wendland-c2", dim);
        assert_int_equal(
            kernel_form_make(&f, entry_kernel(registry_find(&r, KIND_KERNEL, "function")), dim, &e),
            0);
        assert_true(f.n_pieces == 0 && f.n_table == KERNEL_FORM_CELLS && f.support == 2);
        for (int k = 0; k <= 20011; k++) {
            const double q = 2.2 * k / 20011;
            assert_true(fabs(kernel_form_w(&f, q) - kernel_form_w(&data, q)) < 1e-12);
            assert_true(fabs(kernel_form_dw(&f, q) - kernel_form_dw(&data, q)) < 1e-8);
        }
        assert_true(kernel_form_w(&f, NAN) == 0 && kernel_form_w(&f, 1e300) == 0);
        assert_true(kernel_form_w(&f, -1) == 0 && kernel_form_dw(&f, INFINITY) == 0);
        kernel_form_fini(&f);
    }
    registry_fini(&r);
}

static void function_refused(const char *text)
{
    struct registry r;
    struct error e = {0};

    assert_int_equal(registry_init(&r, &e), 0);
    assert_int_not_equal(registry_add(&r, "/mock/functions.so", function_entry, NULL, NULL, &e), 0);
    if (!strstr(e.text, text))
        fail_msg("says: %s\nin place of: %s", e.text, text);
    registry_fini(&r);
}

static void wrong_functions_are_refused(void **state)
{
    static const sph_kernel_term term = {1, 2, 3, 0};

    (void)state;
    reset_function();
    as_function.slope = steeper;
    function_refused("kernel \"function\": slope at q = 0.03125 in 1 dimensions is");
    reset_function();
    as_function.slope = NULL;
    function_refused("value is given, but slope is NULL");
    reset_function();
    as_function.value = NULL;
    function_refused("slope is given, but value is NULL");
    reset_function();
    as_function.norm[2] = 0.5;
    function_refused("integral in 2 dimensions is 0.89");
    reset_function();
    as_function.value = nothing;
    function_refused("value at q = 1.00098 in 1 dimensions is not finite");
    reset_function();
    as_function.terms[3] = (sph_list){&term, 1, sizeof(term)};
    function_refused("terms[3] and value are both given");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(terms_are_gathered_by_knot),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(functions_are_tabulated),
        cmocka_unit_test(wrong_functions_are_refused),
    };

    return cmocka_run_group_tests(tests, load, unload);
}
