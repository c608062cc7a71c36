/* wcsph.c -- the plugin "wcsph": weakly compressible SPH. README has the equations and their sources. */
#include "wcsph.h"
#include <sph/fusion.h>

#define DOC "weakly compressible SPH: density by continuity, artificial viscosity"

static const sph_step steps[] = {
    SPH_STEP_EOS(SPH_AT_EVALUATE),
    SPH_STEP(SPH_AT_EVALUATE, "wcsph-pressure"),
    SPH_STEP(SPH_AT_EVALUATE, "wcsph-continuity"),
    SPH_STEP(SPH_AT_EVALUATE, "wcsph-momentum"),
};

static const sph_rate rates[] = {
    SPH_RATE("x", "v", SPH_DRIFT),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "wcsph",
    .doc = DOC,
    .source = "Monaghan 1994, doi:10.1006/jcph.1994.1034",
};

static const sph_scheme scheme = {
    .size = SIZE(sph_scheme),
    .item = &item,
    .kernel = "wendland-c2",
    .integrator = "kdk",
    .cfl = 0.3,
    .steps = SPH_LIST(steps),
    .rates = SPH_LIST(rates),
    .reals = SPH_F32,
};

static const char *const parts[] = {"wcsph-continuity", "wcsph-momentum"};
static const sph_fusion fusion = {SIZE(sph_fusion), 0u, "wcsph-rates", SPH_LIST(parts)};

static sph_status init(const sph_host *host)
{
    const sph_function *const functions[] = {&wcsph_pressure, &wcsph_continuity, &wcsph_momentum,
                                             &wcsph_rates};
    const sph_fusions *fusions = host->extension(host, SPH_EXT_FUSION);
    for (uint32_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, functions[i]);
        if (status != SPH_OK)
            return status;
    }
    if (fusions) {
        const sph_status status = fusions->declare(host, &fusion);
        if (status != SPH_OK)
            return status;
    }
    return host->register_item(host, SPH_KIND_SCHEME, &scheme);
}

SPH_PLUGIN("wcsph", "0.1", "BSD-3-Clause", DOC, init, NULL)
