/* xsph_plugin.c -- a pair function of a third plugin, for tests/bench/device.py: the mean velocity of a particle's
 * neighbours beside its own (Monaghan 1989, doi:10.1016/0021-9991(89)90032-6, eq. 2.6), of which nothing is made. */
#include <sph/plugin.h>

enum { M, RHO, V, DRIFT };

static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, 0.0),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_SRC_READ, 0.0),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, 0.0),
    SPH_PROP("drift", "m/s", "mean velocity of the neighbours beside the particle's", SPH_VECTOR,
             SPH_DST_SUM, 0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) V_(v, V)
#define SPH_LOOP_J(S, V_, M_) S(m, M) S(rho, RHO) V_(v, V)
#define SPH_LOOP_SUM(S, V_, M_) V_(drift, DRIFT)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "xsph.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_DEVICE xsph_device
#include <sph/pair-loop.h>

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "xsph",
    .doc = "mean velocity of a particle's neighbours beside its own",
    .source = "Monaghan 1989, doi:10.1016/0021-9991(89)90032-6, eq. 2.6",
    .props = SPH_LIST(props),
};

static const sph_function xsph = {
    .size = (uint32_t)sizeof(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .reach = SPH_GATHER,
    .reach_scale = 1.0,
    .device = &xsph_device,
    .reals = SPH_F64 | SPH_F32,
};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &xsph);
}

SPH_PLUGIN("xsph", "1.0", "BSD-3-Clause", "a sum over neighbours to be measured", init, NULL)
