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

static sph_status start(const sph_batch *b)
{
    const struct motion now = piston_motion(b, b->time);
    const double *m = b->dst[START_M].data, *rho = b->dst[START_RHO].data;
    double *volume = b->dst[START_VOLUME].data;

    if (b->real != SPH_F64)
        return b->host->fail(b->host, SPH_E_UNKNOWN, "piston works in double precision");
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        volume[i] = m[i] / rho[i];
        for (uint32_t c = 0; c < b->dim; c++) {
            const double x = piston_plane(&b->dst[START_X], c)[i];
            piston_plane(&b->dst[START_HOME], c)[i] = c == 0 ? x - now.way : x;
            piston_plane(&b->dst[START_V], c)[i] = c == 0 ? now.speed : 0;
        }
    }
    return SPH_OK;
}

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
    const struct motion now = piston_motion(b, b->time);

    if (!reductions || !time_step)
        return b->host->fail(b->host, SPH_E_UNKNOWN,
                             "piston needs the extensions reductions and time-step of sph");
    const double h = reductions->value(b, "piston-state", "h_near");
    const double speed = fabs(now.speed) + fabs(now.acceleration) * b->dt;
    /* No gas within reach: h is infinite, and there is nothing to be careful of. */
    if (!isfinite(h) || !(speed > 0))
        return SPH_OK;
    return time_step->propose(b, b->param[STEP] * h / speed);
}

static sph_status still(const sph_batch *b)
{
    const struct motion now = piston_motion(b, b->time);
    double *du = b->dst[STILL_DU].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        du[i] = 0;
        for (uint32_t c = 0; c < b->dim; c++)
            piston_plane(&b->dst[STILL_A], c)[i] = c == 0 ? now.acceleration : 0;
    }
    return SPH_OK;
}

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
};

/* -- After each step: exactly where the path says. */

enum { PLACE_HOME, PLACE_X, PLACE_V };
static const sph_prop place_props[] = {
    SPH_PROP("home", "m", "position at time 0", SPH_VECTOR, SPH_DST_READ, 0),
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_WRITE, NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_WRITE, 0),
};

static sph_status place(const sph_batch *b)
{
    const struct motion now = piston_motion(b, b->time);

    for (uint64_t i = b->first; i < b->first + b->count; i++)
        for (uint32_t c = 0; c < b->dim; c++) {
            const double home = piston_plane(&b->dst[PLACE_HOME], c)[i];
            piston_plane(&b->dst[PLACE_X], c)[i] = c == 0 ? home + now.way : home;
            piston_plane(&b->dst[PLACE_V], c)[i] = c == 0 ? now.speed : 0;
        }
    return SPH_OK;
}

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
};
