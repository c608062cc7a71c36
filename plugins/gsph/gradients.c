/* gradients.c -- gradients of density, pressure and velocity, exact for linear fields: differences weighted
 * with the kernel's slope, times the inverse of their moment matrix. */
#include "gsph.h"
#include <math.h>

enum { M, RHO, P, V, GRHO, GP, GV, MOMENT, SPREAD };
enum { SHARE };

static const sph_param params[] = {
    SPH_PARAM("volume_share", "",
              "how much of the gradients' volume correction the forces take: 0 none, 1 all", 0.4,
              0.0, 1.0),
};

static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ | SPH_DST_SWEEP,
             NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ | SPH_DST_SWEEP, 0.0),
    SPH_PROP("grad_rho", "kg/m^(d+1)", "gradient of the density", SPH_VECTOR,
             SPH_DST_SUM | SPH_WORK, 0.0),
    SPH_PROP("grad_p", "J/m^(d+1)", "gradient of the pressure", SPH_VECTOR, SPH_DST_SUM | SPH_WORK,
             0.0),
    SPH_PROP("grad_v", "1/s", "velocity gradient, a row a component", SPH_MATRIX,
             SPH_DST_SUM | SPH_WORK, 0.0),
    SPH_PROP("moment", "", "moment matrix of the gradients", SPH_MATRIX, SPH_DST_SUM | SPH_WORK,
             0.0),
    SPH_PROP("volume", "", "volume correction of the forces", SPH_SCALAR, SPH_DST_SUM | SPH_WORK,
             0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) S(rho, RHO) S(p, P) V_(v, V)
#define SPH_LOOP_J(S, V_, M_) S(m, M) S(rho, RHO) S(p, P) V_(v, V)
#define SPH_LOOP_SUM(S, V_, M_)                                                                    \
    V_(grho, GRHO) V_(gp, GP) M_(gv, GV) M_(moment, MOMENT) S(spread, SPREAD)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "gradients.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_DEVICE gradients_device
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP correct
#define SPH_POINT_IN(P_) P_(scalar, rho, RHO) P_(matrix, moment, MOMENT)
#define SPH_POINT_INOUT(P_)                                                                        \
    P_(vector, grho, GRHO) P_(vector, gp, GP) P_(matrix, gv, GV) P_(scalar, volume, SPREAD)
#define SPH_POINT_PARAM(P_) P_(share, SHARE)
#define SPH_POINT_BODY "correct.body.h"
#define SPH_POINT_DEVICE gradients_correct
#include <sph/point-loop.h>

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "gsph-gradients",
    .doc = "gradients of density, pressure and velocity for the reconstruction",
    .source = "exact for linear fields by matrix inversion, as Garcia-Senz et al. 2012, "
              "doi:10.1051/0004-6361/201117939, eq. 5-7",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function gsph_gradients = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = correct,
    .reach = SPH_GATHER,
    .reach_scale = 1.0,
    .device = &gradients_device,
    .reals = SPH_F64 | SPH_F32,
    .device_after = &gradients_correct,
};
