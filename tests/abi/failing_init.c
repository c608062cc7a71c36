/* failing_init.c -- registers something, and then fails: nothing of it may stay. */
#include "module.h"

MODULE_FUNCTION(half, "half-a-plugin");

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &half);

    return status != SPH_OK ? status : host->fail(host, SPH_E_NUMERIC, "the moon is not full");
}

SPH_PLUGIN("failing-init", "1.0", "", "", init, NULL)
