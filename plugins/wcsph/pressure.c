/* pressure.c -- p / rho^2, which every pair of the momentum equation needs of both its particles: once for
 * each of these. */
#include "wcsph.h"
#include <math.h>

enum { RHO, P, P_RHO2 };

static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    WCSPH_P_RHO2(SPH_DST_WRITE),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P_) P_(scalar, rho, RHO) P_(scalar, p, P)
#define SPH_POINT_OUT(P_) P_(scalar, p_rho2, P_RHO2)
#define SPH_POINT_BODY "pressure.body.h"
#define SPH_POINT_DEVICE pressure_device
#include <sph/point-loop.h>

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "wcsph-pressure",
    .doc = "pressure over the square of the density, for wcsph-momentum",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551, eq. 3.1",
    .props = SPH_LIST(props),
};

const sph_function wcsph_pressure = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .device_run = &pressure_device,
};
