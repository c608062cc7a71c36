/* crashing_init.c -- follows a NULL pointer in its init. */
#include <sph/plugin.h>

static volatile int *volatile nowhere;

static sph_status init(const sph_host *host)
{
    (void)host;
    *nowhere = 1;
    return SPH_OK;
}

SPH_PLUGIN("crashing-init", "1.0", "", "", init, NULL)
