/* fp_entry.c -- its entry sets the rounding mode. */
#include "module.h"

#include <fenv.h>

MODULE_FUNCTION(idle, "rounds-at-entry");

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &idle);
}

SPH_EXPORT const sph_plugin *sph_plugin_entry(void)
{
    static const sph_plugin plugin = {(uint32_t)sizeof(sph_plugin),
                                      SPH_PLUGIN_MAGIC,
                                      SPH_ABI_MAJOR,
                                      SPH_ABI_MINOR,
                                      "fp-entry",
                                      "1.0",
                                      "",
                                      "",
                                      init,
                                      NULL};

    fesetround(FE_UPWARD);
    return &plugin;
}
