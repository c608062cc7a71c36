/* duplicate.c -- another plugin, which claims a name of good.c's. */
#include "module.h"

MODULE_FUNCTION(own, "of-the-duplicate");
MODULE_FUNCTION(idle, "idle");

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &own);

    return status != SPH_OK ? status : host->register_item(host, SPH_KIND_FUNCTION, &idle);
}

SPH_PLUGIN("duplicate", "1.0", "", "", init, NULL)
