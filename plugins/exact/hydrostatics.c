/* hydrostatics.c -- a liquid at rest under gravity: incompressible, or with Tait's equation.
 * L. D. Landau & E. M. Lifshitz, Fluid Mechanics (1987), section 3: grad p = rho g, and so w + g y
 * is the same all over, with the enthalpy w of Tait's liquid,
 * w = c0^2 / (gamma - 1) ((rho / rho0)^(gamma - 1) - 1). */
#include "exact.h"

static const sph_item item;

enum { RHO0, GRAVITY, SURFACE, P0, PROFILE, C0, GAMMA };
static const sph_param params[] = {
    SPH_PARAM("rho0", "kg/m^d", "density at the surface", 1000, 1e-300, 1e300),
    SPH_PARAM("g", "m/s^2", "gravity, against the last axis", 9.81, 0, 1e300),
    SPH_PARAM("surface", "m", "last coordinate of the surface; above it is what is at it", 1,
              -1e300, 1e300),
    SPH_PARAM("p0", "J/m^d", "pressure at the surface", 0, -1e300, 1e300),
    SPH_PARAM_CHOICE("profile", "a density that stays rho0, or that of Tait's equation", 0,
                     "incompressible|tait"),
    SPH_PARAM("c0", "m/s", "of tait: speed of sound at the surface", 31.32, 1e-150, 1e150),
    SPH_PARAM("gamma", "", "of tait: its exponent", 7, 1, 100),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_RHO,
    EXACT_P,
    EXACT_V,
};

struct tank {
    const double *param;
    uint32_t up; /* the last axis */
};

static void at(const void *of, struct exact_point *q)
{
    const struct tank *t = of;
    const double *param = t->param;
    const double head = param[GRAVITY] * fmax(0, param[SURFACE] - q->x[t->up]);

    q->rho = param[RHO0];
    q->p = param[P0] + param[RHO0] * head;
    if (param[PROFILE] == 1) {
        const double g = param[GAMMA], c2 = param[C0] * param[C0];
        /* log(rho / rho0), without cancellation near the surface */
        const double log_ratio = g == 1 ? head / c2 : log1p((g - 1) * head / c2) / (g - 1);
        q->rho = param[RHO0] * exp(log_ratio);
        q->p = param[P0] + c2 * param[RHO0] / g * expm1(g * log_ratio);
    }
}

static sph_status run(const sph_batch *b)
{
    const struct tank t = {b->param, b->dim - 1};

    return exact_each(b, &item, at, &t);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "hydrostatics",
    .doc = "a liquid at rest under gravity along the last axis",
    .source = "Landau & Lifshitz, Fluid Mechanics (1987), section 3",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact hydrostatics = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
