/* energy.c -- the energy of compression, for the log: what the equation of state says it is. Nothing else
 * reads it. */
#include "barotropic.h"
#include <math.h>

static const sph_prop props[] = {
    SPH_PROP("u", "J/kg", "specific energy of compression", SPH_SCALAR, SPH_DST_READ, NAN),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_BODY "energy.body.h"
#define SPH_POINT_DEVICE energy_device
#include <sph/point-loop.h>

static const sph_reduction reductions[] = {
    SPH_REDUCTION("internal", "u", SPH_REDUCE_SUM, SPH_USE_INTERNAL),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic-energy",
    .doc = "the energy of compression, of an equation of state that gives u: in the log",
    .source = "Price 2012, doi:10.1016/j.jcp.2010.12.011, section 3",
    .props = SPH_LIST(props),
};

const sph_function barotropic_energy = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .device_run = &energy_device,
    .reductions = SPH_LIST(reductions),
};
