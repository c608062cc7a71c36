/* eos.c -- the plugin "eos": equations of state. */
#include <sph/plugin.h>

#include "eos.h"

static sph_status init(const sph_host *host)
{
    const sph_eos *const all[] = {&ideal_gas, &linear, &tait};
    for (uint32_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_EOS, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("eos", "0.1", "BSD-3-Clause", "equations of state: ideal gas, linear, Tait", init, NULL)
