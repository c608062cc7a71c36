/* continuity.c -- the rate of the density from the divergence of the velocity. */
#include "wcsph.h"
#include <math.h>

enum { M, V, DRHO, RHO };

static const sph_prop props[] = {
    WCSPH_M,
    WCSPH_V,
    WCSPH_DRHO,
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) V_(v, V)
#define SPH_LOOP_J(S, V_, M_) S(m, M) V_(v, V)
#define SPH_LOOP_SUM(S, V_, M_) S(drho, DRHO)
#define SPH_LOOP_BODY "continuity.body.h"
#define SPH_LOOP_F32
/* Runs seldom: rates.c stands in for it. */
#define SPH_LOOP_ANY_KERNEL
#define SPH_LOOP_DEVICE wcsph_continuity_device
#include <sph/pair-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("rho", "drho", SPH_KICK),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "wcsph-continuity",
    .doc = "rate of the density from the divergence of the velocity",
    .source = "Monaghan 1994, doi:10.1006/jcph.1994.1034, eq. 2.6",
    .props = SPH_LIST(props),
};

const sph_function wcsph_continuity = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .device = &wcsph_continuity_device,
    .reals = SPH_F64 | SPH_F32,
};
