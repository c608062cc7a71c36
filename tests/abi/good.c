/* good.c -- nothing is wrong with it. */
#include "module.h"

MODULE_FUNCTION(idle, "idle");

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &idle);
}

SPH_PLUGIN("good", "1.2", "BSD-3-Clause", "a plugin without fault", init, NULL)
