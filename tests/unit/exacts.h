/* exacts.h -- for tests of the plugin "exact": its solutions at given places, their derivatives,
 * and the comparison with tables to the last digit that they print. */
#ifndef TEST_EXACTS_H
#define TEST_EXACTS_H

#include "plugins.h"

/* Fields at n places, of `dim` components of x, v and d each: component c of place i is
 * x[c * n + i]. What a solution does not know stays 0. */
struct fields {
    double *x, *rho, *p, *u, *v, *d;
    int dim;
    uint64_t n;
};

/* One of them. */
struct state {
    double rho, p, u, v[3], d[3];
};

/* Parameters: names, ended by NULL, and their values. NULL: the defaults. */
struct given {
    const char *const *names;
    const double *values;
};

/* Set-up and tear-down of a group of tests. */
int exacts_load(void **state);
int exacts_unload(void **state);
/* An argument of the test program names the only test to run; with * and ? as wildcards. */
void exacts_filter(int argc, char **argv);

struct fields fields_new(int dim, uint64_t n);
void fields_free(struct fields *f);

void exacts_solve(const char *name, const struct given *given, double time, struct fields *f);
/* At one place. */
struct state exacts_at(const char *name, const struct given *given, int dim, double time,
                       const double *x);
/* `create` refuses with a sentence that holds `text`. */
void exacts_refuse(const char *name, int dim, const struct given *given, const char *text);
/* `run` refuses likewise. */
void exacts_refuse_run(const char *name, int dim, const struct given *given, double time,
                       const char *text);

/* |got - wanted| <= tolerance max(1, |wanted|) */
void near(double got, double wanted, double tolerance);

/* -- Tables: %.10g -------- */

/* One unit of the last of `digits` printed digits. */
double last_digit(double printed, int digits);
/* Within one unit of the last of ten digits; where the table prints the rounding of a sum that
 * cancels, within `rounding`. */
void same_digits(double got, double printed, double rounding);
/* The same, of a function of a printed number: `low`, `got` and `high` are its values half a unit
 * below that number, at it, and above it. */
void same_digits_between(double low, double got, double high, double printed);

/* -- Derivatives, by central differences over `step` -------- */

/* Of a liquid: acceleration of a particle, with (convective = 1) or without v grad v; gradients of
 * the pressure; Laplacian and divergence of v. */
struct motion {
    double acceleration[3], grad_p[3], laplace_v[3];
    double div_v, laplace_p;
};
struct motion exacts_motion(const char *name, const struct given *given, int dim, double time,
                            const double *x, double step, double time_step, int convective);

#endif
