/* barotropic.c -- the plugin "barotropic": a compressible fluid without any dissipation. README has the
 * equations and their sources. */
#include "barotropic.h"

static const sph_step summation[] = {
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-density"),
    SPH_STEP_EOS(SPH_AT_EVALUATE),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-pressure"),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-energy"),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-momentum"),
};

static const sph_step continuity[] = {
    SPH_STEP_EOS(SPH_AT_EVALUATE),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-pressure"),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-energy"),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-continuity"),
    SPH_STEP(SPH_AT_EVALUATE, "barotropic-momentum"),
};

static const sph_rate rates[] = {
    SPH_RATE("x", "v", SPH_DRIFT),
};

static const sph_item summation_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic",
    .doc = "barotropic fluid without dissipation, fixed h: density by summation",
    .source = "Price 2012, doi:10.1016/j.jcp.2010.12.011, sections 2, 3",
};

static const sph_item continuity_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "barotropic-continuity",
    .doc = "barotropic fluid without dissipation, fixed h: density by the continuity equation",
    .source = "Monaghan 1994, doi:10.1006/jcph.1994.1034, eq. 2.6; Monaghan 1992, "
              "doi:10.1146/annurev.aa.30.090192.002551, eq. 3.1",
};

static const sph_scheme schemes[] = {
    {
        .size = SIZE(sph_scheme),
        .item = &summation_item,
        .kernel = "wendland-c2",
        .integrator = "kdk",
        .cfl = 0.3,
        .steps = SPH_LIST(summation),
        .rates = SPH_LIST(rates),
    },
    {
        .size = SIZE(sph_scheme),
        .item = &continuity_item,
        .kernel = "wendland-c2",
        .integrator = "kdk",
        .cfl = 0.3,
        .steps = SPH_LIST(continuity),
        .rates = SPH_LIST(rates),
    },
};

static sph_status init(const sph_host *host)
{
    const sph_function *const functions[] = {&barotropic_density, &barotropic_continuity,
                                             &barotropic_pressure, &barotropic_energy,
                                             &barotropic_momentum};
    for (uint32_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, functions[i]);
        if (status != SPH_OK)
            return status;
    }
    for (uint32_t i = 0; i < sizeof schemes / sizeof schemes[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_SCHEME, &schemes[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("barotropic", "0.1", "BSD-3-Clause",
           "barotropic fluid without dissipation: density by summation or by continuity", init,
           NULL)
