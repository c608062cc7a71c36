/* newer_minor.c -- it was built for a newer minor version of the ABI; that its init is never run,
 * its abort() proves. */
#include <sph/plugin.h>

#include <stdlib.h>

static sph_status init(const sph_host *host)
{
    (void)host;
    abort();
}

SPH_EXPORT const sph_plugin *sph_plugin_entry(void)
{
    static const sph_plugin plugin = {(uint32_t)sizeof(sph_plugin),
                                      SPH_PLUGIN_MAGIC,
                                      SPH_ABI_MAJOR,
                                      SPH_ABI_MINOR + 1,
                                      "broken",
                                      "1.0",
                                      "",
                                      "",
                                      init,
                                      NULL};

    return &plugin;
}
