/* continuity.c -- the rate of the density from the divergence of the velocity. */
#include "barotropic.h"
#include <math.h>

enum { M, V, DRHO, RHO };

static const sph_prop props[] = {
    BAROTROPIC_M,
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, BAROTROPIC_OF_PAIRS, 0.0),
    SPH_PROP("drho", "kg/m^d/s", "rate of the density", SPH_SCALAR, SPH_DST_SUM, 0.0),
    BAROTROPIC_RHO(SPH_DST_READ),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) V_(v, V)
#define SPH_LOOP_J(S, V_, M_) S(m, M) V_(v, V)
#define SPH_LOOP_SUM(S, V_, M_) S(drho, DRHO)
#define SPH_LOOP_BODY "continuity.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_UNIFORM_H
#define SPH_LOOP_DEVICE continuity_device
#include <sph/pair-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("rho", "drho", SPH_KICK),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic-continuity",
    .doc = "rate of the density from the divergence of the velocity",
    .source = "Monaghan 1994, doi:10.1006/jcph.1994.1034, eq. 2.6",
    .props = SPH_LIST(props),
};

const sph_function barotropic_continuity = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .device = &continuity_device,
    .reals = SPH_F64 | SPH_F32,
};
