/* tait.c -- p = B ((rho / rho0)^gamma - 1) + p0, B = c0^2 rho0 / gamma; c = c0 (rho / rho0)^((gamma - 1) / 2).
 * R. H. Cole, Underwater Explosions (1948), section 2.3; with an artificial c0 for weakly compressible
 * flow J. J. Monaghan, J. Comput. Phys. 110 (1994), 399, eq. 3.1. */
#include "eos.h"

#include <math.h>

enum { RHO, P, CS };
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

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P_) P_(scalar, rho, RHO)
#define SPH_POINT_OUT(P_) P_(scalar, p, P) P_(scalar, cs, CS)
#define SPH_POINT_PARAM(P_) P_(c0, C0) P_(rho0, RHO0) P_(gamma, GAMMA) P_(p0, P0)
#define SPH_POINT_BODY "tait.body.h"
#define SPH_POINT_DEVICE tait_device
#include <sph/point-loop.h>

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
    .device = &tait_device,
};
