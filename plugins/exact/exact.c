/* exact.c -- the plugin "exact": exact solutions, for error norms. */
#include <sph/plugin.h>

#include "exact.h"

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_EXACT, &riemann);

    return status != SPH_OK ? status : host->register_item(host, SPH_KIND_EXACT, &noh);
}

SPH_PLUGIN("exact", "0.1", "BSD-3-Clause", "exact solutions: Riemann's problem, Noh's implosion",
           init, NULL)
