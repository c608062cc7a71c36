/* rates.c -- accelerations and heating from Riemann problems between neighbours, and the time step that they
 * allow. Energy: the sweep sums each pair's flux of total energy; what is left after the work on the
 * particle's own motion heats it. */
#include "gsph.h"
#include <math.h>

enum { M, RHO, P, CS, V, VOLUME, GRHO, GP, GV, FORCE, POWER, FASTEST, A, DU, U, DT };
enum { RIEMANN, LIMITER, BETA };

static const sph_param params[] = {
    SPH_PARAM_CHOICE("riemann", "Riemann solver", 1.0, "exact|hllc"),
    SPH_PARAM_CHOICE("limiter", "slope limiter; none: first order", 1.0, "none|minmod|van-leer"),
    SPH_PARAM("beta", "",
              "weight of the closing speed in the signal speed that bounds the time step", 1.0, 0.0,
              10.0),
};

#define OF_PAIRS (SPH_DST_READ | SPH_SRC_READ | SPH_DST_SWEEP)
static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, OF_PAIRS, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, OF_PAIRS, NAN),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, 0.0),
    SPH_PROP("volume", "", "volume correction of the forces", SPH_SCALAR, OF_PAIRS, NAN),
    SPH_PROP("grad_rho", "kg/m^(d+1)", "gradient of the density", SPH_VECTOR, OF_PAIRS, NAN),
    SPH_PROP("grad_p", "J/m^(d+1)", "gradient of the pressure", SPH_VECTOR, OF_PAIRS, NAN),
    SPH_PROP("grad_v", "1/s", "velocity gradient, a row a component", SPH_MATRIX, OF_PAIRS, NAN),
    SPH_PROP("force", "m/s^2", "sum of the pairs' momentum fluxes", SPH_VECTOR,
             SPH_DST_SUM | SPH_WORK, 0.0),
    SPH_PROP("power", "W/kg", "sum of the pairs' energy fluxes", SPH_SCALAR, SPH_DST_SUM | SPH_WORK,
             0.0),
    SPH_PROP("signal", "m/s", "largest signal speed", SPH_SCALAR, SPH_DST_MAX | SPH_WORK, 0.0),
    SPH_PROP("a", "m/s^2", "acceleration", SPH_VECTOR, SPH_DST_UPDATE, 0.0),
    SPH_PROP("du", "W/kg", "rate of the specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0.0),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("dt", "s", "time step that the particle allows, before cfl", SPH_SCALAR, SPH_DST_WRITE,
             0.0),
};

#include "rates.macros.h"

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_)                                                                      \
    S(rho, RHO) S(p, P) S(cs, CS) V_(v, V) S(volume, VOLUME) V_(grho, GRHO) V_(gp, GP) M_(gv, GV)
#define SPH_LOOP_J(S, V_, M_) S(m, M) SPH_LOOP_I(S, V_, M_)
#define SPH_LOOP_SUM(S, V_, M_) V_(force, FORCE) S(power, POWER)
#define SPH_LOOP_MAX(S) S(fastest, FASTEST)
#define SPH_LOOP_PARAM(P_) P_(riemann, RIEMANN) P_(limiter, LIMITER) P_(beta, BETA)
#define SPH_LOOP_REACH SPH_SYMMETRIC
#define SPH_LOOP_BODY "rates.body.h"
#define SPH_LOOP_F32
/* The kernel is a small part of this body. */
#define SPH_LOOP_ANY_KERNEL
#define SPH_LOOP_DEVICE rates_device
#define SPH_LOOP_PRELUDE "rates.macros.h"
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P_)                                                                           \
    P_(scalar, cs, CS)                                                                             \
    P_(vector, v, V) P_(vector, force, FORCE) P_(scalar, power, POWER) P_(scalar, fastest, FASTEST)
#define SPH_POINT_INOUT(P_) P_(vector, a, A)
#define SPH_POINT_OUT(P_) P_(scalar, du, DU) P_(scalar, dt, DT)
#define SPH_POINT_H
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE rates_finish
#include <sph/point-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
    SPH_RATE("u", "du", SPH_KICK),
};

static const sph_reduction reductions[] = {
    SPH_REDUCTION("dt", "dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),
    SPH_REDUCTION("internal", "u", SPH_REDUCE_SUM, SPH_USE_INTERNAL),
    SPH_REDUCTION("rho_max", "rho", SPH_REDUCE_MAX, SPH_USE_NONE),
    SPH_REDUCTION("u_min", "u", SPH_REDUCE_MIN, SPH_USE_NONE),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "gsph-rates",
    .doc = "acceleration and heating from Riemann problems between neighbours",
    .source = "Inutsuka 2002, doi:10.1006/jcph.2002.7053; README",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function gsph_rates = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .device = &rates_device,
    .reals = SPH_F64 | SPH_F32,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device_after = &rates_finish,
};
