/* piston.c -- the plugin "piston": a wall that moves along x on a prescribed path and drives the gas before
 * it. Here the boundary condition: which function acts when, on what. README has the equations. */
#include "piston.h"

static const sph_step steps[] = {
    SPH_STEP_AT(SPH_AT_START, "piston-start", NULL, NULL, SPH_ON_BOUNDARY),
    /* Behind the equation of state the gas has its pressure; gradients and rates come later. */
    SPH_STEP_AT(SPH_AT_EVALUATE, "piston-state", "eos", NULL, SPH_ON_BOUNDARY),
    /* At the end: behind whatever has given the piston an acceleration. */
    SPH_STEP_AT(SPH_AT_EVALUATE, "piston-still", NULL, NULL, SPH_ON_BOUNDARY),
    SPH_STEP_AT(SPH_AT_FINISH, "piston-place", NULL, NULL, SPH_ON_BOUNDARY),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "piston",
    .doc = "a wall of particles that moves along x on a prescribed path",
    .source = "Adami, Hu & Adams 2012, doi:10.1016/j.jcp.2012.05.005",
};
static const sph_boundary boundary = {
    .size = SIZE(sph_boundary),
    .item = &item,
    .steps = SPH_LIST(steps),
};

static sph_status init(const sph_host *host)
{
    const sph_function *const functions[] = {&piston_start, &piston_state, &piston_still,
                                             &piston_place};
    for (uint32_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, functions[i]);
        if (status != SPH_OK)
            return status;
    }
    return host->register_item(host, SPH_KIND_BOUNDARY, &boundary);
}

SPH_PLUGIN("piston", "0.1", "BSD-3-Clause", "a moving piston", init, NULL)
