/* test_exact_gas.c -- the plugin "exact": explosion, sound wave and vortex against tables of
 * another program (tests/reference), the equations of motion and the conservation laws. */
#include "config.h"

#include "exacts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* -- Sedov -------- */

static const char *const sedov_names[] = {"gamma", "energy", "rho0", NULL};

struct radial {
    double rho, p, u, v;
};

/* At r, in a direction of no axis. */
static struct radial sedov_at(const double *values, int dim, double t, double r)
{
    static const double way[3][3] = {{1}, {.6, -.8}, {2. / 3, -1. / 3, 2. / 3}};
    const double *w = way[dim - 1];
    const double x[3] = {r * w[0], r * w[1], r * w[2]};
    const struct state s = exacts_at("sedov", &(struct given){sedov_names, values}, dim, t, x);

    return (struct radial){s.rho, s.p, s.u, s.v[0] * w[0] + s.v[1] * w[1] + s.v[2] * w[2]};
}

/* The radius of the shock, by halving. */
static double shock_of(const double *values, int dim, double t)
{
    double low = 0, high = 1;

    while (sedov_at(values, dim, t, high).p > 0)
        high *= 2;
    while (high - low > 1e-15 * high) {
        const double middle = (low + high) / 2;
        if (sedov_at(values, dim, t, middle).p > 0)
            low = middle;
        else
            high = middle;
        if (middle == low && middle + (high - low) / 2 == middle)
            break;
    }
    return low;
}

static void sedov_table(const char *file, int dim)
{
    const double values[] = {5. / 3, 1, 1};
    int columns, rows, behind = 0;
    double *table = plugins_table(file, &columns, &rows);
    double shock = 0;

    assert_int_equal(columns, 4); /* r, rho, u (the velocity), p */
    for (int i = rows - 1; i >= 0 && table[i * columns + 3] == 0; i--)
        shock = table[i * columns];
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        /* The first row says r = 0, but has the values of 1e-8 times the shock's radius. */
        const double r = row[0] == 0 ? 1e-8 * shock : row[0];
        const double half = row[0] == 0 ? 1e-8 * last_digit(shock, 10) / 2 : last_digit(r, 10) / 2;
        const struct radial l = sedov_at(values, dim, .1, r - half);
        const struct radial m = sedov_at(values, dim, .1, r);
        const struct radial h = sedov_at(values, dim, .1, r + half);
        same_digits_between(l.rho, m.rho, h.rho, row[1]);
        same_digits_between(l.v, m.v, h.v, row[2]);
        same_digits_between(l.p, m.p, h.p, row[3]);
        behind += row[3] > 0;
    }
    assert_true(behind >= 200 && rows > behind + 40);
    free(table);
}

static void sedov_2d_of_the_table(void **state)
{
    (void)state;
    sedov_table("sedov_2d_g53.csv", 2);
}

static void sedov_3d_of_the_table(void **state)
{
    (void)state;
    sedov_table("sedov_3d_g53.csv", 3);
}

static void sedov_alpha_of_the_table(void **state)
{
    int columns, rows;
    double *table = plugins_table("sedov_alpha.csv", &columns, &rows);

    (void)state;
    assert_int_equal(columns, 9); /* j, gamma, alpha, E, r2, speed, rho2, u2, p2; at time 1 */
    assert_int_equal(rows, 12);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const int dim = (int)row[0];
        const double values[] = {fabs(row[1] - 5. / 3) < 1e-9 ? 5. / 3 : row[1], row[3], 1};
        const double r2 = shock_of(values, dim, 1);
        const struct radial s = sedov_at(values, dim, 1, r2 * (1 - 1e-13));
        same_digits(values[0], row[1], 0);
        same_digits(row[3] / pow(r2, dim + 2), row[2], 0);
        same_digits(r2, row[4], 0);
        same_digits(2 * r2 / (dim + 2), row[5], 0);
        same_digits(s.rho, row[6], 0);
        same_digits(s.v, row[7], 0);
        same_digits(s.p, row[8], 0);
    }
    free(table);
}

/* Integrals over r from 0 to the shock, by Gauss' rule of 8 points in pieces that get shorter
 * towards both ends: mass, energy. */
static void sums(const double *values, int dim, double t, double r2, double *mass, double *energy)
{
    static const double place[] = {.1834346424956498, .5255324099163290, .7966664774136267,
                                   .9602898564975363};
    static const double weight[] = {.3626837833783620, .3137066458778873, .2223810344533745,
                                    .1012285362903763};
    const double area[] = {0, 1, 2 * pi, 4 * pi};
    enum { PIECES = 400, N = 8 * PIECES };
    double dv[N], from = 0;
    struct fields f = fields_new(dim, N);

    for (int i = 0; i < PIECES; i++) {
        const double u = (i + 1.) / PIECES;
        const double to = r2 * u * u * u * (10 - 15 * u + 6 * u * u);
        for (int k = 0; k < 8; k++) {
            const double way = k < 4 ? place[k] : -place[k - 4];
            const double r = (from + to) / 2 + (to - from) / 2 * way;
            f.x[8 * i + k] = r;
            dv[8 * i + k] = area[dim] * pow(r, dim - 1) * weight[k % 4] * (to - from) / 2;
        }
        from = to;
    }
    exacts_solve("sedov", &(struct given){sedov_names, values}, t, &f);
    *mass = *energy = 0;
    for (int i = 0; i < N; i++) {
        *mass += f.rho[i] * dv[i];
        *energy += (f.rho[i] * f.v[i] * f.v[i] / 2 + f.p[i] / (values[0] - 1)) * dv[i];
    }
    fields_free(&f);
}

/* The energy is what was set free, the mass what the shock has swept; also where the exponents of
 * the solution have a pole (gamma = 2), and next to it. */
static void sedov_keeps_mass_and_energy(void **state)
{
    static const double gammas[] = {1.05, 1.4, 5. / 3, 2 - 1e-9, 2, 2 + 1e-9, 3, 6.5};
    const double volume[] = {0, 1, pi, 4 * pi / 3};

    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t k = 0; k < sizeof(gammas) / sizeof(gammas[0]); k++) {
            const double values[] = {gammas[k], 3, 2};
            const double r2 = shock_of(values, dim, .7);
            double mass, energy;
            sums(values, dim, .7, r2, &mass, &energy);
            near(mass, 2 * volume[dim] * pow(r2, dim), 1e-9);
            near(energy, 3, 1e-9);
        }
}

/* Rankine and Hugoniot's jumps into cold gas, at the speed at which the radius grows. */
static void sedov_jumps(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        const double values[] = {1.3, 5, .25};
        const double t = 2, r2 = shock_of(values, dim, t);
        const double speed =
            (shock_of(values, dim, t * (1 + 1e-5)) - shock_of(values, dim, t * (1 - 1e-5))) /
            (2e-5 * t);
        const struct radial s = sedov_at(values, dim, t, r2 * (1 - 1e-12));
        near(s.rho * (speed - s.v), .25 * speed, 1e-8);
        near(s.p, .25 * speed * s.v, 1e-8);
        near(s.u, s.v * s.v / 2, 1e-8);
    }
}

/* Euler's equations behind the shock, by central differences. */
static void sedov_obeys_the_equations_of_motion(void **state)
{
    static const double gammas[] = {1.2, 1.4, 2, 4};

    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t k = 0; k < 4; k++)
            for (double part = .3; part < 1; part += .15) {
                const double values[] = {gammas[k], 1, 1}, t = 1, e = 1e-4;
                const double r = part * shock_of(values, dim, t);
                const struct radial s = sedov_at(values, dim, t, r);
                const struct radial a = sedov_at(values, dim, t, r - e);
                const struct radial b = sedov_at(values, dim, t, r + e);
                const struct radial c = sedov_at(values, dim, t - e, r);
                const struct radial d = sedov_at(values, dim, t + e, r);
                const double dv = (b.v - a.v) / (2 * e) + (dim - 1) * s.v / r;
                near((d.rho - c.rho) / (2 * e) + s.v * (b.rho - a.rho) / (2 * e) + s.rho * dv, 0,
                     2e-5);
                near(s.rho * ((d.v - c.v) / (2 * e) + s.v * (b.v - a.v) / (2 * e)) +
                         (b.p - a.p) / (2 * e),
                     0, 2e-5);
                near((d.p - c.p) / (2 * e) + s.v * (b.p - a.p) / (2 * e) + gammas[k] * s.p * dv, 0,
                     2e-5);
                near(s.p, (gammas[k] - 1) * s.rho * s.u, 1e-12);
            }
}

/* Numbers all over, for gases at the ends of the range; at the start nothing has moved. */
static void sedov_at_the_ends(void **state)
{
    static const double gammas[] = {1.000001, 1.001, 6.999999, 7.5, 100};

    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t k = 0; k < 5; k++) {
            const double values[] = {gammas[k], 1, 1};
            if (dim == 3 && gammas[k] > 7) {
                exacts_refuse("sedov", dim, &(struct given){sedov_names, values}, "less than 7");
                continue;
            }
            const double r2 = shock_of(values, dim, 1);
            const struct radial s = sedov_at(values, dim, 1, r2 * (1 - 1e-14));
            assert_true(r2 > 0 && isfinite(r2));
            near(s.rho / ((gammas[k] + 1) / (gammas[k] - 1)), 1, 1e-6);
            for (double part = 1e-3; part < 1; part += .0999) {
                const struct radial a = sedov_at(values, dim, 1, part * r2);
                assert_true(a.rho >= 0 && a.p > 0 && a.v > 0 && isfinite(a.p) && a.v < r2);
            }
            const struct radial start = sedov_at(values, dim, 0, 0);
            assert_true(start.rho == 1 && start.p == 0 && start.v == 0 && start.u == 0);
        }
}

/* -- Sound wave -------- */

static const char *const wave_names[] = {"amplitude", "wave", "gamma", NULL};

/* Five periods bring the linear wave back; half of one turns it over. */
static void sound_travels(void **state)
{
    const double values[] = {1e-6, 0, 1.4}, period = 1;
    const struct given given = {wave_names, values};

    (void)state;
    for (double x = -.4; x < 1; x += .17) {
        const struct state a = exacts_at("acoustic-wave", &given, 1, 0, &x);
        const struct state b = exacts_at("acoustic-wave", &given, 1, 5 * period, &x);
        const struct state c = exacts_at("acoustic-wave", &given, 1, period / 2, &x);
        near(a.rho, 1 + 1e-6 * sin(2 * pi * x), 1e-15);
        near(a.v[0], 1e-6 * sin(2 * pi * x), 1e-15);
        near(a.p, (1 + 1.4e-6 * sin(2 * pi * x)) / 1.4, 1e-15);
        near(b.rho, a.rho, 1e-15);
        near(b.p, a.p, 1e-15);
        near(b.u, a.u, 1e-15);
        near(b.v[0], a.v[0], 1e-15);
        near(c.v[0], -a.v[0], 1e-15);
        /* the rest is of second order */
        near(a.p, .4 * a.rho * a.u, 2e-12);
    }
}

/* The simple wave obeys Euler's equations, and the linear one is what is left of it for a small
 * amplitude: half the amplitude, a quarter of the difference. */
static void sound_in_full(void **state)
{
    static const double gammas[] = {1.4, 5. / 3, 3, 4};
    const double e = 1e-5, t = .6;

    (void)state;
    for (size_t k = 0; k < 4; k++)
        for (double x = 0; x < 1; x += .13) {
            const double values[] = {.05, 1, gammas[k]};
            const struct given g = {wave_names, values};
            const double l = x - e, r = x + e;
            const struct state s = exacts_at("acoustic-wave", &g, 1, t, &x);
            const struct state a = exacts_at("acoustic-wave", &g, 1, t, &l);
            const struct state b = exacts_at("acoustic-wave", &g, 1, t, &r);
            const struct state c = exacts_at("acoustic-wave", &g, 1, t - e, &x);
            const struct state d = exacts_at("acoustic-wave", &g, 1, t + e, &x);
            near((d.rho - c.rho + b.rho * b.v[0] - a.rho * a.v[0]) / (2 * e), 0, 1e-6);
            near((s.rho * (d.v[0] - c.v[0] + s.v[0] * (b.v[0] - a.v[0])) + b.p - a.p) / (2 * e), 0,
                 1e-6);
            near(s.p, (gammas[k] - 1) * s.rho * s.u, 1e-14);
            near(s.p / pow(s.rho, gammas[k]), 1 / 1.4, 1e-14);

            double difference[2];
            for (int i = 0; i < 2; i++) {
                const double simple[] = {i ? 5e-5 : 1e-4, 1, gammas[k]};
                const double linear[] = {i ? 5e-5 : 1e-4, 0, gammas[k]};
                const struct state full =
                    exacts_at("acoustic-wave", &(struct given){wave_names, simple}, 1, t, &x);
                const struct state first =
                    exacts_at("acoustic-wave", &(struct given){wave_names, linear}, 1, t, &x);
                difference[i] = full.rho - first.rho;
                /* 50 amplitude^2 */
                near(full.v[0], first.v[0], 50e-8);
                near(full.p, first.p, 50e-8);
                near(full.u, first.u, 50e-8);
            }
            near(difference[1] * 1e8, difference[0] * 1e8 / 4, 5e-2);
        }
    exacts_refuse_run("acoustic-wave", 1, &(struct given){wave_names, (double[]){.1, 1, 1.4}}, 2,
                      "breaks about time");
}

/* -- Vortex -------- */

static void gresho_of_the_table(void **state)
{
    const double way[2] = {.6, -.8};
    int columns, rows;
    double *table = plugins_table("gresho.csv", &columns, &rows);

    (void)state;
    assert_int_equal(columns, 3); /* r, v_phi, p */
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double x[2] = {row[0] * way[0], row[0] * way[1]};
        const struct state s = exacts_at("gresho", NULL, 2, 3, x);
        /* anticlockwise: (-y, x) / r */
        same_digits(s.v[0] * -way[1] + s.v[1] * way[0], row[1], 1e-15);
        near(s.v[0] * way[0] + s.v[1] * way[1], 0, 1e-15);
        same_digits(s.p, row[2], 0);
        near(s.rho, 1, 0);
        near(s.u, s.p * 1.5, 1e-15);
    }
    assert_true(rows > 100);
    free(table);
}

/* Elsewhere, of another size: the pressure holds the ring, v grad v = -grad p / rho. */
static void gresho_is_steady(void **state)
{
    static const char *const names[] = {"radius", "v0", "rho0", "p0", "x0", "y0", NULL};
    static const double values[] = {3, -2, 4, 50, 1, -7};
    const struct given given = {names, values};

    (void)state;
    for (double r = .5; r < 8; r += .7) {
        const double x[3] = {1 + r * .8, -7 + r * .6, 11};
        const struct motion m = exacts_motion("gresho", &given, 3, 5, x, 1e-4, 1, 1);
        for (int c = 0; c < 3; c++)
            near(4 * m.acceleration[c] + m.grad_p[c], 0, 1e-6);
        near(m.div_v, 0, 1e-6);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sedov_2d_of_the_table),
        cmocka_unit_test(sedov_3d_of_the_table),
        cmocka_unit_test(sedov_alpha_of_the_table),
        cmocka_unit_test(sedov_keeps_mass_and_energy),
        cmocka_unit_test(sedov_jumps),
        cmocka_unit_test(sedov_obeys_the_equations_of_motion),
        cmocka_unit_test(sedov_at_the_ends),
        cmocka_unit_test(sound_travels),
        cmocka_unit_test(sound_in_full),
        cmocka_unit_test(gresho_of_the_table),
        cmocka_unit_test(gresho_is_steady),
    };

    exacts_filter(argc, argv);
    return cmocka_run_group_tests(tests, exacts_load, exacts_unload);
}
