/* standing_wave.c -- a standing gravity wave of a viscous liquid, of finite depth and small
 * amplitude.
 * H. Lamb, Hydrodynamics (1932), sections 228 (inviscid, finite depth), 348, 349 (viscous). The
 * decay and the frequency are those of Lamb's viscous dispersion; the velocity is that of potential
 * flow. What viscosity adds to it, a layer of vorticity of thickness sqrt(2 nu / omega) at the
 * surface, is left out. */
#include "exact.h"

#include <complex.h>
#include <stdlib.h>

static const sph_item item;

static const sph_param params[] = {
    SPH_PARAM("amplitude", "m", "of the surface, were there no viscosity", .05, -1e300, 1e300),
    SPH_PARAM("depth", "m", "of the liquid at rest", 1, 1e-300, 1e300),
    SPH_PARAM("wavelength", "m", "along x; a crest is at x = 0", 2, 1e-90, 1e90),
    SPH_PARAM("nu", "m^2/s", "kinematic viscosity", .004, 0, 1e300),
    SPH_PARAM("g", "m/s^2", "gravity, against the last axis", 1, 1e-300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density", 1, 1e-300, 1e300),
    SPH_PARAM("p0", "J/m^d", "pressure at the surface", 0, -1e300, 1e300),
    SPH_PARAM("bottom", "m", "last coordinate of the bottom, along which it slips", 0, -1e300,
              1e300),
    SPH_PARAM_CHOICE("start",
                     "at time 0: a flat surface, moving; or a crest, at rest but for its "
                     "decay",
                     0, "flat|crest"),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_P,
    EXACT_V,
};

struct wave {
    double amplitude, depth, k, nu, g, rho0, p0, bottom;
    double complex n; /* -beta + i omega: the surface goes with exp(n t) */
    int crest;
    uint32_t up; /* the last axis */
};

/* Lamb's relation (n + 2 nu k^2)^2 + omega0^2 = 4 nu^2 k^3 sqrt(k^2 + n / nu), by Newton's
 * iteration from a root that is near. */
static double complex dispersion(const struct wave *w, double nu, double complex n)
{
    const double k = w->k, k2 = k * k;
    const double omega2 = w->g * k * tanh(k * w->depth);
    const double strength = 2 * pow(nu, 1.5) * k * k2;

    for (int i = 0; i < 60; i++) {
        const double complex root = csqrt(nu * k2 + n), sum = n + 2 * nu * k2;
        const double complex value = sum * sum + omega2 - 2 * strength * root;
        const double complex step = value / (2 * sum - strength / root);
        n -= step;
        if (cabs(step) <= 1e-16 * cabs(n))
            break;
    }
    return n;
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    struct wave *w = calloc(1, sizeof(*w));

    if (!w)
        return SPH_E_NOMEM;
    *w = (struct wave){
        .amplitude = host->param(c, "amplitude"),
        .depth = host->param(c, "depth"),
        .k = 2 * EXACT_PI / host->param(c, "wavelength"),
        .nu = host->param(c, "nu"),
        .g = host->param(c, "g"),
        .rho0 = host->param(c, "rho0"),
        .p0 = host->param(c, "p0"),
        .bottom = host->param(c, "bottom"),
        .crest = host->param(c, "start") == 1,
        .up = dim - 1,
    };
    const double omega = sqrt(w->g * w->k * tanh(w->k * w->depth));
    const double limit = 1.25 * omega / (w->k * w->k);

    /* At 1.3 the frequency falls to 0, and the surface creeps back (Lamb, section 349). */
    if (!(w->nu <= limit)) {
        const double nu = w->nu;
        free(w);
        return exact_fail(host, SPH_E_INVALID,
                          "with a nu of %g the liquid creeps and does not swing: nu must not be "
                          "above %g",
                          nu, limit);
    }
    w->n = I * omega;
    for (int i = 1; i <= 100; i++)
        w->n = dispersion(w, w->nu * i / 100, w->n);
    *state = w;
    return SPH_OK;
}

/* At one time: the wave, and rate and acceleration of the surface under its crest. */
struct moment {
    const struct wave *wave;
    double rate, acceleration;
};

static void at(const void *of, struct exact_point *q)
{
    const struct moment *m = of;
    const struct wave *w = m->wave;
    const double y = q->x[w->up] - w->bottom;
    const double phase = w->k * q->x[0];
    /* Above the surface at rest the velocity is that at it, which is right to first order. */
    const double below = fmin(fmax(y, 0), w->depth);
    const double rise = exp(w->k * (below - w->depth)), fall = exp(-w->k * (below + w->depth));
    const double sinh_depth = 1 - exp(-2 * w->k * w->depth);
    const double c = (rise + fall) / sinh_depth; /* cosh(k y) / sinh(k depth) */
    const double s = (rise - fall) / sinh_depth;

    q->v[0] = -m->rate * c * sin(phase);
    q->v[w->up] = m->rate * s * cos(phase);
    q->p = w->p0 + w->rho0 * (w->g * (w->depth - y) - m->acceleration / w->k * c * cos(phase));
}

static sph_status run(const sph_batch *b)
{
    const struct wave *w = b->state;
    /* The surface is the real part of `surface`, its rate that of n surface. */
    const double complex surface = (w->crest ? 1 : -I) * w->amplitude * cexp(w->n * b->time);
    const struct moment m = {w, creal(w->n * surface), creal(w->n * w->n * surface)};

    return exact_each(b, &item, at, &m);
}

static const sph_life life = {
    .size = (uint32_t)sizeof(sph_life),
    .create = create,
    .destroy = exact_free,
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "standing-wave",
    .doc =
        "a standing gravity wave of small amplitude: potential flow that decays as Lamb's viscous "
        "dispersion has it",
    .source = "Lamb, Hydrodynamics (1932), sections 228, 349",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact standing_wave = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .life = &life,
    .run = run,
};
