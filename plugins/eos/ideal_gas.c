/* ideal_gas.c -- p = (gamma - 1) rho u, c^2 = gamma p / rho; any textbook, as L. D. Landau &
 * E. M. Lifshitz, Fluid Mechanics (1987), paragraph 83. */
#include "eos.h"

#include <math.h>

enum { RHO, U, P, CS };
enum { GAMMA };

static const sph_param params[] = {
    SPH_PARAM("gamma", "", "ratio of the specific heats", 5. / 3, 1.000001, 100),
};
static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0),
};
static const sph_prop inverse_props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P_) P_(scalar, rho, RHO) P_(scalar, u, U)
#define SPH_POINT_OUT(P_) P_(scalar, p, P) P_(scalar, cs, CS)
#define SPH_POINT_PARAM(P_) P_(gamma, GAMMA)
#define SPH_POINT_BODY "ideal_gas.body.h"
#define SPH_POINT_DEVICE ideal_gas_device
#include <sph/point-loop.h>

static sph_status inverse(const sph_batch *b)
{
    const double gamma = b->param[GAMMA];
    const double *rho = b->dst[0].data;
    const double *p = b->dst[1].data;
    double *u = b->dst[2].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++)
        u[i] = p[i] / ((gamma - 1) * rho[i]);
    return SPH_OK;
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "ideal-gas",
    .doc = "ideal gas with constant specific heats: p = (gamma - 1) rho u",
    .source = "Landau & Lifshitz, Fluid Mechanics (1987), section 83",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_eos ideal_gas = {
    .size = (uint32_t)sizeof(sph_eos),
    .item = &item,
    .run = run,
    .inverse = inverse,
    .inverse_props = SPH_LIST(inverse_props),
    .device = &ideal_gas_device,
};
