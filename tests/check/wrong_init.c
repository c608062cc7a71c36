/* wrong_init.c -- does not survive being loaded. */
#include "wrong.h"

static sph_status init(const sph_host *host)
{
    volatile int *volatile nowhere = NULL;

    (void)host;
    *nowhere = 1;
    return SPH_OK;
}

SPH_PLUGIN("wrong-init", "1.0", "BSD-3-Clause", "falls as it is loaded", init, NULL)
