/* test_exact_liquid.c -- the plugin "exact": liquids against tables of another program
 * (tests/reference), the equations of motion and closed forms. */
#include "config.h"

#include "exacts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* -- Taylor and Green -------- */

static void taylor_green_of_the_table(void **state)
{
    static const char *const names[] = {"nu", NULL};
    int columns, rows;
    double *table = plugins_table("taylor_green.csv", &columns, &rows);

    (void)state;
    assert_int_equal(columns, 4); /* Re, t, vmax, kinetic energy over mass */
    assert_int_equal(rows, 18);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double nu = 1 / row[0];
        const int side = 16;
        struct fields f = fields_new(2, (uint64_t)(side * side));
        double most = 0, energy = 0;
        for (int k = 0; k < side * side; k++) {
            f.x[k] = (double)(k % side) / side;
            f.x[side * side + k] = (double)(k / side) / side;
        }
        exacts_solve("taylor-green", &(struct given){names, &nu}, row[1], &f);
        for (int k = 0; k < side * side; k++) {
            const double v = hypot(f.v[k], f.v[side * side + k]);
            most = fmax(most, v);
            energy += v * v / 2 / (side * side);
        }
        same_digits(most, row[2], 0);
        same_digits(energy, row[3], 0);
        fields_free(&f);
    }
    free(table);
}

/* Navier and Stokes' equations, in another box, with a mean pressure. */
static void taylor_green_obeys_the_equations_of_motion(void **state)
{
    static const char *const names[] = {"speed", "length", "nu", "rho0", "p0", NULL};
    static const double values[] = {3, 2, .05, 1.5, 7};
    const struct given given = {names, values};
    double mean = 0;

    (void)state;
    for (int i = 0; i < 64; i++) {
        const double x[2] = {.1 + i % 8 / 4., .2 + i / 8 / 4.};
        const struct motion m = exacts_motion("taylor-green", &given, 2, .4, x, 1e-4, 1e-4, 1);
        for (int c = 0; c < 2; c++)
            near(1.5 * (m.acceleration[c] - .05 * m.laplace_v[c]) + m.grad_p[c], 0, 2e-5);
        near(m.div_v, 0, 1e-8);
        mean += exacts_at("taylor-green", &given, 2, .4, x).p / 64;
    }
    near(mean, 7, 1e-14);
}

/* -- Between two walls -------- */

static void walls_table(const char *name, const char *file)
{
    int columns, rows;
    double *table = plugins_table(file, &columns, &rows);

    assert_int_equal(columns, 3); /* t, y, u */
    assert_int_equal(rows, 105);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double x[2] = {.3e-3, row[1]};
        const struct state s = exacts_at(name, NULL, 2, row[0], x);
        /* The table's series has the rounding of its largest terms. */
        same_digits(s.v[0], row[2], 1e-15 * 1.25e-5);
        near(s.v[1], 0, 0);
    }
    free(table);
}

static void poiseuille_of_the_table(void **state)
{
    (void)state;
    walls_table("poiseuille", "poiseuille_morris.csv");
}

static void couette_of_the_table(void **state)
{
    (void)state;
    walls_table("couette", "couette_morris.csv");
}

/* dv/dt = force + nu d2v/dy2, whichever of the two forms is taken (they meet at t = .1), and v is
 * the walls' in them; it starts from rest and ends as the parabola, or the straight line. */
static void walls_obey_the_equations_of_motion(void **state)
{
    static const char *const names[] = {"width", "nu", "y0", "force", NULL};
    static const char *const couette_names[] = {"width", "nu", "y0", "speed", NULL};
    static const double values[] = {2, 4, -1, 3};
    const struct given poiseuille = {names, values}, couette = {couette_names, values};

    (void)state;
    for (double y = -.99; y < 1; y += .099)
        for (double t = .011; t < .3; t += .013) {
            const double x[2] = {0, y};
            const struct motion p =
                exacts_motion("poiseuille", &poiseuille, 2, t, x, 1e-3, 1e-6, 1);
            const struct motion c = exacts_motion("couette", &couette, 2, t, x, 1e-3, 1e-6, 1);
            near(p.acceleration[0] - 4 * p.laplace_v[0], 3, 1e-4);
            near(c.acceleration[0] - 4 * c.laplace_v[0], 0, 2e-3);
        }
    for (double y = -1.2; y < 1.3; y += .2) {
        const double x[2] = {0, y};
        const bool inside = fabs(y) < 1;
        near(exacts_at("poiseuille", &poiseuille, 2, 0, x).v[0], 0, 0);
        near(exacts_at("poiseuille", &poiseuille, 2, 1e-9, x).v[0], inside ? 3e-9 : 0, 1e-20);
        near(exacts_at("poiseuille", &poiseuille, 2, 1e9, x).v[0],
             inside ? 3. / 8 * (1 - y * y) : 0, 1e-15);
        near(exacts_at("couette", &couette, 2, 0, x).v[0], y < 1 ? 0 : 3, 0);
        near(exacts_at("couette", &couette, 2, 1e9, x).v[0], 3 * fmin(1, fmax(0, (y + 1) / 2)),
             1e-15);
    }
    for (int side = -1; side <= 1; side += 2)
        for (double t = 1e-6; t < 1; t *= 3) {
            const double x[2] = {0, side * (1 - 1e-12)};
            near(exacts_at("poiseuille", &poiseuille, 2, t, x).v[0], 0, 1e-9);
            near(exacts_at("couette", &couette, 2, t, x).v[0], side < 0 ? 0 : 3, 1e-8);
        }
}

/* -- Standing wave -------- */

static const char *const wave_names[] = {"g", "depth", "wavelength", "nu", "amplitude", NULL};

/* Frequency and decay, from the surface's speed under the crest: A omega exp(-beta t) after whole
 * periods of a wave that starts flat. */
static void frequency_and_decay(const double *values, double *omega, double *beta)
{
    const struct given given = {wave_names, values};
    const double x[2] = {0, values[1]};
    const double start = exacts_at("standing-wave", &given, 2, 0, x).v[1];

    *omega = start / values[4];
    const double period = 2 * pi / *omega;
    *beta = -log(exacts_at("standing-wave", &given, 2, period, x).v[1] / start) / period;
}

static void standing_wave_of_the_table(void **state)
{
    int columns, rows;
    double *table = plugins_table("standing_wave_damping.csv", &columns, &rows);

    (void)state;
    /* case, g, H, k, nu, omega0, T0, beta_approx, beta_exact, omega_exact, a factor */
    assert_int_equal(columns, 11);
    assert_int_equal(rows, 3);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double values[] = {row[1], row[2], 2, row[4], .01};
        const double ideal[] = {row[1], row[2], 2, 0, .01};
        double omega, beta;
        same_digits(2 * pi / values[2], row[3], 0);
        frequency_and_decay(ideal, &omega, &beta);
        same_digits(omega, row[5], 0);
        same_digits(2 * pi / omega, row[6], 0);
        near(beta, 0, 1e-14);
        frequency_and_decay(values, &omega, &beta);
        same_digits(beta, row[8], 0);
        same_digits(omega, row[9], 0);
        /* What becomes of the decay for a small viscosity, and of the energy with that. */
        const double small[] = {row[1], row[2], 2, 1e-10 * row[4], .01};
        double unused, slow;
        frequency_and_decay(small, &unused, &slow);
        near(1e10 * slow / row[7], 1, 1e-4);
        same_digits(2 * row[4] * pi * pi, row[7], 0);
        same_digits(exp(-20 * 2 * row[4] * pi * pi), row[10], 0);
    }
    free(table);
}

/* Linear equations of motion within, no flow through the bottom, p = p0 at the moving surface but
 * for the viscosity; a wave that starts as a crest is that, a quarter of a period later. */
static void standing_wave_obeys_the_equations_of_motion(void **state)
{
    static const char *const names[] = {"amplitude", "depth", "wavelength", "nu",    "g",
                                        "rho0",      "p0",    "bottom",     "start", NULL};
    const double values[] = {.01, 1.5, 3, 0, 9.81, 2, 5, -2, 0};
    const double viscous[] = {.01, 1.5, 3, .02, 9.81, 2, 5, -2, 0};
    const double crest[] = {.01, 1.5, 3, 0, 9.81, 2, 5, -2, 1};
    const double k = 2 * pi / 3, omega = sqrt(9.81 * k * tanh(1.5 * k));

    (void)state;
    for (int way = 0; way < 2; way++) {
        const struct given given = {names, way ? viscous : values};
        for (double a = -.9; a < 2; a += .3)
            for (double y = -1.9; y < -.51; y += .2) {
                const double x[3] = {a, 4, y};
                const struct motion m =
                    exacts_motion("standing-wave", &given, 3, .4, x, 1e-4, 1e-4, 0);
                near(m.div_v, 0, 1e-7);
                for (int c = 0; c < 3; c++)
                    near(2 * m.acceleration[c] + m.grad_p[c] + (c == 2 ? 2 * 9.81 : 0), 0, 1e-5);
                near(m.laplace_v[0], 0, 1e-6);
            }
        const double x[3] = {.2, 4, -2};
        near(exacts_at("standing-wave", &given, 3, .4, x).v[2], 0, 1e-16);
    }
    for (double t = 0; t < 3; t += .31) {
        const double surface[3] = {.2, 4, -.5}, later = t + pi / 2 / omega;
        const double up = .01 * cos(.2 * k) * sin(omega * t);
        const double x[3] = {.2, 4, -.5 + up};
        const struct state s = exacts_at("standing-wave", &(struct given){names, values}, 3, t, x);
        const struct state c =
            exacts_at("standing-wave", &(struct given){names, crest}, 3, later, surface);
        const struct state f =
            exacts_at("standing-wave", &(struct given){names, values}, 3, t, surface);
        /* a trough is of second order below the surface at rest */
        near(s.p, 5, up > 0 ? 1e-12 : 2 * 9.81 * k * up * up / 5);
        near(f.v[2], .01 * cos(.2 * k) * omega * cos(omega * t), 1e-14);
        for (int q = 0; q < 3; q++)
            near(c.v[q], -f.v[q], 1e-14);
        near(c.p - 5, -(f.p - 5), 1e-13);
    }
}

/* Any viscosity up to where the liquid creeps: Lamb's relation holds, and beyond it is refused. */
static void standing_wave_of_any_viscosity(void **state)
{
    (void)state;
    for (double re = .3; re < 1e9; re *= 1.3) {
        const double values[] = {2, 3, 5, 1 / re, 1}, k = 2 * pi / 5, nu = 1 / re;
        const double omega2 = 2 * k * tanh(3 * k);
        if (nu > 1.25 * sqrt(omega2) / (k * k)) {
            exacts_refuse("standing-wave", 2, &(struct given){wave_names, values}, "creeps");
            continue;
        }
        /* The relation squared, in real numbers: with s = n + nu k^2 = (a + i b)^2 nu, it is a
         * quartic for a + i b: ((z^2 + k^2)^2 + omega2 / nu^2 = 4 k^3 z. */
        double omega, beta;
        frequency_and_decay(values, &omega, &beta);
        const double re_s = (-beta + nu * k * k) / nu, im_s = omega / nu;
        const double size = hypot(re_s, im_s);
        const double a = sqrt((size + re_s) / 2), b = im_s / (2 * a);
        const double re_q = re_s + k * k, im_q = im_s;
        const double scale = omega2 / (nu * nu);
        near((re_q * re_q - im_q * im_q + scale - 4 * k * k * k * a) / scale, 0, 1e-9);
        near((2 * re_q * im_q - 4 * k * k * k * b) / scale, 0, 1e-9);
        assert_true(beta >= 0 && omega > 0);
    }
}

/* -- Elliptical drop -------- */

static void elliptical_drop_of_the_table(void **state)
{
    int columns, rows;
    double *table = plugins_table("elliptical_drop.csv", &columns, &rows);

    (void)state;
    assert_int_equal(columns, 6); /* t, A, a, b, ab, kinetic energy over density */
    assert_int_equal(rows, 21);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const double middle[2] = {0}, e = .25;
        const double along[2] = {e, 0}, across[2] = {0, e};
        const double p0 = exacts_at("elliptical-drop", NULL, 2, row[0], middle).p;
        const struct state x = exacts_at("elliptical-drop", NULL, 2, row[0], along);
        const struct state y = exacts_at("elliptical-drop", NULL, 2, row[0], across);
        /* p falls as 1 - x^2 / a^2 - y^2 / b^2 */
        const double a = e / sqrt(1 - x.p / p0), b = e / sqrt(1 - y.p / p0);
        const double rate = -x.v[0] / e;
        near(y.v[1] / e, rate, 1e-14);
        same_digits(rate, row[1], 0);
        same_digits(a, row[2], 0);
        same_digits(b, row[3], 0);
        same_digits(a * b, row[4], 1e-10);
        same_digits(pi / 8 * rate * rate * (a * a + b * b) * a * b * 2 / 2, row[5], 0);
    }
    free(table);
}

/* Euler's equations in the drop, p = 0 on and beyond its edge; a rate below 0 is a quarter turn. */
static void elliptical_drop_obeys_the_equations_of_motion(void **state)
{
    static const char *const names[] = {"radius", "rate", "rho0", NULL};

    (void)state;
    for (int way = -1; way <= 1; way += 2)
        for (double t = .1; t < 1e4; t *= 7) {
            const double values[] = {2, way * 1.5, 3};
            const struct given given = {names, values};
            const double middle[2] = {0};
            const double p0 = exacts_at("elliptical-drop", &given, 2, t, middle).p;
            double x[2] = {1e-3, 1e-3};
            const struct motion m =
                exacts_motion("elliptical-drop", &given, 2, t, x, 1e-5, 1e-5 * t, 1);
            for (int c = 0; c < 2; c++)
                near((3 * m.acceleration[c] + m.grad_p[c]) / 1e-3, 0, 1e-5);
            near(m.div_v, 0, 1e-9);
            /* A^2 (a^2 + b^2) is kept, with a b = R^2. */
            const struct state s = exacts_at("elliptical-drop", &given, 2, t, x);
            const double rate = s.v[1] / 1e-3;
            const double sum = 2 * 4 * 2.25 / (rate * rate); /* a^2 + b^2 */
            near(p0 / (3 * rate * rate * 16 / sum), 1, 1e-9);
            const double b = sqrt((sum + sqrt(fmax(0, sum * sum - 64))) / 2);
            x[way < 0 ? 0 : 1] = .999999 * b;
            x[way < 0 ? 1 : 0] = 0;
            near(exacts_at("elliptical-drop", &given, 2, t, x).p / p0, 2e-6, 1e-8);
            x[way < 0 ? 0 : 1] = 1.000001 * b;
            near(exacts_at("elliptical-drop", &given, 2, t, x).p, 0, 0);
        }
}

/* -- At rest -------- */

static void hydrostatics_balances_gravity(void **state)
{
    static const char *const names[] = {"rho0", "g",     "surface", "p0",
                                        "c0",   "gamma", "profile", NULL};

    (void)state;
    for (int tait = 0; tait < 2; tait++)
        for (int g = 1; g <= 7; g += 3)
            for (int dim = 1; dim <= 3; dim++) {
                const double values[] = {2, 3, 5, 7, 10, g, tait};
                const struct given given = {names, values};
                for (double y = -4; y < 5; y += .7) {
                    double x[3] = {1, 1, 1};
                    x[dim - 1] = y;
                    const struct motion m =
                        exacts_motion("hydrostatics", &given, dim, 1, x, 1e-4, 1, 1);
                    const struct state s = exacts_at("hydrostatics", &given, dim, 1, x);
                    near(m.grad_p[dim - 1], -3 * s.rho, 1e-8);
                    near(s.rho, tait ? 2 * pow(1 + (s.p - 7) * g / 200, 1. / g) : 2, 1e-14);
                    for (int c = 0; c < dim; c++)
                        near(s.v[c], 0, 0);
                }
                double x[3] = {1, 1, 1};
                x[dim - 1] = 5.5;
                near(exacts_at("hydrostatics", &given, dim, 1, x).p, 7, 0);
            }
    /* What is hardly compressible is nearly incompressible. */
    const double stiff[] = {2, 3, 5, 7, 1e6, 7, 1}, deep = -4;
    near(exacts_at("hydrostatics", &(struct given){names, stiff}, 1, 0, &deep).p, 7 + 54, 1e-9);
}

/* -- Rotating patch -------- */

/* Terms of the double series with m or n in (from, to], both odd; 0 for those up to from. */
static double sines(double x, double y, int from, int to)
{
    double *a = calloc((size_t)to + 1, sizeof(*a)), *b = calloc((size_t)to + 1, sizeof(*b));
    double sum = 0;

    for (int n = 1; n <= to; n += 2) {
        a[n] = sin(n * pi * (x + .5));
        b[n] = sin(n * pi * (y + .5));
    }
    for (int m = to; m >= 1; m -= 2) {
        double inner = 0;
        for (int n = to; n >= (m > from ? 1 : from + 1); n -= 2)
            if (n % 2)
                inner += b[n] / ((double)n * ((double)n * n + (double)m * m));
        sum -= 32 / (pi * pi * pi * pi) * a[m] / m * inner;
    }
    free(a);
    free(b);
    return sum;
}

/* The table's series ends at m = n = 199, which leaves it 3e-8 off: so much is added here, by the
 * terms up to 7999, and what is then left is below one unit of its digits. */
static void rotating_patch_of_the_table(void **state)
{
    int columns, rows;
    double *table = plugins_table("rotating_patch_p0.csv", &columns, &rows);

    (void)state;
    assert_int_equal(columns, 3); /* x, y, p */
    assert_int_equal(rows, 22);
    for (int i = 0; i < rows; i++) {
        const double *row = table + i * columns;
        const struct state s = exacts_at("rotating-patch", NULL, 2, 0, row);
        same_digits(s.p - sines(row[0], row[1], 200, 7999), row[2], 1e-15);
        near(s.v[0], row[1], 0);
        near(s.v[1], -row[0], 0);
    }
    free(table);
}

/* laplace(p) = 2 rho omega^2, 0 on the sides and outside, the same after a quarter turn; also close
 * to the corners. */
static void rotating_patch_starts_to_turn(void **state)
{
    static const char *const names[] = {"side", "omega", "rho0", "x0", "y0", NULL};
    static const double values[] = {2, 3, 5, 10, 20};
    const struct given given = {names, values};

    (void)state;
    for (double a = -.99; a < 1; a += .11)
        for (double b = -.99; b < 1; b += .11) {
            const double x[2] = {10 + a, 20 + b}, turned[2] = {10 - b, 20 + a};
            const struct motion m = exacts_motion("rotating-patch", &given, 2, -1, x, 2e-4, 1, 0);
            const double p = exacts_at("rotating-patch", &given, 2, 0, x).p;
            near(m.laplace_p, 2 * 5 * 9, 1e-4);
            near(exacts_at("rotating-patch", &given, 2, 0, turned).p, p, 1e-11);
            assert_true(p < 0);
        }
    for (double b = -1; b <= 1; b += .1) {
        const double side[2] = {10 + 1 - 1e-9, 20 + b}, outside[2] = {10 + b, 20 + 1.001};
        near(exacts_at("rotating-patch", &given, 2, 0, side).p, 0, 1e-6);
        near(exacts_at("rotating-patch", &given, 2, 0, outside).p, 0, 0);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(taylor_green_of_the_table),
        cmocka_unit_test(taylor_green_obeys_the_equations_of_motion),
        cmocka_unit_test(poiseuille_of_the_table),
        cmocka_unit_test(couette_of_the_table),
        cmocka_unit_test(walls_obey_the_equations_of_motion),
        cmocka_unit_test(standing_wave_of_the_table),
        cmocka_unit_test(standing_wave_obeys_the_equations_of_motion),
        cmocka_unit_test(standing_wave_of_any_viscosity),
        cmocka_unit_test(elliptical_drop_of_the_table),
        cmocka_unit_test(elliptical_drop_obeys_the_equations_of_motion),
        cmocka_unit_test(hydrostatics_balances_gravity),
        cmocka_unit_test(rotating_patch_of_the_table),
        cmocka_unit_test(rotating_patch_starts_to_turn),
    };

    exacts_filter(argc, argv);
    return cmocka_run_group_tests(tests, exacts_load, exacts_unload);
}
