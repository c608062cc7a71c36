/* momentum.c -- acceleration by pressure, and the time step h / c. */
#include "barotropic.h"
#include <math.h>

enum { M, P_RHO2, V, CS, A, DT };

static const sph_prop props[] = {
    BAROTROPIC_M,
    BAROTROPIC_P_RHO2(BAROTROPIC_OF_PAIRS),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_DST_SWEEP, 0.0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("a", "m/s^2", "acceleration", SPH_VECTOR, SPH_DST_SUM, 0.0),
    SPH_PROP("dt", "s", "time step that the particle allows, before cfl", SPH_SCALAR, SPH_DST_WRITE,
             0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) S(p_rho2, P_RHO2)
#define SPH_LOOP_J(S, V_, M_) S(m, M) S(p_rho2, P_RHO2)
#define SPH_LOOP_SUM(S, V_, M_) V_(a, A)
#define SPH_LOOP_BODY "momentum.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_UNIFORM_H
#define SPH_LOOP_DEVICE momentum_device
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P_) P_(scalar, cs, CS)
#define SPH_POINT_OUT(P_) P_(scalar, dt, DT)
#define SPH_POINT_H
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE momentum_finish
#include <sph/point-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
};

static const sph_reduction reductions[] = {
    SPH_REDUCTION("dt", "dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic-momentum",
    .doc = "acceleration by pressure alone",
    .source = "Price 2012, doi:10.1016/j.jcp.2010.12.011, section 3, at fixed h",
    .props = SPH_LIST(props),
};

const sph_function barotropic_momentum = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device = &momentum_device,
    .reals = SPH_F64 | SPH_F32,
    .device_after = &momentum_finish,
};
