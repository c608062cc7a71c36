/* huge_struct.c -- its descriptor is absurdly large; that its init is never run, its abort()
 * proves. */
#include <sph/plugin.h>

#include <stdlib.h>

static sph_status init(const sph_host *host)
{
    (void)host;
    abort();
}

SPH_EXPORT const sph_plugin *sph_plugin_entry(void)
{
    static const sph_plugin plugin = {
        0x7fffffff, SPH_PLUGIN_MAGIC, SPH_ABI_MAJOR, SPH_ABI_MINOR, "broken", "1.0", "", "", init,
        NULL};

    return &plugin;
}
