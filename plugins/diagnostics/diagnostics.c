/* diagnostics.c -- the plugin "diagnostics": functions that look at particles and change nothing of a
 * run. README has the equations. */
#include "diagnostics.h"

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &nearest_function);
}

SPH_PLUGIN("diagnostics", "0.1", "BSD-3-Clause",
           "what particles look like, for probes and pictures: the distance to the nearest", init,
           NULL)
