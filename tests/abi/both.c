/* both.c -- a plugin that is C99 and C++11 at once, with a pair loop and one over points: it counts
 * the neighbours within reach and sums a gradient of their kernels, the least distance and the largest
 * step; then it makes tensors of them. */
#include <sph/plugin.h>

enum { M, COUNT, SLOPE, NEAREST, LARGEST, OUTER, PART, CROWD };

static const sph_param params[] = {
    {"share", "", "what a neighbour counts", 1.0, 0.0, 1.0, NULL, SPH_PARAM_NUMBER, 0}};

static const sph_prop props[] = {
    {"m", "kg", "mass", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, 0.0},
    {"count", "", "neighbours", SPH_SCALAR, SPH_DST_SUM, 0.0},
    {"slope", "kg/m^(d+1)", "gradient of the smoothed mass", SPH_VECTOR, SPH_DST_SUM, 0.0},
    {"nearest", "m", "distance of the nearest", SPH_SCALAR, SPH_DST_MIN, 1e300},
    {"largest", "kg", "largest difference of mass", SPH_SCALAR, SPH_DST_MAX, 0.0},
    {"outer", "kg^2/m^(2d+2)", "slope times slope", SPH_MATRIX, SPH_DST_WRITE, 0.0},
    {"part", "kg^2/m^(2d+2)", "its upper half", SPH_SYM, SPH_DST_WRITE, 0.0},
    {"crowd", "", "the number of neighbours so far", SPH_INT32, SPH_DST_UPDATE, 0.0},
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V, M_) S(m, M)
#define SPH_LOOP_J(S, V, M_) S(m, M)
#define SPH_LOOP_SUM(S, V, M_) S(count, COUNT) V(slope, SLOPE)
#define SPH_LOOP_MIN(S) S(nearest, NEAREST)
#define SPH_LOOP_MAX(S) S(largest, LARGEST)
#define SPH_LOOP_PARAM(P) P(share, 0)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_F32
#define SPH_LOOP_UNIFORM_H
#define SPH_LOOP_DEVICE sweep_device
#define SPH_LOOP_BODY "both.body.h"
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P) P(scalar, count, COUNT) P(vector, slope, SLOPE) P(scalar, nearest, NEAREST)
#define SPH_POINT_INOUT(P) P(int32, crowd, CROWD) P(scalar, largest, LARGEST)
#define SPH_POINT_OUT(P) P(matrix, outer, OUTER) P(sym, part, PART)
#define SPH_POINT_PARAM(P) P(share, 0)
#define SPH_POINT_H
#define SPH_POINT_FAIL "both: nobody is so near", "both: nobody is so heavy"
#define SPH_POINT_DEVICE finish_device
#define SPH_POINT_BODY "both_finish.body.h"
#include <sph/point-loop.h>

static const sph_item item = {
    (uint32_t)sizeof(sph_item), SPH_ALL_DIMS,   "neighbours", "counts neighbours", "",
    SPH_LIST(params),           SPH_LIST(props)};

/* In C++ designators are C++20's; what is not static is set by hand. */
static sph_function function;

static sph_status init(const sph_host *host)
{
    function.size = (uint32_t)sizeof(function);
    function.shape = SPH_PAIR;
    function.reals = SPH_F64 | SPH_F32;
    function.item = &item;
    function.run = sweep;
    function.reach = SPH_GATHER;
    function.reach_scale = 1.0;
    function.device = &sweep_device;
    function.after = finish;
    function.device_after = &finish_device;
    return host->register_item(host, SPH_KIND_FUNCTION, &function);
}

SPH_PLUGIN("both", "1.0", "BSD-3-Clause", "C and C++ at once", init, NULL)
