/* move.c -- moves the piston: what it remembers of its start; its rates, in the place of those that the
 * scheme has found for it; its exact place after each step. */
#include <math.h>

#include "piston.h"

static const sph_param params[] = {PISTON_PARAMS};

/* -- At the start: the volume that each particle stands for, where it was, its first speed. */

enum { START_X, START_M, START_RHO, START_HOME, START_VOLUME, START_V };
static const sph_prop start_props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("home", "m", "position at time 0", SPH_VECTOR, SPH_DST_WRITE, 0),
    SPH_PROP("wall_volume", "m^d", "volume, for ever", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_WRITE, 0),
};

#define SPH_POINT_LOOP start
#define SPH_POINT_IN(P) P(vector, x, START_X) P(scalar, m, START_M) P(scalar, rho, START_RHO)
#define SPH_POINT_OUT(P)                                                                           \
    P(vector, home, START_HOME) P(scalar, volume, START_VOLUME) P(vector, v, START_V)
#define SPH_POINT_STATE(P) P(way, NOW_WAY) P(speed, NOW_SPEED)
#define SPH_POINT_BODY "start.body.h"
#define SPH_POINT_DEVICE start_device
#include <sph/point-loop.h>

static const sph_item start_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "piston-start",
    .doc = "volume, place and speed of the piston's particles at the start",
    .source = "README",
    .params = SPH_LIST(params),
    .props = SPH_LIST(start_props),
};
const sph_function piston_start = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &start_item,
    .life = &piston_life,
    .run = start,
    .reach_scale = 1,
    .prepare = piston_prepare,
    .device_run = &start_device,
};

/* -- At each evaluation, behind the scheme's rates: the path's own. And the step that it allows. */

enum { STEP = N_MOTION_PARAMS };
static const sph_param still_params[] = {
    PISTON_PARAMS,
    SPH_PARAM("step", "", "way in a step, at most, in units of the smallest smoothing length", 0.25,
              1e-6, 1),
};
enum { STILL_A, STILL_DU };
static const sph_prop still_props[] = {
    SPH_PROP("a", "m/s^2", "acceleration", SPH_VECTOR, SPH_DST_WRITE, 0),
    SPH_PROP("du", "W/kg", "rate of the specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0),
};

/* Once a pass. The smallest h is a reduction of piston-state, which stands earlier in the recipe. */
static sph_status propose(const sph_batch *b)
{
    const sph_reductions *reductions = b->host->extension(b->host, SPH_EXT_REDUCTIONS);
    const sph_time_step *time_step = b->host->extension(b->host, SPH_EXT_TIME_STEP);
    const struct motion *now = b->state;

    piston_prepare(b);
    if (!reductions || !time_step)
        return b->host->fail(b->host, SPH_E_UNKNOWN,
                             "piston needs the extensions reductions and time-step of sph");
    const double h = reductions->value(b, "piston-state", "h_near");
    const double speed = fabs(now->speed) + fabs(now->acceleration) * b->dt;
    /* No gas within reach: h is infinite, and there is nothing to be careful of. */
    if (!isfinite(h) || !(speed > 0))
        return SPH_OK;
    return time_step->propose(b, b->param[STEP] * h / speed);
}

#define SPH_POINT_LOOP still
#define SPH_POINT_OUT(P) P(vector, a, STILL_A) P(scalar, du, STILL_DU)
#define SPH_POINT_STATE(P) P(acceleration, NOW_ACCELERATION)
#define SPH_POINT_BODY "still.body.h"
#define SPH_POINT_DEVICE still_device
#include <sph/point-loop.h>

static const sph_item still_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "piston-still",
    .doc = "the piston is moved by its path, not by forces; bounds the time step",
    .source = "README",
    .params = SPH_LIST(still_params),
    .props = SPH_LIST(still_props),
};
const sph_function piston_still = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &still_item,
    .life = &piston_life,
    .run = still,
    .reach_scale = 1,
    .prepare = propose,
    .device_run = &still_device,
};

/* -- After each step: exactly where the path says. */

enum { PLACE_HOME, PLACE_X, PLACE_V };
static const sph_prop place_props[] = {
    SPH_PROP("home", "m", "position at time 0", SPH_VECTOR, SPH_DST_READ, 0),
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_WRITE, NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_WRITE, 0),
};

#define SPH_POINT_LOOP place
#define SPH_POINT_IN(P) P(vector, home, PLACE_HOME)
#define SPH_POINT_OUT(P) P(vector, x, PLACE_X) P(vector, v, PLACE_V)
#define SPH_POINT_STATE(P) P(way, NOW_WAY) P(speed, NOW_SPEED)
#define SPH_POINT_BODY "place.body.h"
#define SPH_POINT_DEVICE place_device
#include <sph/point-loop.h>

static const sph_item place_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "piston-place",
    .doc = "puts the piston where its path says",
    .source = "README",
    .params = SPH_LIST(params),
    .props = SPH_LIST(place_props),
};
const sph_function piston_place = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &place_item,
    .life = &piston_life,
    .run = place,
    .reach_scale = 1,
    .prepare = piston_prepare,
    .device_run = &place_device,
};
