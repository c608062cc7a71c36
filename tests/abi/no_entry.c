/* no_entry.c -- a library like any other: not a plugin. */
#include <sph/abi.h>

SPH_EXPORT int somebody_elses(void);
SPH_EXPORT int somebody_elses(void)
{
    return 1;
}
