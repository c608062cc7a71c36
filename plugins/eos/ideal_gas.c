/* ideal_gas.c -- p = (gamma - 1) rho u, c^2 = gamma p / rho; any textbook, as L. D. Landau &
 * E. M. Lifshitz, Fluid Mechanics (1987), paragraph 83. */
#include "eos.h"

#include <math.h>

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

static sph_status only_double(const sph_batch *b)
{
    return b->host->fail(b->host, SPH_E_UNKNOWN,
                         "ideal-gas: single precision is not implemented yet");
}

static sph_status run(const sph_batch *b)
{
    const double gamma = b->param[0];

    if (b->real != SPH_F64)
        return only_double(b);

    const double *rho = b->dst[0].data;
    const double *u = b->dst[1].data;
    double *p = b->dst[2].data;
    double *cs = b->dst[3].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        p[i] = (gamma - 1) * rho[i] * u[i];
        cs[i] = sqrt(gamma * (gamma - 1) * (u[i] > 0 ? u[i] : 0));
    }
    return SPH_OK;
}

static sph_status inverse(const sph_batch *b)
{
    const double gamma = b->param[0];

    if (b->real != SPH_F64)
        return only_double(b);

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
};
