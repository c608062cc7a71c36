/* my-plugin.c -- a sponge: a layer that takes the motion out of a fluid, so that waves do not come
 * back from the end of the domain. Between the planes x = from and x = to the rate of damping grows
 * from 0 to 1 / tau,
 *
 *   dv/dt = -s(x)^2 v / tau,      s = (x - from) / (to - from) within 0 and 1,
 *
 * and stays at 1 / tau beyond. In each step v is multiplied by exp(-s^2 dt / tau), the exact
 * solution.
 *
 * Source: M. Israeli & S. A. Orszag, J. Comput. Phys. 41 (1981) 115,
 * doi:10.1016/0021-9991(81)90082-6. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* A boundary condition is a list of functions and of the moments at which they act. This one has a
 * single function, "my-plugin-damp", which looks at each particle alone. */

/* What the function is handed, in this order. The access is a promise: the host orders the passes
 * and allocates memory by it. */
enum { X, V };
static const sph_prop props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_UPDATE, NAN),
};

/* A scene sets these on the boundary condition, and they reach the function that declares them. NAN
 * as the default: it has to. */
enum { FROM, TO, TAU };
static const sph_param params[] = {
    SPH_PARAM("from", "m", "x where the layer begins", NAN, -1e300, 1e300),
    SPH_PARAM("to", "m", "x where it has its full strength", NAN, -1e300, 1e300),
    SPH_PARAM("tau", "s", "time in which the velocity falls to 1/e there", NAN, 1e-300, 1e300),
};

/* What is done for one particle stands in damp.body.h. point-loop.h makes of it the function `damp`, for a
 * range of particles: P(vector, name, NUMBER) gives that the property NUMBER; it reads what stands in
 * _IN, reads and sets what stands in _INOUT. Many threads do this at once, each with a range of its own:
 * nothing is kept between calls. SPH_POINT_DEVICE: the same body, as text for OpenCL devices. */
#define SPH_POINT_LOOP damp
#define SPH_POINT_IN(P) P(vector, x, X)
#define SPH_POINT_INOUT(P) P(vector, v, V)
#define SPH_POINT_PARAM(P) P(from, FROM) P(to, TO) P(tau, TAU)
#define SPH_POINT_BODY "damp.body.h"
#define SPH_POINT_DEVICE damp_on_device
#include <sph/point-loop.h>

static const sph_item damp_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin-damp",
    .doc = "takes the velocity out of the particles in a layer",
    .source = "Israeli & Orszag 1981, doi:10.1016/0021-9991(81)90082-6",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};
static const sph_function damp_function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &damp_item,
    .run = damp,
    .reach_scale = 1.0,
    .device_run = &damp_on_device,
};

/* SPH_AT_FINISH: after every step, when b->dt is the step that was taken. Other moments are the
 * start and every evaluation of the rates, there at a place among the scheme's functions that
 * `after` or `before` names. SPH_ON_BOUNDARY: on the arrays that the scene names in the condition.
 */
static const sph_step steps[] = {
    SPH_STEP(SPH_AT_FINISH, "my-plugin-damp"),
};
static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin",
    .doc = "a layer that absorbs waves",
    .source = "Israeli & Orszag 1981, doi:10.1016/0021-9991(81)90082-6",
};
static const sph_boundary boundary = {
    .size = SIZE(sph_boundary),
    .item = &item,
    .steps = SPH_LIST(steps),
};

/* Called once, when the plugin is loaded. It registers, and does nothing else. */
static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &damp_function);

    if (status != SPH_OK)
        return status;
    return host->register_item(host, SPH_KIND_BOUNDARY, &boundary);
}

/* The one symbol that the plugin exports: name, version, licence, what it is, init, fini. */
SPH_PLUGIN("my-plugin", "0.1", "BSD-3-Clause", "a layer that absorbs waves", init, NULL)
