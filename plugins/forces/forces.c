/* forces.c -- the plugin "forces": forces on each particle alone. README has the equations. */
#include "forces.h"

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &body_force);
    return status != SPH_OK ? status : host->register_item(host, SPH_KIND_FUNCTION, &central_force);
}

SPH_PLUGIN("forces", "0.1", "BSD-3-Clause",
           "forces on each particle alone: uniform acceleration, central force", init, NULL)
