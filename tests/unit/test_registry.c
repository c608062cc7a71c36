/* test_registry.c -- what is registered: copies of today's size, names unique within their kind,
 * parameters of a use, reasons of failures. */
#include "config.h"

#include "mock.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A reader takes min(its size, the struct's size); whatever lies behind is not touched. */
static void small_and_large_structs_are_read(void **state)
{
    static struct {
        sph_prop prop;
        char later[24];
    } wide[2];
    struct registry r;
    struct error e = {0};
    const struct entry *x;
    const sph_prop *p;

    (void)state;
    mock_reset(KIND_EXACT);
    memset(wide, 0xff, sizeof(wide));
    wide[0].prop = mock.prop[0];
    wide[1].prop = mock.prop[1];
    mock.item.props = LIST_OF(wide);
    mock.plugin.license = mock.plugin.doc = NULL;
    assert_int_equal(registry_init(&r, &e), 0);
    assert_int_equal(registry_add(&r, MOCK_FILE, mock_entry, NULL, NULL, &e), 0);
    x = registry_find(&r, KIND_EXACT, "thing");
    assert_non_null(x);
    assert_int_equal(x->item->props.count, 2);
    assert_int_equal(x->item->props.stride, sizeof(sph_prop));
    p = x->item->props.data;
    assert_string_equal(p[1].name, "p");
    assert_string_equal(p[1].unit, "");
    assert_string_equal(x->item->source, "");
    assert_ptr_equal(entry_exact(x)->item, x->item);
    assert_string_equal(r.plugin[x->plugin].license, "");
    /* It is a copy: what becomes of the plugin's own is all the same. */
    memset(wide, 0, sizeof(wide));
    assert_string_equal(p[0].name, "rho");
    registry_fini(&r);
}

static void defaults_are_filled_in(void **state)
{
    struct registry r;
    struct error e = {0};

    (void)state;
    mock_reset(KIND_COUNT);
    assert_int_equal(registry_init(&r, &e), 0);
    assert_int_equal(registry_add(&r, MOCK_FILE, mock_entry, NULL, NULL, &e), 0);
    assert_true(entry_function(registry_find(&r, KIND_FUNCTION, "thing"))->reach_scale == 1);
    assert_int_equal(r.n_entry, KIND_COUNT);
    registry_fini(&r);
}

static void names_are_unique_within_their_kind(void **state)
{
    struct registry r;
    struct error e = {0};
    const char **names;
    size_t n;

    (void)state;
    mock_reset(KIND_EXACT);
    assert_int_equal(registry_init(&r, &e), 0);
    assert_int_equal(registry_add(&r, MOCK_FILE, mock_entry, NULL, NULL, &e), 0);
    assert_int_not_equal(registry_add(&r, "/other.so", mock_entry, NULL, NULL, &e), 0);
    assert_string_equal(e.text, "plugin /other.so: its name, \"mock\", is that of a plugin loaded "
                                "already, " MOCK_FILE);
    mock.plugin.name = "other";
    assert_int_not_equal(registry_add(&r, "/other.so", mock_entry, NULL, NULL, &e), 0);
    assert_string_equal(e.text, "plugin /other.so: exact solution \"thing\" is registered already, "
                                "by " MOCK_FILE);
    mock.kind = KIND_EOS;
    assert_int_equal(registry_add(&r, "/other.so", mock_entry, NULL, NULL, &e), 0);
    names = registry_names(&r, KIND_EOS, &n);
    assert_int_equal(n, 1);
    assert_string_equal(names[0], "thing");
    free((void *)names);
    assert_null(registry_find(&r, KIND_EOS, "nothing"));
    assert_null(registry_find(&r, KIND_KERNEL, "thing"));
    assert_int_not_equal(r.host.register_item(&r.host, SPH_KIND_EXACT, &mock.exact), SPH_OK);
    registry_fini(&r);
}

static void parameters_of_a_use(void **state)
{
    struct sph_config c;
    struct registry r;
    struct error e = {0};

    (void)state;
    mock_reset(KIND_COUNT);
    assert_int_equal(registry_init(&r, &e), 0);
    assert_int_equal(config_init(&c, &mock.item, &e), 0);
    assert_true(c.value[0] == 1.4 && c.value[1] == 1 && isnan(c.value[2]));
    assert_int_not_equal(config_check(&c, &e), 0);
    assert_string_equal(e.text, "parameter x0 of \"thing\" is missing: it has no default");
    assert_int_not_equal(config_set(&c, "gamma", 0.5, NULL, &e), 0);
    assert_string_equal(e.text, "gamma must lie between 1 and 10, not be 0.5");
    assert_int_not_equal(config_set(&c, "gamma", NAN, NULL, &e), 0);
    assert_int_not_equal(config_set(&c, "gamma", 0, "big", &e), 0);
    assert_string_equal(e.text, "gamma must be a number, not \"big\"");
    assert_int_not_equal(config_set(&c, "solver", 1, NULL, &e), 0);
    assert_int_not_equal(config_set(&c, "solver", 0, "hll", &e), 0);
    assert_string_equal(e.text, "solver is one of exact, hllc, not \"hll\"");
    assert_int_equal(config_set(&c, "solver", 0, "exact", &e), 0);
    assert_int_equal(config_set(&c, "x0", -1e9, NULL, &e), 0);
    assert_int_equal(config_check(&c, &e), 0);
    assert_int_not_equal(config_set(&c, "gamm", 2, NULL, &e), 0);
    assert_non_null(
        strstr(e.text, "\"thing\" has no parameter \"gamm\" (did you mean \"gamma\"?)"));
    assert_true(r.host.param(&c, "solver") == 0 && r.host.param(&c, "x0") == -1e9);
    assert_true(isnan(r.host.param(&c, "y0")) && isnan(r.host.param(NULL, "x0")));
    config_fini(&c);
    assert_int_equal(config_init(&c, &mock.plain_item, &e), 0);
    assert_int_not_equal(config_set(&c, "gamma", 2, NULL, &e), 0);
    assert_string_equal(e.text, "\"thing\" has no parameters");
    config_fini(&c);
    registry_fini(&r);
}

static void reasons_are_kept(void **state)
{
    struct registry r;
    struct error e = {0};
    char why[64];

    (void)state;
    assert_int_equal(registry_init(&r, &e), 0);
    /* in brackets: fail is a macro of cmocka's */
    assert_int_equal((r.host.fail)(&r.host, SPH_E_NUMERIC, "density of 7 is negative"),
                     SPH_E_NUMERIC);
    registry_reason(&r, SPH_E_NUMERIC, why, sizeof(why));
    assert_string_equal(why, "density of 7 is negative");
    registry_reason(&r, SPH_E_NOMEM, why, sizeof(why));
    assert_string_equal(why, "out of memory");
    registry_reason(&r, -77, why, sizeof(why));
    assert_string_equal(why, "status -77 (it gave no reason)");
    assert_null(r.host.extension(&r.host, "sph.nothing/0"));
    registry_fini(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_and_large_structs_are_read),
        cmocka_unit_test(defaults_are_filled_in),
        cmocka_unit_test(names_are_unique_within_their_kind),
        cmocka_unit_test(parameters_of_a_use),
        cmocka_unit_test(reasons_are_kept),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
