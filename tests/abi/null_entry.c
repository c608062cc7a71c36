/* null_entry.c -- its entry returns NULL. */
#include <sph/plugin.h>

SPH_EXPORT const sph_plugin *sph_plugin_entry(void)
{
    return NULL;
}
