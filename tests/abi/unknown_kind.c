/* unknown_kind.c -- registers something of a kind that no sph knows, and fails with the host's
 * own reason. */
#include "module.h"

static sph_status init(const sph_host *host)
{
    (void)module_run;
    return host->register_item(host, "sph.telepathy/0", module_props);
}

SPH_PLUGIN("unknown-kind", "1.0", "", "", init, NULL)
