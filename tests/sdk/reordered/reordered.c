/* reordered.c -- the steps of the scheme gsph in another order: its gradients first. README says what that
 * changes. The functions are those of the plugin gsph, found by name: this plugin holds none. */
#include <sph/plugin.h>

/* Gradients of the last evaluation's density and pressure, of the velocities and positions of this one. */
static const sph_step steps[] = {
    SPH_STEP(SPH_AT_EVALUATE, "gsph-gradients"),
    SPH_STEP(SPH_AT_EVALUATE, "gsph-density"),
    SPH_STEP_EOS(SPH_AT_EVALUATE),
    SPH_STEP(SPH_AT_EVALUATE, "gsph-rates"),
};

static const sph_rate rates[] = {
    SPH_RATE("x", "v", SPH_DRIFT),
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "reordered",
    .doc = "gsph with its gradients first: of the last evaluation's density and pressure",
    .source = "README",
};

static const sph_scheme scheme = {
    .size = (uint32_t)sizeof(sph_scheme),
    .item = &item,
    .kernel = "wendland-c4",
    .integrator = "kdk",
    .cfl = 0.3,
    .steps = SPH_LIST(steps),
    .rates = SPH_LIST(rates),
};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_SCHEME, &scheme);
}

SPH_PLUGIN("reordered", "0.1", "BSD-3-Clause", "gsph in another order", init, NULL)
