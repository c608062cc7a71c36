/* my-plugin.c -- a substance dissolved in a fluid, with c [kg/kg] of it in each particle. It
 * spreads from particle to particle and decays,
 *
 *   dc/dt = D laplacian(c) - c / tau.
 *
 * Each term is a function, and a scene puts the two into the recipe of its scheme:
 *   "my-plugin"        spreads: a pair function, a sum over neighbours
 *   "my-plugin-decay"  decays: a point function, each particle alone
 *
 * Source: P. W. Cleary & J. J. Monaghan, J. Comput. Phys. 148 (1999) 227,
 * doi:10.1006/jcph.1998.6118, with the conductivity rho D. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* -- What the functions touch --------
 *
 * Properties are the columns of the particles, shared by name among all functions of a scene: "m"
 * and "rho" are made by the scheme. The host hands them over in the order of this list, so that the
 * enum numbers them. The access is a promise: the host orders the passes, exchanges ghosts and
 * allocates memory by it, and `sph run --audit` traps what breaks it. */
enum { M, RHO, C, DC, DT };
static const sph_prop spread_props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    /* NAN as the start: a scene has to give it. */
    SPH_PROP("c", "kg/kg", "concentration", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    /* A sum over the neighbours, which begins at 0 at each evaluation. */
    SPH_PROP("dc", "1/s", "rate of the concentration", SPH_SCALAR, SPH_DST_SUM, 0),
    SPH_PROP("my_plugin_dt", "s", "time step that the spreading allows, before cfl", SPH_SCALAR,
             SPH_DST_WRITE | SPH_WORK, 0),
};

/* What a user may set. The host parses it, checks its range, and shows it in `sph info`. */
enum { DIFFUSIVITY };
static const sph_param spread_params[] = {
    SPH_PARAM("diffusivity", "m^2/s", "how fast it spreads", 0.01, 0, 1e300),
};

/* -- The pair function --------
 *
 * pair-loop.h makes the loops over all pairs, for one to three dimensions and for the instruction
 * sets of the processor, out of what is done for one pair: my-plugin.body.h. S(name, NUMBER) gives
 * the body the property NUMBER: as name_i of the destination, as name_j of the source, or as the
 * sum `name`. Vectors are V(name, NUMBER). */
#define SPH_LOOP spread
#define SPH_LOOP_I(S, V, MATRIX) S(rho, RHO) S(c, C)
#define SPH_LOOP_J(S, V, MATRIX) S(m, M) S(rho, RHO) S(c, C)
#define SPH_LOOP_SUM(S, V, MATRIX) S(rate, DC)
#define SPH_LOOP_PARAM(P) P(diffusivity, DIFFUSIVITY)
#define SPH_LOOP_REACH SPH_SYMMETRIC
#define SPH_LOOP_BODY "my-plugin.body.h"
#define SPH_LOOP_DEVICE spread_on_device /* the same body, as text for OpenCL devices */
#include <sph/pair-loop.h>

/* After the sweep, each destination alone. point-loop.h makes `limit` out of what is done for one
 * particle, limit.body.h. P(scalar, name, NUMBER) gives that the property NUMBER, as do vector and the
 * like; it reads what stands in _IN, sets what stands in _OUT; _H gives it h. Many threads work on a
 * range of particles each, so that nothing is kept between calls and no other particle is written to. */
#define SPH_POINT_LOOP limit
#define SPH_POINT_OUT(P) P(scalar, dt, DT)
#define SPH_POINT_PARAM(P) P(diffusivity, DIFFUSIVITY)
#define SPH_POINT_H
#define SPH_POINT_BODY "limit.body.h"
#define SPH_POINT_DEVICE limit_on_device
#include <sph/point-loop.h>

/* c is advanced with dc, like a velocity with an acceleration. */
static const sph_rate rates[] = {SPH_RATE("c", "dc", SPH_KICK)};

/* The smallest my_plugin_dt bounds the time step. */
static const sph_reduction reductions[] = {
    SPH_REDUCTION("my-plugin-dt", "my_plugin_dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),
};

/* Members that are left out are 0 or NULL, which is the default of each: sph/function.h. */
static const sph_item spread_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin",
    .doc = "diffusion of a dissolved substance",
    .source = "Cleary & Monaghan 1999, doi:10.1006/jcph.1998.6118",
    .params = SPH_LIST(spread_params),
    .props = SPH_LIST(spread_props),
};
static const sph_function spread_function = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &spread_item,
    .run = spread, /* the sweep that pair-loop.h made */
    .after = limit,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device = &spread_on_device,
    .device_after = &limit_on_device,
};

/* -- The point function -------- */

enum { DECAY_C, DECAY_DC };
static const sph_prop decay_props[] = {
    SPH_PROP("c", "kg/kg", "concentration", SPH_SCALAR, SPH_DST_READ, NAN),
    /* Sums that are rates add up over the functions of a recipe: this one works alone as well. */
    SPH_PROP("dc", "1/s", "rate of the concentration", SPH_SCALAR, SPH_DST_SUM, 0),
};
enum { TAU };
static const sph_param decay_params[] = {
    SPH_PARAM("tau", "s", "time in which it falls to 1/e", NAN, 1e-300, 1e300),
};

/* _INOUT: it reads and sets them. */
#define SPH_POINT_LOOP decay
#define SPH_POINT_IN(P) P(scalar, c, DECAY_C)
#define SPH_POINT_INOUT(P) P(scalar, dc, DECAY_DC)
#define SPH_POINT_PARAM(P) P(tau, TAU)
#define SPH_POINT_BODY "decay.body.h"
#define SPH_POINT_DEVICE decay_on_device
#include <sph/point-loop.h>

static const sph_item decay_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin-decay",
    .doc = "decay of a dissolved substance",
    .source = "Rutherford & Soddy 1902, doi:10.1080/14786440209462856",
    .params = SPH_LIST(decay_params),
    .props = SPH_LIST(decay_props),
};
static const sph_function decay_function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &decay_item,
    .run = decay,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .device_run = &decay_on_device,
};

/* -- The plugin -------- */

/* Called once, when the plugin is loaded. It registers, and does nothing else. */
static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &spread_function);

    if (status != SPH_OK)
        return status;
    return host->register_item(host, SPH_KIND_FUNCTION, &decay_function);
}

/* The one symbol that the plugin exports: name, version, licence, what it is, init, fini. */
SPH_PLUGIN("my-plugin", "0.1", "BSD-3-Clause", "a dissolved substance that spreads and decays",
           init, NULL)
