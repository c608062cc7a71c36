/* fp_init.c -- its init sets the precision of the x87 unit, or the rounding mode where there is
 * none. */
#include "module.h"

#include <fenv.h>

MODULE_FUNCTION(idle, "rounds-at-init");

static sph_status init(const sph_host *host)
{
#if defined(__x86_64__) || defined(__i386__)
    uint16_t control;
    __asm__ volatile("fnstcw %0" : "=m"(control));
    control = (uint16_t)(control & ~0x300u); /* 24 bits */
    __asm__ volatile("fldcw %0" : : "m"(control));
#else
    fesetround(FE_UPWARD);
#endif
    return host->register_item(host, SPH_KIND_FUNCTION, &idle);
}

SPH_PLUGIN("fp-init", "1.0", "", "", init, NULL)
