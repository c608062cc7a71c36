/* flush_to_zero.c -- does to the floating point mode what linking with -ffast-math does. */
#include "module.h"

#if defined(__SSE2__)
#include <xmmintrin.h>

__attribute__((constructor)) static void spoil(void)
{
    _mm_setcsr(_mm_getcsr() | 0x8040u);
}
#endif

MODULE_FUNCTION(idle, "fast-and-wrong");

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &idle);
}

SPH_PLUGIN("flush-to-zero", "1.0", "", "", init, NULL)
