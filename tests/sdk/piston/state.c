/* state.c -- the state of the piston's particles, from the gas before it: means weighted with the
 * kernel, as in Adami, Hu & Adams 2012, doi:10.1016/j.jcp.2012.05.005, eqs. 22, 27. */
#include <math.h>

#include "piston.h"

static const sph_param params[] = {PISTON_PARAMS};

enum { RHO, P, CS, V, M, VOLUME, WEIGHT, SUM_RHO, SUM_P, SUM_CS, SUM_LEVER, H_NEAR };
static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_UPDATE | SPH_SRC_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_UPDATE | SPH_SRC_READ, 0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_UPDATE | SPH_SRC_READ, 0),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ, 0),
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_UPDATE, NAN),
    SPH_PROP("wall_volume", "m^d", "volume, for ever", SPH_SCALAR, SPH_DST_READ, 0),
    SPH_PROP("wall_weight", "1/m^d", "sum of the kernel over the gas", SPH_SCALAR,
             SPH_DST_SUM | SPH_WORK, 0),
    SPH_PROP("wall_rho", "", "sum of W rho", SPH_SCALAR, SPH_DST_SUM | SPH_WORK, 0),
    SPH_PROP("wall_p", "", "sum of W p", SPH_SCALAR, SPH_DST_SUM | SPH_WORK, 0),
    SPH_PROP("wall_cs", "", "sum of W cs", SPH_SCALAR, SPH_DST_SUM | SPH_WORK, 0),
    SPH_PROP("wall_lever", "", "sum of W rho (x_wall - x_gas)", SPH_VECTOR, SPH_DST_SUM | SPH_WORK,
             0),
    SPH_PROP("h_near", "m", "smallest smoothing length of the gas within reach", SPH_SCALAR,
             SPH_DST_MIN | SPH_WORK, INFINITY),
};

#define SPH_LOOP sweep
#define SPH_LOOP_J(S, V_, M_) S(rho, RHO) S(p, P) S(cs, CS)
#define SPH_LOOP_SUM(S, V_, M_)                                                                    \
    S(weight, WEIGHT) S(sum_rho, SUM_RHO) S(sum_p, SUM_P) S(sum_cs, SUM_CS) V_(lever, SUM_LEVER)
#define SPH_LOOP_MIN(S) S(h_near, H_NEAR)
#define SPH_LOOP_REACH SPH_SYMMETRIC
#define SPH_LOOP_BODY "state.body.h"
#define SPH_LOOP_DEVICE state_sweep
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P_)                                                                           \
    P_(scalar, weight, WEIGHT)                                                                     \
    P_(scalar, sum_rho, SUM_RHO)                                                                   \
    P_(scalar, sum_p, SUM_P)                                                                       \
    P_(scalar, sum_cs, SUM_CS) P_(vector, lever, SUM_LEVER) P_(scalar, volume, VOLUME)
#define SPH_POINT_INOUT(P_)                                                                        \
    P_(scalar, rho, RHO) P_(scalar, p, P) P_(scalar, cs, CS) P_(scalar, m, M)
#define SPH_POINT_STATE(P_) P_(acceleration, NOW_ACCELERATION)
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE state_finish
#include <sph/point-loop.h>

static const sph_reduction reductions[] = {
    SPH_REDUCTION("h_near", "h_near", SPH_REDUCE_MIN, SPH_USE_NONE),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "piston-state",
    .doc = "density, pressure and speed of sound of the piston, from the gas before it",
    .source = "Adami, Hu & Adams 2012, doi:10.1016/j.jcp.2012.05.005, eqs. 22, 27",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};
const sph_function piston_state = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .life = &piston_life,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1,
    .reductions = SPH_LIST(reductions),
    .device = &state_sweep,
    .prepare = piston_prepare,
    .device_after = &state_finish,
};
