/* eos.c -- the plugin "eos": equations of state. */
#include <sph/plugin.h>

#include "eos.h"

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_EOS, &ideal_gas);
}

SPH_PLUGIN("eos", "0.1", "BSD-3-Clause", "equations of state: ideal gas", init, NULL)
