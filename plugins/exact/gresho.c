/* gresho.c -- the vortex of Gresho and Chan: pressure holds a ring that turns against its
 * centrifugal force, for ever.
 * P. M. Gresho & S. T. Chan, Int. J. Numer. Methods Fluids 11 (1990) 621,
 * doi:10.1002/fld.1650110510; for gases R. Liska & B. Wendroff, SIAM J. Sci. Comput. 25 (2003) 995,
 * doi:10.1137/S1064827502402120. */
#include "exact.h"

static const sph_item item;

enum { RADIUS, V0, RHO0, P0, GAMMA, X0, Y0 };
static const sph_param params[] = {
    SPH_PARAM("radius", "m", "where it turns fastest; beyond twice that it rests", .2, 1e-300,
              1e300),
    SPH_PARAM("v0", "m/s", "speed there; positive is anticlockwise", 1, -1e300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density, the same all over", 1, 1e-300, 1e300),
    SPH_PARAM("p0", "J/m^d", "pressure in the centre", 5, 0, 1e300),
    SPH_PARAM("gamma", "", "ratio of the specific heats", 5. / 3, 1.000001, 100),
    SPH_PARAM("x0", "m", "x of the centre", 0, -1e300, 1e300),
    SPH_PARAM("y0", "m", "y of the centre", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X, EXACT_RHO, EXACT_P, EXACT_V, EXACT_U,
};

static void at(const void *of, struct exact_point *q)
{
    const double *param = of;
    const double x = q->x[0] - param[X0], y = q->x[1] - param[Y0];
    const double s = hypot(x, y) / param[RADIUS];
    double per_radius = 0; /* speed over r, in units of v0 / radius */
    double head;           /* integral of v^2 / r, in units of v0^2 */

    if (s < 1) {
        per_radius = 1;
        head = s * s / 2;
    } else if (s < 2) {
        per_radius = 2 / s - 1;
        head = 4 + s * s / 2 - 4 * s + 4 * log(s);
    } else {
        head = 4 * log(2) - 2;
    }
    const double turn = per_radius * param[V0] / param[RADIUS];
    q->rho = param[RHO0];
    q->p = param[P0] + param[RHO0] * param[V0] * param[V0] * head;
    q->u = q->p / ((param[GAMMA] - 1) * q->rho);
    q->v[0] = -turn * y;
    q->v[1] = turn * x;
}

static sph_status run(const sph_batch *b)
{
    return exact_each(b, &item, at, b->param);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "gresho",
    .doc = "the steady vortex of Gresho and Chan in the x-y plane",
    .source = "Gresho & Chan 1990, doi:10.1002/fld.1650110510; Liska & Wendroff 2003, "
              "doi:10.1137/S1064827502402120",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact gresho = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
