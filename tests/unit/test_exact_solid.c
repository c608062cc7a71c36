/* test_exact_solid.c -- the plugin "exact": plate and impact against tables of another program
 * (tests/reference), boundary conditions, orthogonality and the jump conditions. */
#include "config.h"

#include "exacts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* -- Plate -------- */

enum { LENGTH, THICKNESS, YOUNG, POISSON, RHO0, MODE, THEORY, START, AMPLITUDE, N_VALUES };
static const char *const plate_names[] = {"length", "thickness", "young", "poisson",   "rho0",
                                          "mode",   "theory",    "start", "amplitude", NULL};

/* In the middle of the plate. */
static struct state plate_at(const double *values, double t, double x)
{
    const double place[2] = {x, 0};

    return exacts_at("plate", &(struct given){plate_names, values}, 2, t, place);
}

/* From the speed of the free end of a straight plate that starts to move. */
static double omega_of(const double *values)
{
    return plate_at(values, 0, values[LENGTH]).v[1] / values[AMPLITUDE];
}

static void plate_of_the_table(void **state)
{
    int columns, rows;
    double *table = plugins_table("cantilever_frequencies.csv", &columns, &rows);

    (void)state;
    /* case, L, H, E, rho, nu, mode, kL, omega, f_Hz, T, omegaL_over_c0 */
    assert_int_equal(columns, 12);
    assert_int_equal(rows, 12);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double l = row[1], h = row[2], e = row[3], rho = row[4], nu = row[5];
        const double values[N_VALUES] = {l, h, e, nu, rho, row[6], 0, 0, .001};
        const double omega = omega_of(values);
        const double k = sqrt(omega / h * sqrt(12 * rho * (1 - nu * nu) / e));
        same_digits(k * l, row[7], 0);
        same_digits(omega, row[8], 0);
        same_digits(omega / (2 * pi), row[9], 0);
        same_digits(2 * pi / omega, row[10], 0);
        same_digits(omega * l / sqrt(e / (3 * (1 - 2 * nu)) / rho), row[11], 0);
    }
    free(table);
}

/* The clamp holds place and slope; a thin plate's free end has no moment and no shear; between, the
 * fourth derivative is k^4 times the deflection. One node more for each mode, up to the last. */
static void plate_is_clamped_and_free(void **state)
{
    (void)state;
    for (int mode = 1; mode <= 100; mode += mode < 5 ? 1 : 19) {
        const double values[N_VALUES] = {1, .1, 1, .3, 1, mode, 0, 1, 1};
        const double k = sqrt(omega_of((double[N_VALUES]){1, .1, 1, .3, 1, mode, 0, 0, 1}) / .1 *
                              sqrt(12 * .91));
        const double e = .02 / k, scale[] = {1, k, k * k, k * k * k};
        int nodes = 0;
        near(k, mode == 1 ? 1.875104068711961 : (mode - .5) * pi, mode > 3 ? 1e-5 : .02);
        near(plate_at(values, 0, 1).d[1], 1, 1e-14);
        near(plate_at(values, 0, e / 100).d[1], 0, 1e-6);
        near(plate_at(values, 0, -.1).d[1], 0, 0);
        const double w[] = {plate_at(values, 0, 1).d[1], plate_at(values, 0, 1 - e).d[1],
                            plate_at(values, 0, 1 - 2 * e).d[1],
                            plate_at(values, 0, 1 - 3 * e).d[1]};
        near((2 * w[0] - 5 * w[1] + 4 * w[2] - w[3]) / (e * e) / scale[2], 0, 1e-3);
        near((w[0] - 3 * w[1] + 3 * w[2] - w[3]) / (e * e * e) / scale[3], 0, 4e-2);
        for (double x = .05; x < .95; x += .1) {
            double v[5];
            for (int i = 0; i < 5; i++)
                v[i] = plate_at(values, 0, x + (i - 2) * 2 * e).d[1];
            near((v[0] - 4 * v[1] + 6 * v[2] - 4 * v[3] + v[4]) /
                     (16 * e * e * e * e * scale[3] * k),
                 v[2], 2e-3);
        }
        struct fields f = fields_new(2, 4000);
        for (int i = 0; i < 4000; i++)
            f.x[i] = (i + .5) / 4000;
        exacts_solve("plate", &(struct given){plate_names, values}, 0, &f);
        for (int i = 1; i < 4000; i++)
            nodes += f.d[4000 + i] * f.d[4000 + i - 1] < 0;
        fields_free(&f);
        assert_int_equal(nodes, mode - 1);
    }
    exacts_refuse("plate", 2, &(struct given){(const char *const[]){"mode", NULL}, (double[]){1.5}},
                  "whole number");
}

/* Integral of d . d' over the plate: by Gauss' rule of two points across, which is exact there, and
 * Simpson's along it. */
static double overlap(const double *a, const double *b)
{
    enum { N = 2000 };
    struct fields f = fields_new(2, N + 1), g = fields_new(2, N + 1);
    double sum = 0;

    for (int i = 0; i <= N; i++) {
        f.x[i] = g.x[i] = a[LENGTH] * i / N;
        f.x[N + 1 + i] = g.x[N + 1 + i] = a[THICKNESS] / 2 / sqrt(3);
    }
    exacts_solve("plate", &(struct given){plate_names, a}, 0, &f);
    exacts_solve("plate", &(struct given){plate_names, b}, 0, &g);
    for (int i = 0; i <= N; i++)
        sum += (i == 0 || i == N ? 1
                : i % 2          ? 4
                                 : 2) *
               (f.d[i] * g.d[i] + f.d[N + 1 + i] * g.d[N + 1 + i]);
    fields_free(&f);
    fields_free(&g);
    return sum / (3 * N);
}

/* Modes of the same plate are orthogonal: a thin one's deflections, and with rotary inertia their
 * displacements all over the section. */
static void modes_are_orthogonal(void **state)
{
    (void)state;
    for (int theory = 0; theory < 2; theory++)
        for (int m = 1; m <= 4; m++)
            for (int n = m; n <= 4; n++) {
                /* A thin plate's rotation has no inertia: make it vanish. */
                const double h = theory ? .2 : 1e-9;
                const double a[N_VALUES] = {1, h, 1, .3, 1, m, theory, 1, 1};
                const double b[N_VALUES] = {1, h, 1, .3, 1, n, theory, 1, 1};
                const double o = overlap(a, b);
                if (m != n)
                    near(o, 0, 1e-9);
                else if (theory == 0)
                    near(o, .25, 1e-9); /* scaled by the free end: a quarter of the mass */
                else
                    assert_true(o > .1 && o < 2);
            }
}

/* The battery's plate with shear and rotary inertia, T = .2564 to .2565 s; it lies below the thin
 * one's frequency, and comes to it as the plate gets thinner, with the square of H. */
static void plate_with_shear(void **state)
{
    const double thick[N_VALUES] = {.2, .02, 2e6, .3975, 1000, 1, 1, 0, .001};
    const double period = 2 * pi / omega_of(thick);
    double off[2];

    (void)state;
    assert_true(period > .25635 && period < .25655);
    for (int i = 0; i < 2; i++) {
        const double h = i ? .0005 : .001;
        const double with[N_VALUES] = {.2, h, 2e6, .3975, 1000, 2, 1, 0, .001};
        const double without[N_VALUES] = {.2, h, 2e6, .3975, 1000, 2, 0, 0, .001};
        off[i] = 1 - omega_of(with) / omega_of(without);
    }
    assert_true(off[0] > 0 && off[0] < 1e-2);
    near(off[0] / off[1], 4, 1e-2);
    exacts_refuse("plate", 2,
                  &(struct given){plate_names, (double[]){.2, .1, 2e6, .3, 1000, 20, 1, 0, .001}},
                  "above the frequency");
}

/* v is the rate of d, at any time, and a bent plate is a straight one a quarter period later. */
static void plate_swings(void **state)
{
    (void)state;
    for (int theory = 0; theory < 2; theory++) {
        const double straight[N_VALUES] = {.2, .02, 2e6, .3975, 1000, 2, theory, 0, .002};
        const double bent[N_VALUES] = {.2, .02, 2e6, .3975, 1000, 2, theory, 1, .002};
        const struct given s = {plate_names, straight}, b = {plate_names, bent};
        const double quarter = pi / 2 / omega_of(straight), e = 1e-6;
        for (double t = 0; t < .1; t += .007) {
            const double x[2] = {.17, .006};
            const struct state now = exacts_at("plate", &s, 2, t, x);
            const struct state before = exacts_at("plate", &s, 2, t - e, x);
            const struct state after = exacts_at("plate", &s, 2, t + e, x);
            const struct state early = exacts_at("plate", &b, 2, t - quarter, x);
            for (int c = 0; c < 2; c++) {
                near((after.d[c] - before.d[c]) / (2 * e), now.v[c], 1e-7);
                near(early.d[c] * 1e3, now.d[c] * 1e3, 1e-12);
                near(early.v[c], now.v[c], 1e-12);
            }
        }
    }
}

/* -- Impact -------- */

static const char *const impact_names[] = {"rho_l", "c_l", "s_l", "v_l", "rho_r",
                                           "c_r",   "s_r", "v_r", NULL};

static struct state impact_at(const double *values, double t, double x)
{
    return exacts_at("planar-impact", &(struct given){values ? impact_names : NULL, values}, 1, t,
                     &x);
}

static void impact_of_the_table(void **state)
{
    int columns, rows;
    double *table = plugins_table("hugoniot_symmetric_impact.csv", &columns, &rows);

    (void)state;
    /* material, rho0, c0, S, Gamma0, V_impact, up, Us, P, rho, de */
    assert_int_equal(columns, 11);
    assert_int_equal(rows, 35);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double values[] = {row[1], row[2], row[3], row[5], row[1], row[2], row[3], 0};
        /* The right shock runs at Us into what rests. */
        const struct state behind = impact_at(values, 1, row[7] * (1 - 1e-9));
        const struct state ahead = impact_at(values, 1, row[7] * (1 + 1e-9));
        same_digits(behind.v[0], row[6], 0);
        same_digits(behind.p / (row[1] * behind.v[0]), row[7], 0);
        same_digits(behind.p, row[8], 0);
        same_digits(behind.rho, row[9], 0);
        same_digits(behind.u, row[10], 0);
        same_digits(ahead.rho, row[1], 0);
        near(ahead.p + ahead.v[0] + ahead.u, 0, 0);
        /* The left one as fast, seen from the flyer. */
        same_digits(impact_at(values, 1, row[5] - row[7] * (1 - 1e-9)).p, row[8], 0);
        near(impact_at(values, 1, row[5] - row[7] * (1 + 1e-9)).p, 0, 0);
    }
    free(table);
}

/* The battery's figures: aluminium on steel, and on aluminium, at 3.1 km/s. */
static void impact_of_the_battery(void **state)
{
    const double aluminium[] = {2785, 5328, 1.338, 3100, 2785, 5328, 1.338, 0};
    const struct state s = impact_at(NULL, 1e-3, 1), a = impact_at(aluminium, 1e-3, 2);

    (void)state;
    assert_true(fabs(s.v[0] - 994.275) < 5e-4);
    assert_true(fabs(s.p - 47.769e9) < .5e6);
    assert_true(fabs(a.p - 31.952e9) < .5e6);
    assert_true(fabs(a.rho - 3522.7) < .05);
}

/* What is between the far ends is what was there and what has come in: mass, momentum, energy; p
 * and v are the same on both sides of the contact; the mirror image is one. */
static void impact_conserves(void **state)
{
    static const double cases[][8] = {
        {2785, 5328, 1.338, 3100, 7900, 4600, 1.49, 0},
        {1000, 1483, 1.75, -100, 19220, 4030, 1.24, -3000},
        {8930, 3940, 0, 10, 2703, 5240, 1.4, -.5},
        {1, 1e-3, 1.2, 5, 1000, 2, 3, 0},
    };
    const int n = 100000;

    (void)state;
    for (size_t k = 0; k < 4; k++) {
        const double *c = cases[k];
        const double mirror[] = {c[4], c[5], c[6], -c[7], c[0], c[1], c[2], -c[3]};
        const double jump = c[3] - c[7];
        const double far = 4 * (fabs(c[3]) + fabs(c[7]) + c[1] + c[5] + (c[2] + c[6]) * jump);
        const double e[] = {c[3] * c[3] / 2, c[7] * c[7] / 2};
        const double wanted[] = {
            far * (c[0] + c[4]) + c[0] * c[3] - c[4] * c[7],
            far * (c[0] * c[3] + c[4] * c[7]) + c[0] * c[3] * c[3] - c[4] * c[7] * c[7],
            far * (c[0] * e[0] + c[4] * e[1]) + c[0] * e[0] * c[3] - c[4] * e[1] * c[7]};
        double sum[3] = {0};
        struct fields f = fields_new(1, (uint64_t)n), g = fields_new(1, (uint64_t)n);
        for (int i = 0; i < n; i++) {
            f.x[i] = far * (2 * (i + .5) / n - 1);
            g.x[i] = -f.x[i];
        }
        exacts_solve("planar-impact", &(struct given){impact_names, c}, 1, &f);
        exacts_solve("planar-impact", &(struct given){impact_names, mirror}, 1, &g);
        for (int i = 0; i < n; i++) {
            const double dm = f.rho[i] * 2 * far / n;
            sum[0] += dm;
            sum[1] += dm * f.v[i];
            sum[2] += dm * (f.u[i] + f.v[i] * f.v[i] / 2);
            near(g.p[i] / (1 + f.p[i]), f.p[i] / (1 + f.p[i]), 1e-12);
            near(g.v[i], -f.v[i], 1e-12);
            if (i > 0 && f.p[i] > 0 && f.p[i - 1] > 0) {
                near(f.p[i] / f.p[i - 1], 1, 1e-12);
                near(f.v[i], f.v[i - 1], 1e-12);
            }
        }
        for (int q = 0; q < 3; q++) {
            const double most = far * (c[0] + c[4]) * pow(fmax(jump, fabs(c[3])), q);
            near(sum[q] / most, wanted[q] / most, 1e-4);
        }
        fields_free(&f);
        fields_free(&g);
    }
}

static void impact_that_is_none(void **state)
{
    (void)state;
    exacts_refuse("planar-impact", 1,
                  &(struct given){impact_names, (double[]){1, 1, 1, 0, 1, 1, 1, 0}}, "do not meet");
    exacts_refuse("planar-impact", 1,
                  &(struct given){impact_names, (double[]){1, 1, .1, 9, 1, 1, 1, 0}},
                  "s_l is too small");
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plate_of_the_table),    cmocka_unit_test(plate_is_clamped_and_free),
        cmocka_unit_test(modes_are_orthogonal),  cmocka_unit_test(plate_with_shear),
        cmocka_unit_test(plate_swings),          cmocka_unit_test(impact_of_the_table),
        cmocka_unit_test(impact_of_the_battery), cmocka_unit_test(impact_conserves),
        cmocka_unit_test(impact_that_is_none),
    };

    exacts_filter(argc, argv);
    return cmocka_run_group_tests(tests, exacts_load, exacts_unload);
}
