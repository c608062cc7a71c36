/* eos.c -- the plugin "eos": equations of state. */
#include <sph/plugin.h>

#include "eos.h"

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_EOS, &ideal_gas);
    return status != SPH_OK ? status : host->register_item(host, SPH_KIND_EOS, &tait);
}

SPH_PLUGIN("eos", "0.1", "BSD-3-Clause", "equations of state: ideal gas, Tait", init, NULL)
