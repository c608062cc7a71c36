/* test_exact.c -- the plugin "exact" against tables of another program (tests/reference), closed
 * forms and the conservation laws. */
#include "config.h"

#include "exacts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A Riemann problem: parameters in declared order. */
struct problem {
    double rho_l, u_l, p_l, rho_r, u_r, p_r, gamma, x0;
};
static const char *const problem_names[] = {"rho_l", "u_l",   "p_l", "rho_r", "u_r",
                                            "p_r",   "gamma", "x0",  NULL};

static void riemann(const struct problem *p, double time, struct fields *f)
{
    exacts_solve("riemann", &(struct given){problem_names, &p->rho_l}, time, f);
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
        same_digits(f.rho[i], row[1], 1e-15);
        same_digits(f.v[i], row[2], 1e-15);
        same_digits(f.p[i], row[3], 1e-15);
        same_digits(f.u[i], row[4], 1e-15);
    }
    fields_free(&f);
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

/* p*, u*, rho* left and right of three more tests of Toro 2009, table 4.2; sampled beside the
 * contact, far from its rounding. */
static void toros_star_states(void **state)
{
    static const struct {
        struct problem problem;
        double p, u, rho_l, rho_r;
    } tests[] = {
        {{1, 0, 1000, 1, 0, .01, 1.4, 0}, 460.894, 19.5975, .57506, 5.99924},
        {{1, 0, .01, 1, 0, 100, 1.4, 0}, 46.0950, -6.19633, 5.99242, .57511},
        {{5.99924, 19.5975, 460.894, 5.99242, -6.19633, 46.0950, 1.4, 0},
         1691.64,
         8.68975,
         14.2823,
         31.0426},
    };

    (void)state;
    for (size_t k = 0; k < sizeof(tests) / sizeof(tests[0]); k++) {
        struct fields f = fields_new(1, 2);
        f.x[0] = tests[k].u - 1e-3;
        f.x[1] = tests[k].u + 1e-3;
        riemann(&tests[k].problem, 1, &f);
        near(f.rho[0], tests[k].rho_l, 1e-5);
        near(f.rho[1], tests[k].rho_r, 1e-5);
        for (int i = 0; i < 2; i++) {
            near(f.p[i], tests[k].p, 1e-5);
            near(f.v[i], tests[k].u, 1e-5);
        }
        fields_free(&f);
    }
}

/* A wave at this printed speed: a jump, or the end of a fan, where the slope jumps, within one unit
 * of its eighth digit. Without one the second difference is of the order of the unit's square. */
static void wave_at(const struct problem *p, double t, double speed)
{
    const double unit = last_digit(speed, 8);
    struct fields f = fields_new(1, 3);

    for (int i = 0; i < 3; i++)
        f.x[i] = p->x0 + (speed + (i - 1) * unit) * t;
    riemann(p, t, &f);
    if (!(fabs(f.rho[0] - 2 * f.rho[1] + f.rho[2]) > 1e-3 * unit))
        fail_msg("no wave at speed %.8g", speed);
    fields_free(&f);
}

/* rhoL ... x0, xmin, xmax, tend, p_star, u_star, rho_star_L, rho_star_R; then name=speed;... */
static void star_states_of_the_table(void **state)
{
    FILE *file = plugins_open_table("riemann_star_states.csv");
    char line[1024];
    int rows = 0, waves = 0;

    (void)state;
    for (int i = 0; fgets(line, sizeof(line), file); i++) {
        double value[15];
        char *s = strchr(line, ',');
        if (i < 2)
            continue;
        for (int k = 0; k < 15; k++)
            value[k] = strtod(s + 1, &s);
        struct problem p;
        memcpy(&p, value, sizeof(p));
        const double t = value[10], *star = value + 11;
        struct fields f = fields_new(1, 2);
        f.x[0] = p.x0 + (star[1] - 1e-3) * t;
        f.x[1] = p.x0 + (star[1] + 1e-3) * t;
        riemann(&p, t, &f);
        for (int k = 0; k < 2; k++) {
            same_digits(f.p[k], star[0], 0);
            same_digits(f.v[k], star[1], 1e-15);
            same_digits(f.rho[k], star[2 + k], 0);
        }
        fields_free(&f);
        while ((s = strchr(s, '='))) {
            const double speed = strtod(s + 1, &s);
            /* Where both sides are of one density the contact does not show. */
            if (speed != 0) {
                wave_at(&p, t, speed);
                waves++;
            }
        }
        rows++;
    }
    fclose(file);
    assert_int_equal(rows, 2);
    assert_int_equal(waves, 8);
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
        fields_free(&f);
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
    fields_free(&f);
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
    fields_free(&f);
    fields_free(&g);
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
    exacts_solve("noh", NULL, 0, &f);
    assert_true(f.rho[0] == 1 && f.v[0] == -1 && f.p[0] == 0);
    fields_free(&f);
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
        exacts_solve("noh", NULL, row[1], &f);
        if (fabs(row[2] - row[1] / 3) > 1e-9) {
            double v = 0;
            for (int c = 0; c < dim; c++)
                v += f.v[c] * (row[2] > 0 ? f.x[c] / row[2] : 0);
            same_digits(f.rho[0], row[3], 0);
            same_digits(v, row[4], 1e-15);
            same_digits(f.p[0], row[5], 0);
            near(f.u[0], f.v[0] == 0 ? .5 : 0, 1e-12);
            seen++;
        }
        fields_free(&f);
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
    exacts_solve("noh", &(struct given){names, values}, .7, &g);
    for (uint64_t i = 0; i < f.n; i++) {
        near(g.rho[i], f.rho[i], 1e-12);
        near(g.p[i], f.p[i], 1e-12);
        near(g.v[i], f.v[i], 1e-12);
        near(g.u[i], f.u[i], 1e-12);
    }
    fields_free(&f);
    fields_free(&g);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sods_tube),
        cmocka_unit_test(toros_123),
        cmocka_unit_test(toros_star_states),
        cmocka_unit_test(star_states_of_the_table),
        cmocka_unit_test(mass_momentum_and_energy_are_conserved),
        cmocka_unit_test(expansion_into_a_vacuum),
        cmocka_unit_test(mirror_image),
        cmocka_unit_test(at_the_start),
        cmocka_unit_test(noh_of_the_table),
        cmocka_unit_test(noh_is_a_collision_of_cold_gas),
    };

    exacts_filter(argc, argv);
    return cmocka_run_group_tests(tests, exacts_load, exacts_unload);
}
