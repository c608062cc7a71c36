/* tait.c -- p = B ((rho / rho0)^gamma - 1) + p0, B = c0^2 rho0 / gamma; c = c0 (rho / rho0)^((gamma - 1) / 2).
 * R. H. Cole, Underwater Explosions (1948), section 2.3; with an artificial c0 for weakly compressible
 * flow J. J. Monaghan, J. Comput. Phys. 110 (1994), 399, eq. 3.1. */
#include "eos.h"

#include <math.h>

enum { C0, RHO0, GAMMA, P0 };

static const sph_param params[] = {
    SPH_PARAM("c0", "m/s", "speed of sound at rho0", NAN, 1e-300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density at which the pressure is p0", NAN, 1e-300, 1e300),
    SPH_PARAM("gamma", "", "stiffness", 7, 1, 100),
    SPH_PARAM("p0", "J/m^d", "background pressure", 0, -1e300, 1e300),
};
static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0),
};
static const sph_prop inverse_props[] = {
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_WRITE, 0),
};

/* a^7 and a^3, in this order of products. */
static inline double seventh(double a)
{
    const double a2 = a * a;
    return a2 * a2 * a2 * a;
}

static inline double cube(double a)
{
    return a * a * a;
}

/* Of one particle, by ratio^gamma and ratio^((gamma - 1) / 2). */
#define TAIT(whole, half)                                                                          \
    for (uint64_t i = b->first; i < b->first + b->count; i++) {                                    \
        const double ratio = rho[i] * per_rho0;                                                    \
        p[i] = modulus * ((whole)-1.0) + p0;                                                       \
        cs[i] = c0 * (half);                                                                       \
    }

static sph_status run(const sph_batch *b)
{
    const double c0 = b->param[C0], rho0 = b->param[RHO0], gamma = b->param[GAMMA];
    const double modulus = c0 * c0 * rho0 / gamma, per_rho0 = 1.0 / rho0, p0 = b->param[P0];
    const double *restrict rho = b->dst[0].data;
    double *restrict p = b->dst[1].data, *restrict cs = b->dst[2].data;

    /* Water's exponent without a call, and several particles at a time. */
    if (gamma == 7.0)
        TAIT(seventh(ratio), cube(ratio))
    else if (gamma == 3.0)
        TAIT(cube(ratio), ratio)
    else if (gamma == 1.0)
        TAIT(ratio, 1.0)
    else
        TAIT(pow(ratio, gamma), pow(ratio, 0.5 * (gamma - 1.0)))
    return SPH_OK;
}

static sph_status inverse(const sph_batch *b)
{
    const double c0 = b->param[C0], rho0 = b->param[RHO0], gamma = b->param[GAMMA];
    const double modulus = c0 * c0 * rho0 / gamma;
    const double *p = b->dst[0].data;
    double *rho = b->dst[1].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        const double base = 1.0 + (p[i] - b->param[P0]) / modulus;
        if (!(base > 0.0))
            return b->host->fail(b->host, SPH_E_NUMERIC,
                                 "tait: no density has so low a pressure: p - p0 must be above "
                                 "-c0^2 rho0 / gamma");
        rho[i] = rho0 * pow(base, 1.0 / gamma);
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "tait",
    .doc = "Tait's equation for weakly compressible liquids: p = c0^2 rho0 / gamma ((rho / "
           "rho0)^gamma - 1) + p0",
    .source = "Monaghan 1994, doi:10.1006/jcph.1994.1034, eq. 3.1",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_eos tait = {
    .size = (uint32_t)sizeof(sph_eos),
    .item = &item,
    .run = run,
    .inverse = inverse,
    .inverse_props = SPH_LIST(inverse_props),
};
