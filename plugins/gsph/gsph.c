/* gsph.c -- the plugin "gsph": Godunov SPH. README has the equations and their sources. */
#include "gsph.h"

#define DOC "Godunov SPH: pair fluxes from Riemann problems, second order in smooth flow"

static const sph_step steps[] = {
    {SPH_AT_EVALUATE, SPH_KIND_FUNCTION, "gsph-density"},
    {SPH_AT_EVALUATE, SPH_KIND_EOS, ""},
    {SPH_AT_EVALUATE, SPH_KIND_FUNCTION, "gsph-gradients"},
    {SPH_AT_EVALUATE, SPH_KIND_FUNCTION, "gsph-rates"},
};

static const sph_rate rates[] = {
    {"x", "v", SPH_DRIFT, 0},
};

static const sph_item item = {
    SIZE(sph_item), SPH_ALL_DIMS, "gsph", DOC, "Inutsuka 2002, doi:10.1006/jcph.2002.7053",
    SPH_NO_LIST,    SPH_NO_LIST,
};

static const sph_scheme scheme = {
    SIZE(sph_scheme), 0, &item, "wendland-c4", "kdk", 0.3, SPH_LIST(steps), SPH_LIST(rates),
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
