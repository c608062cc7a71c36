/* pressure.c -- p / rho^2, which every pair of the momentum equation needs of both its particles: once for
 * each of these. */
#include "barotropic.h"
#include <math.h>

enum { RHO, P, P_RHO2 };

static const sph_prop props[] = {
    BAROTROPIC_RHO(SPH_DST_READ),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    BAROTROPIC_P_RHO2(SPH_DST_WRITE),
};

static sph_status run(const sph_batch *b)
{
    const double *rho = b->dst[RHO].data, *p = b->dst[P].data;
    double *p_rho2 = b->dst[P_RHO2].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        p_rho2[i] = p[i] / (rho[i] * rho[i]);
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic-pressure",
    .doc = "pressure over the square of the density, for barotropic-momentum",
    .source = "Price 2012, doi:10.1016/j.jcp.2010.12.011, section 3",
    .props = SPH_LIST(props),
};

const sph_function barotropic_pressure = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
};
