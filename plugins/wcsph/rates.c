/* rates.c -- continuity and momentum in one sweep: what the host runs where the two follow each other on
 * the same arrays (fusion.h). */
#include "wcsph.h"
#include <math.h>

enum { M, V, RHO, P_RHO2, CS, DRHO, A, DT };
enum { ALPHA, BETA, GX, GY, GZ };

static const sph_param params[] = {WCSPH_VISCOSITY, WCSPH_GRAVITY};

static const sph_prop props[] = {
    WCSPH_M,
    WCSPH_V,
    WCSPH_RHO,
    WCSPH_P_RHO2(WCSPH_READ | SPH_DST_SWEEP),
    WCSPH_CS,
    SPH_PROP("drho", "kg/m^d/s", "rate of the density", SPH_SCALAR, SPH_DST_SUM | SPH_DST_READ,
             0.0),
    WCSPH_A,
    WCSPH_DT,
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) V_(v, V) S(rho, RHO) S(p_rho2, P_RHO2) S(cs, CS)
#define SPH_LOOP_J(S, V_, M_) S(m, M) SPH_LOOP_I(S, V_, M_)
#define SPH_LOOP_SUM(S, V_, M_) S(drho, DRHO) V_(a, A)
#define SPH_LOOP_PARAM(P_) P_(alpha, ALPHA) P_(beta, BETA)
#define SPH_LOOP_BODY "continuity.body.h"
#define SPH_LOOP_BODY_2 "momentum.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_UNIFORM_H
#define SPH_LOOP_DEVICE wcsph_rates_device
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P_) WCSPH_FINISH_IN(P_)
#define SPH_POINT_INOUT(P_) P_(vector, a, A)
#define SPH_POINT_OUT(P_) P_(scalar, dt, DT)
#define SPH_POINT_PARAM(P_) WCSPH_FINISH_PARAM(P_)
#define SPH_POINT_H
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE rates_finish
#include <sph/point-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("rho", "drho", SPH_KICK),
    SPH_RATE("v", "a", SPH_KICK),
};

static const sph_reduction reductions[] = {WCSPH_REDUCTIONS};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "wcsph-rates",
    .doc = "wcsph-continuity and wcsph-momentum in one sweep",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551; Monaghan 1994, "
              "doi:10.1006/jcph.1994.1034",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function wcsph_rates = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device = &wcsph_rates_device,
    .reals = SPH_F64 | SPH_F32,
    .device_after = &rates_finish,
};
