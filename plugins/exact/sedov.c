/* sedov.c -- Sedov's explosion: energy set free at a plane, an axis or a point of cold gas.
 * L. I. Sedov, Similarity and Dimensional Methods in Mechanics (1959), chapter 4, in the notation
 * of J. R. Kamm & F. X. Timmes, LA-UR-07-2849 (2007), "standard case", with omega = 0.
 *
 * Their parameter V is taken by y = x2 = b (c V - 1), which runs from 0 at the centre to 1 at the
 * shock. The other three are linear in z = 1 - y there, and all powers are taken by logarithms, so
 * that nothing cancels at either end; and a4, a5, which grow without bounds as gamma comes to 2,
 * are only used in combinations that stay. */
#include "exact.h"

#include <stdlib.h>

static const sph_item item;

enum { PARAM_GAMMA, PARAM_ENERGY, PARAM_RHO0 };
static const sph_param params[] = {
    SPH_PARAM("gamma", "", "ratio of the specific heats; in 3D less than 7", 5. / 3, 1.000001, 100),
    SPH_PARAM("energy", "J", "set free at time 0; in 1D on each side of the plane", 1, 1e-300,
              1e300),
    SPH_PARAM("rho0", "kg/m^d", "density at the start", 1, 1e-300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X, EXACT_RHO, EXACT_P, EXACT_V, EXACT_U,
};

struct blast {
    double j, s;          /* dimensions; gamma - 1 */
    double gamma, e;      /* e: 2 - gamma */
    double a0, a1, a2;    /* exponents */
    double a3, a45;       /* a45: a4 + a5 */
    double k1, k3, k34;   /* x1 = 1 - k1 z, x3 = 1 + k3 z, x3 / x4 = 1 + e k34 z / x4 */
    double energy, alpha; /* energy t^2 = alpha rho0 r2^(j + 2) */
    double rho0;
};

/* What the similarity functions have at y = exp(w). */
struct similar {
    double log_lambda; /* of r / r2 */
    double slope;      /* d log_lambda / dw */
    double f;          /* velocity over that behind the shock, over lambda */
    double log_g;      /* of the density, likewise */
    double log_h;      /* of the pressure, likewise */
};

static struct similar similar_at(const struct blast *k, double w)
{
    const double y = exp(w), z = -expm1(w);
    const double x1 = 1 - k->k1 * z, x3 = 1 + k->k3 * z, x4 = 1 + z / k->gamma;
    const double l1 = log(x1), l3 = log1p(k->k3 * z), l4 = log1p(z / k->gamma);
    const double ratio = k->k34 * z / x4;
    /* a4 log(x3 / x4), a4 = (j + 2) a1 / e */
    const double l34 = k->e == 0 ? ratio : log1p(k->e * ratio) / k->e;
    const double powers = (k->j + 2) * k->a1 * l34 + k->a45 * l4;

    return (struct similar){
        .log_lambda = -k->a0 * l1 - k->a2 * w - k->a1 * l3,
        .slope = -k->a2 + y * (k->a1 * k->k3 / x3 - k->a0 * k->k1 / x1),
        .f = x1,
        .log_g = k->a3 * w + powers,
        .log_h = k->a0 * k->j * l1 + powers + l4 - 2 * k->a1 * l3,
    };
}

/* Integral of (g f^2 + h) lambda^(j - 1) over lambda, by the double exponential rule in
 * w = -exp(pi/2 sinh t), for both the layer at the shock and the long way to the centre. */
static double energy_integral(const struct blast *k, double step)
{
    double sum = 0;

    for (double t = -4.25; t <= 4.25; t += step) {
        const double w = -exp(EXACT_PI / 2 * sinh(t));
        const struct similar s = similar_at(k, w);
        const double volume = exp(k->j * s.log_lambda);
        const double kinetic = exp(s.log_g + 2 * s.log_lambda) * s.f * s.f;
        sum -= (kinetic + exp(s.log_h)) * volume * s.slope * w * cosh(t);
    }
    return EXACT_PI / 2 * step * sum;
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    const double gamma = host->param(c, "gamma"), j = dim, s = gamma - 1, e = 2 - gamma;
    const double area[] = {0, 1, 2 * EXACT_PI, 4 * EXACT_PI};
    const double d = j * (3 - gamma) + 2 * s;
    struct blast *k = calloc(1, sizeof(*k));

    if (!k)
        return SPH_E_NOMEM;
    if (!(d > 0)) {
        free(k);
        return exact_fail(host, SPH_E_INVALID,
                          "with a gamma of %g a vacuum opens in the middle in 3D: it must be less "
                          "than 7",
                          gamma);
    }
    *k = (struct blast){.j = j, .s = s, .gamma = gamma, .e = e};
    k->a0 = 2 / (j + 2);
    k->a2 = -s / (2 * s + j);
    k->a1 = (j + 2) * gamma / (2 + j * s) * (2 * j * e / (gamma * (j + 2) * (j + 2)) - k->a2);
    k->a3 = j / (2 * s + j);
    k->a45 = 2 * j / (2 + j * s) - (s * (j * j + 4) + 4 * j) / ((2 + j * s) * (2 * s + j));
    k->k1 = s / (2 * gamma);
    k->k3 = (2 + j * s) * s / (d * gamma);
    k->k34 = -j * (s + 2) / (d * gamma);
    k->energy = host->param(c, "energy");
    k->rho0 = host->param(c, "rho0");
    k->alpha = area[dim] * 8 / (s * (gamma + 1) * (j + 2) * (j + 2)) * energy_integral(k, 1. / 128);
    if (!(fabs(energy_integral(k, 1. / 64) / energy_integral(k, 1. / 128) - 1) < 1e-12)) {
        free(k);
        return exact_fail(host, SPH_E_NUMERIC, "no energy integral for a gamma of %g", gamma);
    }
    *state = k;
    return SPH_OK;
}

/* At one time: radius of the shock, and what is behind it. */
struct moment {
    const struct blast *blast;
    double r2, rho2, p2, v2;
};

struct target {
    const struct blast *blast;
    double log_lambda;
};

static double mismatch(const void *of, double w, double *derivative)
{
    const struct target *t = of;
    const struct similar s = similar_at(t->blast, w);

    *derivative = s.slope;
    return s.log_lambda - t->log_lambda;
}

/* log y where log lambda is l < 0. Both terms beside -a2 log y run from 0 at the shock to an end of
 * one sign at the centre: that gives a bracket. */
static double place_of(const struct blast *k, double l)
{
    const struct target t = {k, l};
    const double end1 = -k->a0 * log1p(-k->k1), end3 = -k->a1 * log1p(k->k3);
    const double low = (l - fmax(0, end1) - fmax(0, end3)) / -k->a2;
    const double high = fmin(0, (l - fmin(0, end1) - fmin(0, end3)) / -k->a2);

    return exact_root(mismatch, &t, low, high);
}

static void at(const void *of, struct exact_point *q)
{
    const struct moment *m = of;
    const struct blast *k = m->blast;
    const double r = hypot(hypot(q->x[0], q->x[1]), q->x[2]);
    const double lambda = r / m->r2;

    q->rho = k->rho0;
    if (!(lambda < 1))
        return;

    const struct similar s = similar_at(k, place_of(k, log(fmax(lambda, 1e-300))));

    q->rho = m->rho2 * exp(s.log_g);
    q->p = m->p2 * exp(s.log_h);
    /* p / ((gamma - 1) rho), which grows without bounds at the centre. */
    q->u = m->p2 / (k->s * m->rho2) * exp(s.log_h - s.log_g);
    for (int c = 0; c < 3; c++)
        q->v[c] = m->v2 * s.f * q->x[c] / m->r2;
}

static sph_status run(const sph_batch *b)
{
    const struct blast *k = b->state;
    const double t = b->time;
    struct moment m = {.blast = k};

    if (t > 0) {
        m.r2 = pow(k->energy / k->alpha / k->rho0 * t * t, 1 / (k->j + 2));
        const double speed = 2 * m.r2 / ((k->j + 2) * t);
        m.rho2 = k->rho0 * (k->gamma + 1) / k->s;
        m.v2 = 2 * speed / (k->gamma + 1);
        m.p2 = 2 * k->rho0 * speed * speed / (k->gamma + 1);
    }
    return exact_each(b, &item, at, &m);
}

static const sph_life life = {
    .size = (uint32_t)sizeof(sph_life),
    .create = create,
    .destroy = exact_free,
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "sedov",
    .doc = "Sedov's explosion in cold gas, from a plane (1D, x = 0), an axis (2D) or a point (3D); "
           "u has no bound at the centre",
    .source = "Sedov 1959, chapter 4; Kamm & Timmes 2007, LA-UR-07-2849, standard case",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact sedov = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .life = &life,
    .run = run,
};
