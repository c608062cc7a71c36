/* momentum.c -- acceleration by pressure, artificial viscosity and gravity, and the time step that they
 * allow. */
#include "wcsph.h"
#include <math.h>

enum { M, V, RHO, P_RHO2, CS, DRHO, A, DT };
enum { ALPHA, BETA, GX, GY, GZ };

static const sph_param params[] = {WCSPH_VISCOSITY, WCSPH_GRAVITY};

static const sph_prop props[] = {
    WCSPH_M,   WCSPH_V,
    WCSPH_RHO, WCSPH_P_RHO2(WCSPH_READ | SPH_DST_SWEEP),
    WCSPH_CS,  SPH_PROP("drho", "kg/m^d/s", "rate of the density", SPH_SCALAR, SPH_DST_READ, 0.0),
    WCSPH_A,   WCSPH_DT,
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) V_(v, V) S(rho, RHO) S(p_rho2, P_RHO2) S(cs, CS)
#define SPH_LOOP_J(S, V_, M_) S(m, M) SPH_LOOP_I(S, V_, M_)
#define SPH_LOOP_SUM(S, V_, M_) V_(a, A)
#define SPH_LOOP_PARAM(P_) P_(alpha, ALPHA) P_(beta, BETA)
#define SPH_LOOP_BODY "momentum.body.h"
#define SPH_LOOP_F32
/* Runs seldom: rates.c stands in for it. */
#define SPH_LOOP_ANY_KERNEL
#define SPH_LOOP_DEVICE wcsph_momentum_device
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P_) WCSPH_FINISH_IN(P_)
#define SPH_POINT_INOUT(P_) P_(vector, a, A)
#define SPH_POINT_OUT(P_) P_(scalar, dt, DT)
#define SPH_POINT_PARAM(P_) WCSPH_FINISH_PARAM(P_)
#define SPH_POINT_H
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE momentum_finish
#include <sph/point-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
};

static const sph_reduction reductions[] = {WCSPH_REDUCTIONS};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "wcsph-momentum",
    .doc = "acceleration by pressure, artificial viscosity and gravity",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551, eq. 3.1, 4.1-4.2",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function wcsph_momentum = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device = &wcsph_momentum_device,
    .reals = SPH_F64 | SPH_F32,
    .device_after = &momentum_finish,
};
