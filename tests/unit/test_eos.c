/* test_eos.c -- the plugin "eos": values, inverse, speed of sound along an isentrope. */
#include "config.h"

#include "plugins.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define N 50

static struct registry registry;

static int load(void **state)
{
    (void)state;
    plugins_load(&registry, "eos");
    return 0;
}

static int unload(void **state)
{
    (void)state;
    registry_fini(&registry);
    return 0;
}

static void run_gas(double gamma, double *rho, double *u, double *p, double *cs)
{
    const sph_eos *eos = entry_eos(plugins_find(&registry, KIND_EOS, "ideal-gas"));
    const char *const names[] = {"gamma", NULL};
    struct trial use;

    trial_init(&use, &registry, eos->item, eos->life, &eos->item->props, 2, names, &gamma);
    use_column(&use, 0, rho, N);
    use_column(&use, 1, u, N);
    use_column(&use, 2, p, N);
    use_column(&use, 3, cs, N);
    assert_int_equal(use_run(&use, eos->run, 0, N), SPH_OK);
    trial_fini(&use);
}

static void inverse_undoes_the_run(void **state)
{
    const sph_eos *eos = entry_eos(plugins_find(&registry, KIND_EOS, "ideal-gas"));
    double rho[N], u[N], p[N], cs[N], back[N];
    struct trial use;

    (void)state;
    for (int i = 0; i < N; i++) {
        rho[i] = pow(10, i / 10. - 2);
        u[i] = pow(10, 3 - i / 7.);
    }
    run_gas(5. / 3, rho, u, p, cs);
    trial_init(&use, &registry, eos->item, eos->life, &eos->inverse_props, 2, NULL, NULL);
    use_column(&use, 0, rho, N);
    use_column(&use, 1, p, N);
    use_column(&use, 2, back, N);
    assert_int_equal(use_run(&use, eos->inverse, 0, N), SPH_OK);
    trial_fini(&use);
    for (int i = 0; i < N; i++) {
        assert_true(fabs(p[i] / (2. / 3 * rho[i] * u[i]) - 1) < 1e-15);
        assert_true(fabs(back[i] / u[i] - 1) < 4e-16);
    }
}

/* p ~ rho^gamma: c^2 = dp / drho by differences; du = p d rho / rho^2 holds as well. */
static void sound_is_the_slope_of_an_isentrope(void **state)
{
    const double gamma = 1.4, d = 1e-3;
    double rho[N], u[N], p[N], cs[N];

    (void)state;
    for (int i = 0; i < N; i++) {
        rho[i] = 1 + d * i;
        u[i] = 2.5 * pow(rho[i], gamma - 1);
    }
    run_gas(gamma, rho, u, p, cs);
    for (int i = 1; i + 1 < N; i++) {
        const double slope = (p[i + 1] - p[i - 1]) / (2 * d);
        const double work = (u[i + 1] - u[i - 1]) / (2 * d);
        assert_true(fabs(cs[i] * cs[i] / slope - 1) < 1e-6);
        assert_true(fabs(work / (p[i] / (rho[i] * rho[i])) - 1) < 1e-6);
    }
}

static void cold_and_undershot_gas_is_silent(void **state)
{
    double rho[N] = {0}, u[N] = {0}, p[N], cs[N];

    (void)state;
    for (int i = 0; i < N; i++)
        rho[i] = 1;
    u[1] = -1e-3;
    run_gas(1.4, rho, u, p, cs);
    assert_true(p[0] == 0 && cs[0] == 0);
    assert_true(p[1] < 0 && cs[1] == 0);
}

static void single_precision_is_declined(void **state)
{
    const sph_eos *eos = entry_eos(plugins_find(&registry, KIND_EOS, "ideal-gas"));
    struct trial use;
    char why[256];

    (void)state;
    trial_init(&use, &registry, eos->item, eos->life, &eos->item->props, 2, NULL, NULL);
    use.batch.real = SPH_F32;
    assert_int_equal(use_run(&use, eos->run, 0, 0), SPH_E_INVALID);
    registry_reason(&registry, SPH_E_INVALID, why, sizeof(why));
    assert_non_null(strstr(why, "for doubles"));
    trial_fini(&use);
}

static void gamma_is_checked(void **state)
{
    const sph_eos *eos = entry_eos(plugins_find(&registry, KIND_EOS, "ideal-gas"));
    struct sph_config c;
    struct error e = {0};

    (void)state;
    assert_int_equal(config_init(&c, eos->item, &e), 0);
    assert_true(fabs(c.value[0] - 5. / 3) < 1e-15);
    assert_int_not_equal(config_set(&c, "gamma", 1, NULL, &e), 0);
    assert_int_not_equal(config_set(&c, "gama", 1.4, NULL, &e), 0);
    assert_non_null(strstr(e.text, "did you mean \"gamma\""));
    config_fini(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inverse_undoes_the_run),
        cmocka_unit_test(sound_is_the_slope_of_an_isentrope),
        cmocka_unit_test(cold_and_undershot_gas_is_silent),
        cmocka_unit_test(single_precision_is_declined),
        cmocka_unit_test(gamma_is_checked),
    };

    return cmocka_run_group_tests(tests, load, unload);
}
