/* test_exact.c -- the plugin "exact" against tables of another program (tests/reference), closed
 * forms and the conservation laws. */
#include "config.h"

#include "plugins.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct registry registry;

static int load(void **state)
{
    (void)state;
    plugins_load(&registry, "exact");
    return 0;
}

static int unload(void **state)
{
    (void)state;
    registry_fini(&registry);
    return 0;
}

/* A Riemann problem: parameters in declared order. */
struct problem {
    double rho_l, u_l, p_l, rho_r, u_r, p_r, gamma, x0;
};
static const char *const problem_names[] = {"rho_l", "u_l",   "p_l", "rho_r", "u_r",
                                            "p_r",   "gamma", "x0",  NULL};

/* Fields at n places, of `dim` components of x and v each. */
struct fields {
    double *x, *rho, *p, *v, *u;
    int dim;
    uint64_t n;
};

static struct fields fields_new(int dim, uint64_t n)
{
    struct fields f = {.dim = dim, .n = n};
    const uint64_t planes = 2 * (uint64_t)dim + 3;
    double *all = calloc(planes * n, sizeof(*all));

    assert_non_null(all);
    f.x = all;
    f.v = f.x + (uint64_t)dim * n;
    f.rho = f.v + (uint64_t)dim * n;
    f.p = f.rho + n;
    f.u = f.p + n;
    return f;
}

static void solve(const char *name, const char *const *names, const double *values, double time,
                  struct fields *f)
{
    const sph_exact *exact = entry_exact(plugins_find(&registry, KIND_EXACT, name));
    struct trial use;

    trial_init(&use, &registry, exact->item, exact->life, &exact->item->props, f->dim, names,
               values);
    use_column(&use, 0, f->x, f->n);
    use_column(&use, 1, f->rho, f->n);
    use_column(&use, 2, f->p, f->n);
    use_column(&use, 3, f->v, f->n);
    use_column(&use, 4, f->u, f->n);
    assert_int_equal(use_run(&use, exact->run, time, f->n), SPH_OK);
    trial_fini(&use);
}

static void riemann(const struct problem *p, double time, struct fields *f)
{
    solve("riemann", problem_names, &p->rho_l, time, f);
}

static void near(double got, double wanted, double tolerance)
{
    if (!(fabs(got - wanted) <= tolerance * fmax(1, fabs(wanted))))
        fail_msg("%.12g, not %.12g", got, wanted);
}

static void compare_with_table(const struct problem *problem, double time, const char *file)
{
    int columns, rows;
    double *table = plugins_table(file, &columns, &rows);
    struct fields f = fields_new(1, (uint64_t)rows);

    assert_int_equal(columns, 5); /* x, rho, u, p, e */
    for (int i = 0; i < rows; i++)
        f.x[i] = table[i * columns];
    riemann(problem, time, &f);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        near(f.rho[i], row[1], 2e-9);
        near(f.v[i], row[2], 2e-9);
        near(f.p[i], row[3], 2e-9);
        near(f.u[i], row[4], 2e-9);
    }
    free(f.x);
    free(table);
}

static void sods_tube(void **state)
{
    const struct problem p = {1, 0, 1, .125, 0, .1, 1.4, .5};

    (void)state;
    compare_with_table(&p, .2, "riemann_sod.csv");
}

static void toros_123(void **state)
{
    const struct problem p = {1, -2, .4, 1, 2, .4, 1.4, .5};

    (void)state;
    compare_with_table(&p, .15, "riemann_toro2_123.csv");
}

/* p*, u*, rho* left and right of the five tests of Toro 2009, table 4.2; sampled beside the
 * contact, far from its rounding. */
static void toros_star_states(void **state)
{
    static const struct {
        struct problem problem;
        double p, u, rho_l, rho_r, tolerance;
    } tests[] = {
        {{1, 0, 1, .125, 0, .1, 1.4, 0}, .3031301781, .92745262, .4263194282, .2655737117, 1e-9},
        {{1, -2, .4, 1, 2, .4, 1.4, 0}, .00189387342, 0, .02185211821, .02185211821, 1e-9},
        {{1, 0, 1000, 1, 0, .01, 1.4, 0}, 460.894, 19.5975, .57506, 5.99924, 1e-5},
        {{1, 0, .01, 1, 0, 100, 1.4, 0}, 46.0950, -6.19633, 5.99242, .57511, 1e-5},
        {{5.99924, 19.5975, 460.894, 5.99242, -6.19633, 46.0950, 1.4, 0},
         1691.64,
         8.68975,
         14.2823,
         31.0426,
         1e-5},
    };

    (void)state;
    for (size_t k = 0; k < sizeof(tests) / sizeof(tests[0]); k++) {
        struct fields f = fields_new(1, 2);
        f.x[0] = tests[k].u - 1e-3;
        f.x[1] = tests[k].u + 1e-3;
        riemann(&tests[k].problem, 1, &f);
        if (k != 1) { /* there the contact does not jump, and the tangent of the fan is near */
            near(f.rho[0], tests[k].rho_l, tests[k].tolerance);
            near(f.rho[1], tests[k].rho_r, tests[k].tolerance);
        }
        for (int i = 0; i < 2; i++) {
            near(f.p[i], tests[k].p, tests[k].tolerance);
            near(f.v[i], tests[k].u, tests[k].tolerance);
        }
        free(f.x);
    }
}

/* What is in [-1, 1] at the end is what was there, and what has flowed in: the states are uniform
 * at both ends until a wave arrives. Vacuum, cold gas and strong shocks alike. */
static void mass_momentum_and_energy_are_conserved(void **state)
{
    static const struct problem problems[] = {
        {1, 0, 1, .125, 0, .1, 1.4, 0},  {1, -2, .4, 1, 2, .4, 1.4, 0},
        {1, 0, 1000, 1, 0, .01, 1.4, 0}, {1, 1, 0, 1, -1, 0, 5. / 3, 0},
        {1, 0, 1, 0, 0, 0, 1.4, 0},      {0, 0, 0, 1, 0, 1, 1.4, 0},
        {1, -9, 1, 2, 8, 1, 1.4, 0},     {1, 0, 0, 1, -1, 1, 1.4, 0},
        {2, .3, 1, 1, .3, 1, 1.4, 0},
    };
    const uint64_t n = 200000;

    (void)state;
    for (size_t k = 0; k < sizeof(problems) / sizeof(problems[0]); k++) {
        const struct problem *p = &problems[k];
        const double fastest =
            fmax(fabs(p->u_l), fabs(p->u_r)) + 8 * sqrt(fmax(p->p_l, p->p_r)) + 1;
        const double t = 1 / fastest;
        const double e_l = p->p_l / (p->gamma - 1) + p->rho_l * p->u_l * p->u_l / 2;
        const double e_r = p->p_r / (p->gamma - 1) + p->rho_r * p->u_r * p->u_r / 2;
        const double wanted[3] = {
            p->rho_l + p->rho_r + t * (p->rho_l * p->u_l - p->rho_r * p->u_r),
            p->rho_l * p->u_l + p->rho_r * p->u_r +
                t * (p->rho_l * p->u_l * p->u_l + p->p_l - p->rho_r * p->u_r * p->u_r - p->p_r),
            e_l + e_r + t * ((e_l + p->p_l) * p->u_l - (e_r + p->p_r) * p->u_r)};
        double sum[3] = {0};
        struct fields f = fields_new(1, n);
        for (uint64_t i = 0; i < n; i++)
            f.x[i] = -1 + 2 * ((double)i + .5) / (double)n;
        riemann(p, t, &f);
        for (uint64_t i = 0; i < n; i++) {
            assert_true(f.rho[i] >= 0 && f.p[i] >= 0 && isfinite(f.v[i]));
            sum[0] += f.rho[i] * 2 / (double)n;
            sum[1] += f.rho[i] * f.v[i] * 2 / (double)n;
            sum[2] += f.rho[i] * (f.u[i] + f.v[i] * f.v[i] / 2) * 2 / (double)n;
        }
        for (int c = 0; c < 3; c++)
            assert_true(fabs(sum[c] - wanted[c]) < 1e-4 * (e_l + e_r + p->rho_l + p->rho_r));
        free(f.x);
    }
}

/* Gas into a vacuum: the closed form of Toro 2009, section 4.6. */
static void expansion_into_a_vacuum(void **state)
{
    const struct problem p = {1, 0, 1, 0, 0, 0, 1.4, 0};
    const double a = sqrt(1.4);
    struct fields f = fields_new(2, 100);

    (void)state;
    for (uint64_t i = 0; i < f.n; i++)
        f.x[i] = -2 + .1 * (double)i;
    riemann(&p, 1, &f);
    for (uint64_t i = 0; i < f.n; i++) {
        const double s = f.x[i];
        const double c = s < -a ? 1 : s > 5 * a ? 0 : (5 - s / a) / 6;
        near(f.rho[i], pow(c, 5), 1e-12);
        near(f.p[i], pow(c, 7), 1e-12);
        assert_true(f.v[f.n + i] == 0);
    }
    free(f.x);
}

static void mirror_image(void **state)
{
    const struct problem p = {1, .3, 1000, 3, -.1, .01, 1.4, 0};
    const struct problem m = {3, .1, .01, 1, -.3, 1000, 1.4, 0};
    struct fields f = fields_new(1, 1001), g = fields_new(1, 1001);

    (void)state;
    for (uint64_t i = 0; i < f.n; i++) {
        f.x[i] = -40 + .08 * (double)i + .001;
        g.x[i] = -f.x[i];
    }
    riemann(&p, 1, &f);
    riemann(&m, 1, &g);
    for (uint64_t i = 0; i < f.n; i++) {
        near(g.rho[i], f.rho[i], 1e-12);
        near(g.p[i], f.p[i], 1e-12);
        near(g.v[i], -f.v[i], 1e-12);
    }
    free(f.x);
    free(g.x);
}

static void at_the_start(void **state)
{
    const struct problem p = {1, .5, 1, .125, -.5, .1, 1.4, .25};
    struct fields f = fields_new(3, 2);

    (void)state;
    f.x[0] = .2;
    f.x[1] = .3;
    riemann(&p, 0, &f);
    assert_true(f.rho[0] == 1 && f.rho[1] == .125 && f.v[0] == .5 && f.v[1] == -.5);
    assert_true(f.v[2] == 0 && f.v[3] == 0 && f.v[4] == 0 && f.v[5] == 0);
    solve("noh", NULL, NULL, 0, &f);
    assert_true(f.rho[0] == 1 && f.v[0] == -1 && f.p[0] == 0);
    free(f.x);
}

static void noh_of_the_table(void **state)
{
    int columns, rows, seen = 0;
    double *table = plugins_table("noh.csv", &columns, &rows);

    (void)state;
    assert_int_equal(columns, 6); /* nu, t, r, rho, u, p */
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const int dim = (int)row[0];
        struct fields f = fields_new(dim, 1);
        /* In a direction of no axis; the shock itself may be on either side. */
        for (int c = 0; c < dim; c++)
            f.x[c] = row[2] * (c % 2 ? -1 : 1) / sqrt(dim);
        solve("noh", NULL, NULL, row[1], &f);
        if (fabs(row[2] - row[1] / 3) > 1e-9) {
            double v = 0;
            for (int c = 0; c < dim; c++)
                v += f.v[c] * (row[2] > 0 ? f.x[c] / row[2] : 0);
            near(f.rho[0], row[3], 2e-9);
            near(v, row[4], 2e-9);
            near(f.p[0], row[5], 2e-9);
            near(f.u[0], f.v[0] == 0 ? .5 : 0, 1e-12);
            seen++;
        }
        free(f.x);
    }
    assert_true(seen >= rows - 6);
    free(table);
}

/* In one dimension Noh's implosion is a Riemann problem of cold gas, for any gamma. */
static void noh_is_a_collision_of_cold_gas(void **state)
{
    const struct problem p = {2, 3, 0, 2, -3, 0, 1.3, 0};
    const char *const names[] = {"gamma", "rho0", "v0", NULL};
    const double values[] = {1.3, 2, 3};
    struct fields f = fields_new(1, 200), g = fields_new(1, 200);

    (void)state;
    for (uint64_t i = 0; i < f.n; i++)
        f.x[i] = g.x[i] = -1 + .01 * ((double)i + .5);
    riemann(&p, .7, &f);
    solve("noh", names, values, .7, &g);
    for (uint64_t i = 0; i < f.n; i++) {
        near(g.rho[i], f.rho[i], 1e-12);
        near(g.p[i], f.p[i], 1e-12);
        near(g.v[i], f.v[i], 1e-12);
        near(g.u[i], f.u[i], 1e-12);
    }
    free(f.x);
    free(g.x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sods_tube),
        cmocka_unit_test(toros_123),
        cmocka_unit_test(toros_star_states),
        cmocka_unit_test(mass_momentum_and_energy_are_conserved),
        cmocka_unit_test(expansion_into_a_vacuum),
        cmocka_unit_test(mirror_image),
        cmocka_unit_test(at_the_start),
        cmocka_unit_test(noh_of_the_table),
        cmocka_unit_test(noh_is_a_collision_of_cold_gas),
    };

    return cmocka_run_group_tests(tests, load, unload);
}
