/* acoustic_wave.c -- a sound wave that travels along x in an ideal gas.
 * L. D. Landau & E. M. Lifshitz, Fluid Mechanics (1987), sections 64 (linear) and 101 (simple
 * waves). */
#include "exact.h"

static const sph_item item;

enum { AMPLITUDE, WAVENUMBER, RHO0, P0, GAMMA, WAVE };
static const sph_param params[] = {
    SPH_PARAM("amplitude", "", "largest change of the density over rho0", 1e-6, -.5, .5),
    SPH_PARAM("wavenumber", "1/m", "2 pi over the wavelength", 2 * EXACT_PI, 1e-300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density at rest", 1, 1e-300, 1e300),
    SPH_PARAM("p0", "J/m^d", "pressure at rest; the default makes the speed of sound 1", 1 / 1.4,
              1e-300, 1e300),
    SPH_PARAM("gamma", "", "ratio of the specific heats", 1.4, 1.000001, 100),
    SPH_PARAM_CHOICE("wave",
                     "linear: to first order in the amplitude, no second order terms; simple: in "
                     "full, until it breaks",
                     0, "linear|simple"),
};

static const sph_prop props[] = {
    EXACT_X, EXACT_RHO, EXACT_P, EXACT_V, EXACT_U,
};

struct wave {
    double amplitude, k, rho0, p0, gamma;
    double c0, t;
    double x; /* where the root is looked for */
};

static void linear(const void *of, struct exact_point *q)
{
    const struct wave *w = of;
    const double s = w->amplitude * sin(w->k * (q->x[0] - w->c0 * w->t));

    q->rho = w->rho0 * (1 + s);
    q->p = w->p0 * (1 + w->gamma * s);
    q->u = w->p0 / ((w->gamma - 1) * w->rho0) * (1 + (w->gamma - 1) * s);
    q->v[0] = w->c0 * s;
}

/* Characteristics carry their density with v + c, where v - 2 c / (gamma - 1) is the same all over:
 * x = start + (v + c) t. */
static double arrival(const void *of, double start, double *derivative)
{
    const struct wave *w = of;
    const double g = w->gamma;
    const double ratio = 1 + w->amplitude * sin(w->k * start);
    const double c = w->c0 * pow(ratio, (g - 1) / 2);
    const double slope = w->amplitude * w->k * cos(w->k * start) / ratio;

    *derivative = 1 + (g + 1) / 2 * c * slope * w->t;
    return start + (w->c0 + (g + 1) / (g - 1) * (c - w->c0)) * w->t - w->x;
}

static void simple(const void *of, struct exact_point *q)
{
    struct wave w = *(const struct wave *)of;
    const double g = w.gamma, most = fabs(w.amplitude);
    const double slow = w.c0 * pow(1 - most, (g - 1) / 2) - w.c0;
    const double fast = w.c0 * pow(1 + most, (g - 1) / 2) - w.c0;
    const double middle = q->x[0] - w.c0 * w.t;

    w.x = q->x[0];
    /* A little wider than needed, for a wave of no amplitude. */
    const double margin = 1e-3 / w.k;
    const double start = exact_root(arrival, &w, middle - (g + 1) / (g - 1) * fast * w.t - margin,
                                    middle - (g + 1) / (g - 1) * slow * w.t + margin);
    const double ratio = 1 + w.amplitude * sin(w.k * start);

    q->rho = w.rho0 * ratio;
    q->p = w.p0 * pow(ratio, g);
    q->u = q->p / ((g - 1) * q->rho);
    q->v[0] = 2 * w.c0 / (g - 1) * (pow(ratio, (g - 1) / 2) - 1);
}

static sph_status run(const sph_batch *b)
{
    struct wave w = {b->param[AMPLITUDE],
                     b->param[WAVENUMBER],
                     b->param[RHO0],
                     b->param[P0],
                     b->param[GAMMA],
                     0,
                     b->time,
                     0};

    w.c0 = sqrt(w.gamma * w.p0 / w.rho0);
    if (b->param[WAVE] == 0)
        return exact_each(b, &item, linear, &w);

    /* The steepest slope of v + c, or a little more: it breaks when that has grown to infinity. */
    const double steepest = (w.gamma + 1) / 2 * w.c0 * w.k * fabs(w.amplitude) *
                            pow(1 + (w.gamma > 3 ? 1 : -1) * fabs(w.amplitude), (w.gamma - 3) / 2);
    if (steepest * w.t >= 1)
        return exact_fail(b->host, SPH_E_NUMERIC,
                          "a simple wave of amplitude %g breaks about time %g; this is time %g",
                          w.amplitude, 1 / steepest, w.t);
    return exact_each(b, &item, simple, &w);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "acoustic-wave",
    .doc = "a sound wave that travels along x; at time 0 rho is rho0 (1 + amplitude sin(wavenumber "
           "x))",
    .source = "Landau & Lifshitz, Fluid Mechanics (1987), sections 64, 101",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact acoustic_wave = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
