/* frames.c -- a plugin for tests of devices: neighbours in other places than the position, found once ("frozen")
 * or followed, and a function that writes what its own sweeps read of others. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)
#define PROP_M SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN)
#define PROP_X(access) SPH_PROP("X", "m", "another place", SPH_VECTOR, access, NAN)

/* -- Sums over X -------- */

enum { M, AT, SUM };
static const sph_prop followed_props[] = {
    PROP_M,
    PROP_X(SPH_DST_READ | SPH_SRC_READ),
    SPH_PROP("followed", "kg/m^d", "sum over those that are near in X", SPH_SCALAR, SPH_DST_SUM,
             0.0),
};
static const sph_prop frozen_props[] = {
    PROP_M,
    PROP_X(SPH_DST_READ | SPH_SRC_READ),
    SPH_PROP("frozen", "kg/m^d", "sum over those that were near in X", SPH_SCALAR, SPH_DST_SUM,
             0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_J(S, V, M_) S(m, M)
#define SPH_LOOP_SUM(S, V, M_) S(sum, SUM)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "frames.body.h"
#define SPH_LOOP_DEVICE sweep_device
#include <sph/pair-loop.h>

static const sph_item followed_item = {.size = SIZE(sph_item),
                                       .dims = SPH_ALL_DIMS,
                                       .name = "followed",
                                       .doc = "sum of m W over neighbours in X",
                                       .source = "",
                                       .props = SPH_LIST(followed_props)};
static const sph_item frozen_item = {.size = SIZE(sph_item),
                                     .dims = SPH_ALL_DIMS,
                                     .name = "frozen",
                                     .doc = "sum of m W over the first neighbours in X",
                                     .source = "",
                                     .props = SPH_LIST(frozen_props)};
static const sph_function followed = {.size = SIZE(sph_function),
                                      .shape = SPH_PAIR,
                                      .item = &followed_item,
                                      .run = sweep,
                                      .reach = SPH_GATHER,
                                      .reach_scale = 1.0,
                                      .device = &sweep_device,
                                      .over = "X"};
static const sph_function frozen = {.size = SIZE(sph_function),
                                    .shape = SPH_PAIR,
                                    .item = &frozen_item,
                                    .run = sweep,
                                    .reach = SPH_GATHER,
                                    .reach_scale = 1.0,
                                    .device = &sweep_device,
                                    .frozen = 1,
                                    .over = "X"};

/* -- X moves -------- */

static const sph_prop turn_props[] = {PROP_X(SPH_DST_UPDATE)};

#define SPH_POINT_LOOP turn_run
#define SPH_POINT_INOUT(P) P(vector, X, 0)
#define SPH_POINT_BODY "turn.body.h"
#define SPH_POINT_DEVICE turn_device
#include <sph/point-loop.h>

static const sph_item turn_item = {.size = SIZE(sph_item),
                                   .dims = SPH_DIM2 | SPH_DIM3,
                                   .name = "turn",
                                   .doc = "moves X",
                                   .source = "",
                                   .props = SPH_LIST(turn_props)};
static const sph_function turn = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &turn_item,
                                  .run = turn_run,
                                  .device_run = &turn_device};

/* -- What is written is read of others -------- */

enum { MIX_M, MIX_Q, MIX_DQ };
static const sph_prop mix_props[] = {
    PROP_M,
    SPH_PROP("q", "", "what is mixed", SPH_SCALAR, SPH_DST_UPDATE | SPH_SRC_READ, NAN),
    SPH_PROP("dq", "", "what neighbours give", SPH_SCALAR, SPH_DST_SUM, 0.0),
};

#define SPH_LOOP mix_sweep
#define SPH_LOOP_I(S, V, M_) S(q, MIX_Q)
#define SPH_LOOP_J(S, V, M_) S(m, MIX_M) S(q, MIX_Q)
#define SPH_LOOP_SUM(S, V, M_) S(dq, MIX_DQ)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "mix.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_DEVICE mix_device
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP mix_after
#define SPH_POINT_IN(P) P(scalar, dq, MIX_DQ)
#define SPH_POINT_INOUT(P) P(scalar, q, MIX_Q)
#define SPH_POINT_BODY "mixed.body.h"
#define SPH_POINT_DEVICE mix_after_device
#include <sph/point-loop.h>

static const sph_item mix_item = {.size = SIZE(sph_item),
                                  .dims = SPH_ALL_DIMS,
                                  .name = "mix",
                                  .doc = "q comes nearer to its neighbours' q",
                                  .source = "",
                                  .props = SPH_LIST(mix_props)};
static const sph_function mix = {.size = SIZE(sph_function),
                                 .shape = SPH_PAIR,
                                 .item = &mix_item,
                                 .run = mix_sweep,
                                 .after = mix_after,
                                 .reach = SPH_GATHER,
                                 .reach_scale = 1.0,
                                 .device = &mix_device,
                                 .device_after = &mix_after_device,
                                 .reals = SPH_F64 | SPH_F32};

static sph_status init(const sph_host *host)
{
    static const sph_function *const all[] = {&followed, &frozen, &turn, &mix};
    sph_status status = SPH_OK;

    for (size_t k = 0; k < sizeof(all) / sizeof(all[0]) && status == SPH_OK; k++)
        status = host->register_item(host, SPH_KIND_FUNCTION, all[k]);
    return status;
}

SPH_PLUGIN("frames", "1", "BSD-3-Clause", "for tests of devices", init, NULL)
