/* stiffened-gas.c -- a liquid or solid under strong shocks, as a gas that is stiff already without
 * pressure. README has the equations. */
#include <math.h>
#include <sph/plugin.h>

enum { GAMMA, P_INF };
static const sph_param params[] = {
    SPH_PARAM("gamma", "", "exponent; 4.4 for water", 4.4, 1.000001, 100),
    SPH_PARAM("p_inf", "J/m^d", "the pressure that the stiffness stands for; 6e8 Pa for water", 0,
              0, 1e300),
};

enum { RHO, U, P, CS };
static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0),
};

enum { INVERSE_RHO, INVERSE_P, INVERSE_U };
static const sph_prop inverse_props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(X) X(scalar, rho, RHO) X(scalar, u, U)
#define SPH_POINT_OUT(X) X(scalar, p, P) X(scalar, cs, CS)
#define SPH_POINT_PARAM(X) X(gamma, GAMMA) X(p_inf, P_INF)
#define SPH_POINT_BODY "stiffened-gas.body.h"
#define SPH_POINT_DEVICE stiffened_gas_device
#include <sph/point-loop.h>

static sph_status inverse(const sph_batch *b)
{
    const double gamma = b->param[GAMMA], p_inf = b->param[P_INF];
    const double *rho = b->dst[INVERSE_RHO].data, *p = b->dst[INVERSE_P].data;
    double *u = b->dst[INVERSE_U].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++)
        u[i] = (p[i] + gamma * p_inf) / ((gamma - 1) * rho[i]);
    return SPH_OK;
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "stiffened-gas",
    .doc = "stiffened gas: p = (gamma - 1) rho u - gamma p_inf",
    .source = "Harlow & Amsden 1971, LA-4700; Menikoff & Plohr 1989, "
              "doi:10.1103/RevModPhys.61.75",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

static const sph_eos eos = {
    .size = (uint32_t)sizeof(sph_eos),
    .item = &item,
    .run = run,
    .inverse = inverse,
    .inverse_props = SPH_LIST(inverse_props),
    .device = &stiffened_gas_device,
};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_EOS, &eos);
}

SPH_PLUGIN("stiffened-gas", "0.1", "BSD-3-Clause", "equation of state of a stiffened gas", init,
           NULL)
