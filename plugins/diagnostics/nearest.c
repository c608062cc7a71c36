/* nearest.c -- the distance to the nearest other particle within the support. */
#include "diagnostics.h"
#include <math.h>

enum { NEAREST };

static const sph_prop props[] = {
    SPH_PROP("nearest", "m", "distance to the nearest other particle, at most the support",
             SPH_SCALAR, SPH_DST_MIN, INFINITY),
};

#define SPH_LOOP sweep
#define SPH_LOOP_MIN(S) S(nearest, NEAREST)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "nearest.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_ANY_KERNEL
#define SPH_LOOP_DEVICE nearest_device
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_INOUT(P) P(scalar, nearest, NEAREST)
#define SPH_POINT_H
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE nearest_finish
#include <sph/point-loop.h>

static const sph_reduction reductions[] = {
    SPH_REDUCTION("nearest", "nearest", SPH_REDUCE_MIN, SPH_USE_NONE),
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "nearest",
    .doc = "distance to the nearest other particle: shows whether particles pair",
    .source = "Dehnen & Aly 2012, doi:10.1111/j.1365-2966.2012.21439.x, section 3",
    .props = SPH_LIST(props),
};

const sph_function nearest_function = {
    .size = (uint32_t)sizeof(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = finish,
    .reach = SPH_GATHER,
    .reach_scale = 1.0,
    .reductions = SPH_LIST(reductions),
    .device = &nearest_device,
    .reals = SPH_F64 | SPH_F32,
    .device_after = &nearest_finish,
};
