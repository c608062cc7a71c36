/* exacts.c -- see exacts.h. */
#include "config.h"

#include "exacts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct registry registry;

int exacts_load(void **state)
{
    (void)state;
    plugins_load(&registry, "exact");
    return 0;
}

int exacts_unload(void **state)
{
    (void)state;
    registry_fini(&registry);
    return 0;
}

void exacts_filter(int argc, char **argv)
{
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
}

struct fields fields_new(int dim, uint64_t n)
{
    struct fields f = {.dim = dim, .n = n};
    const uint64_t vector = (uint64_t)dim * n;
    double *all = calloc(3 * vector + 3 * n, sizeof(*all));

    assert_non_null(all);
    f.x = all;
    f.v = f.x + vector;
    f.d = f.v + vector;
    f.rho = f.d + vector;
    f.p = f.rho + n;
    f.u = f.p + n;
    return f;
}

void fields_free(struct fields *f)
{
    free(f->x);
}

static double *field(const struct fields *f, const char *name)
{
    return strcmp(name, "x") == 0     ? f->x
           : strcmp(name, "rho") == 0 ? f->rho
           : strcmp(name, "p") == 0   ? f->p
           : strcmp(name, "u") == 0   ? f->u
           : strcmp(name, "v") == 0   ? f->v
                                      : f->d;
}

static const sph_exact *begin(struct trial *use, const char *name, const struct given *given,
                              const struct fields *f)
{
    const sph_exact *exact = entry_exact(plugins_find(&registry, KIND_EXACT, name));
    const sph_prop *prop = exact->item->props.data;

    trial_init(use, &registry, exact->item, exact->life, &exact->item->props, f->dim,
               given ? given->names : NULL, given ? given->values : NULL);
    for (uint32_t k = 0; k < exact->item->props.count; k++)
        use_column(use, k, field(f, prop[k].name), f->n);
    return exact;
}

void exacts_solve(const char *name, const struct given *given, double time, struct fields *f)
{
    struct trial use;
    const sph_exact *exact = begin(&use, name, given, f);

    assert_int_equal(use_run(&use, exact->run, time, f->n), SPH_OK);
    trial_fini(&use);
}

struct state exacts_at(const char *name, const struct given *given, int dim, double time,
                       const double *x)
{
    struct fields f = fields_new(dim, 1);
    struct state s = {0};

    memcpy(f.x, x, (size_t)dim * sizeof(*x));
    exacts_solve(name, given, time, &f);
    s.rho = *f.rho;
    s.p = *f.p;
    s.u = *f.u;
    memcpy(s.v, f.v, (size_t)dim * sizeof(*x));
    memcpy(s.d, f.d, (size_t)dim * sizeof(*x));
    fields_free(&f);
    return s;
}

static void says(sph_status status, const char *text)
{
    char why[512];

    registry_reason(&registry, status, why, sizeof(why));
    if (!strstr(why, text))
        fail_msg("\"%s\" does not say \"%s\"", why, text);
}

void exacts_refuse(const char *name, int dim, const struct given *given, const char *text)
{
    const sph_exact *exact = entry_exact(plugins_find(&registry, KIND_EXACT, name));
    struct sph_config config;
    struct error e = {0};
    void *state = NULL;

    assert_int_equal(config_init(&config, exact->item, &e), 0);
    plugins_set(&config, exact->item, given->names, given->values);
    const sph_status status = exact->life->create(&registry.host, &config, (uint32_t)dim, &state);
    assert_int_not_equal(status, SPH_OK);
    assert_null(state);
    says(status, text);
    config_fini(&config);
}

void exacts_refuse_run(const char *name, int dim, const struct given *given, double time,
                       const char *text)
{
    struct fields f = fields_new(dim, 1);
    struct trial use;
    const sph_exact *exact = begin(&use, name, given, &f);
    const sph_status status = use_run(&use, exact->run, time, 1);

    assert_int_not_equal(status, SPH_OK);
    says(status, text);
    trial_fini(&use);
    fields_free(&f);
}

void near(double got, double wanted, double tolerance)
{
    if (!(fabs(got - wanted) <= tolerance * fmax(1, fabs(wanted))))
        fail_msg("%.12g, not %.12g", got, wanted);
}

double last_digit(double printed, int digits)
{
    return printed == 0 ? 0 : pow(10, floor(log10(fabs(printed))) - digits + 1);
}

void same_digits(double got, double printed, double rounding)
{
    /* A little more than one: the numbers are binary. */
    const double most = fmax(last_digit(printed, 10) * (1 + 1e-5), rounding);

    if (!(fabs(got - printed) <= most))
        fail_msg("%.12g, not %.10g", got, printed);
}

void same_digits_between(double low, double got, double high, double printed)
{
    if (fabs(high - low) > 1e-3 * fabs(got)) { /* a jump: the table is on either side */
        same_digits(fabs(low - printed) < fabs(high - printed) ? low : high, printed, 0);
        return;
    }
    const double nearest = fmin(fmax(printed, fmin(low, high)), fmax(low, high));
    same_digits(nearest, printed, 0);
}

struct motion exacts_motion(const char *name, const struct given *given, int dim, double time,
                            const double *x, double step, double time_step, int convective)
{
    const struct state s = exacts_at(name, given, dim, time, x);
    const struct state before = exacts_at(name, given, dim, time - time_step, x);
    const struct state after = exacts_at(name, given, dim, time + time_step, x);
    struct motion m = {.div_v = 0};

    for (int c = 0; c < dim; c++)
        m.acceleration[c] = (after.v[c] - before.v[c]) / (2 * time_step);
    for (int c = 0; c < dim; c++) {
        double a[3], b[3];
        memcpy(a, x, (size_t)dim * sizeof(*x));
        memcpy(b, x, (size_t)dim * sizeof(*x));
        a[c] -= step;
        b[c] += step;
        const struct state l = exacts_at(name, given, dim, time, a);
        const struct state r = exacts_at(name, given, dim, time, b);
        m.grad_p[c] = (r.p - l.p) / (2 * step);
        m.laplace_p += (l.p - 2 * s.p + r.p) / (step * step);
        m.div_v += (r.v[c] - l.v[c]) / (2 * step);
        for (int k = 0; k < dim; k++) {
            m.laplace_v[k] += (l.v[k] - 2 * s.v[k] + r.v[k]) / (step * step);
            if (convective)
                m.acceleration[k] += s.v[c] * (r.v[k] - l.v[k]) / (2 * step);
        }
    }
    return m;
}
