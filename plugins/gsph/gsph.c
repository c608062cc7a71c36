/* gsph.c -- the plugin "gsph": Godunov SPH. README has the equations and their sources. */
#include "gsph.h"

#define DOC "Godunov SPH: pair fluxes from Riemann problems, second order in smooth flow"

static const sph_step steps[] = {
    SPH_STEP(SPH_AT_EVALUATE, "gsph-density"),
    SPH_STEP_EOS(SPH_AT_EVALUATE),
    SPH_STEP(SPH_AT_EVALUATE, "gsph-gradients"),
    SPH_STEP(SPH_AT_EVALUATE, "gsph-rates"),
};

static const sph_rate rates[] = {
    SPH_RATE("x", "v", SPH_DRIFT),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "gsph",
    .doc = DOC,
    .source = "Inutsuka 2002, doi:10.1006/jcph.2002.7053",
};

static const sph_scheme scheme = {
    .size = SIZE(sph_scheme),
    .item = &item,
    .kernel = "wendland-c4",
    .integrator = "kdk",
    .cfl = 0.3,
    .steps = SPH_LIST(steps),
    .rates = SPH_LIST(rates),
};

static sph_status init(const sph_host *host)
{
    const sph_function *const functions[] = {&gsph_density, &gsph_gradients, &gsph_rates};
    for (uint32_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        sph_status status = host->register_item(host, SPH_KIND_FUNCTION, functions[i]);
        if (status != SPH_OK)
            return status;
    }
    return host->register_item(host, SPH_KIND_SCHEME, &scheme);
}

SPH_PLUGIN("gsph", "0.1", "BSD-3-Clause", DOC, init, NULL)
