/* wild_pointer.c -- a pointer that was never set: the descriptor's item is where no memory is. */
#include "module.h"

static sph_status init(const sph_host *host)
{
    static sph_function lost = {
        .size = (uint32_t)sizeof(sph_function), .shape = SPH_POINT, .run = module_run};

    lost.item = (const sph_item *)(uintptr_t)0x7f00dead0000u;
    return host->register_item(host, SPH_KIND_FUNCTION, &lost);
}

SPH_PLUGIN("wild-pointer", "1.0", "", "", init, NULL)
