/* density.c -- the density as a sum over neighbours, the particle itself among them. */
#include "barotropic.h"
#include <math.h>

enum { M, RHO };

static const sph_prop props[] = {
    BAROTROPIC_M,
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_SUM, 0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_J(S, V_, M_) S(m, M)
#define SPH_LOOP_SUM(S, V_, M_) S(rho, RHO)
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "density.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_UNIFORM_H
#define SPH_LOOP_DEVICE density_device
#include <sph/pair-loop.h>

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic-density",
    .doc = "density by summation at fixed h",
    .source = "Price 2012, doi:10.1016/j.jcp.2010.12.011, section 2",
    .props = SPH_LIST(props),
};

const sph_function barotropic_density = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .device = &density_device,
    .reals = SPH_F64 | SPH_F32,
};
