/* wrong_magic.c -- its magic number is another program's; that its init is never run, its abort()
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
    static const sph_plugin plugin = {(uint32_t)sizeof(sph_plugin),
                                      0x12345678u,
                                      SPH_ABI_MAJOR,
                                      SPH_ABI_MINOR,
                                      "broken",
                                      "1.0",
                                      "",
                                      "",
                                      init,
                                      NULL};

    return &plugin;
}
