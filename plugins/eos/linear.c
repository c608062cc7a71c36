/* linear.c -- p = c0^2 (rho - rho0) + p0: a fluid whose speed of sound is the same at every density, with its
 * energy of compression, u = integral of p / rho^2 drho from rho0 on. Landau & Lifshitz, Fluid Mechanics
 * (1987), section 64 (sound), section 2 (du = p / rho^2 drho at constant entropy). */
#include "eos.h"

#include <math.h>

enum { RHO, P, CS, U };
enum { C0, RHO0, P0 };

static const sph_param params[] = {
    SPH_PARAM("c0", "m/s", "speed of sound", NAN, 1e-300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density at which the pressure is p0", NAN, 1e-300, 1e300),
    SPH_PARAM("p0", "J/m^d", "background pressure", 0, -1e300, 1e300),
};
static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("u", "J/kg", "specific energy of compression, 0 at rho0", SPH_SCALAR, SPH_DST_WRITE,
             0),
};
static const sph_prop inverse_props[] = {
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_WRITE, 0),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P_) P_(scalar, rho, RHO)
#define SPH_POINT_OUT(P_) P_(scalar, p, P) P_(scalar, cs, CS) P_(scalar, u, U)
#define SPH_POINT_PARAM(P_) P_(c0, C0) P_(rho0, RHO0) P_(p0, P0)
#define SPH_POINT_BODY "linear.body.h"
#define SPH_POINT_DEVICE linear_device
#include <sph/point-loop.h>

static sph_status inverse(const sph_batch *b)
{
    const double c0 = b->param[C0], rho0 = b->param[RHO0], p0 = b->param[P0];
    const double *p = b->dst[0].data;
    double *rho = b->dst[1].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        rho[i] = rho0 + (p[i] - p0) / (c0 * c0);
        if (!(rho[i] > 0.0))
            return b->host->fail(b->host, SPH_E_NUMERIC,
                                 "linear: no density has so low a pressure: p - p0 must be above "
                                 "-c0^2 rho0");
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "linear",
    .doc = "linear barotropic fluid: p = c0^2 (rho - rho0) + p0, with its energy of compression",
    .source = "Landau & Lifshitz, Fluid Mechanics (1987), section 64",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_eos linear = {
    .size = (uint32_t)sizeof(sph_eos),
    .item = &item,
    .run = run,
    .inverse = inverse,
    .inverse_props = SPH_LIST(inverse_props),
    .device = &linear_device,
};
