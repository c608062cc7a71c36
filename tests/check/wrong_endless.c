/* wrong_endless.c -- a point function that does not come back. */
#include "wrong.h"

#include <math.h>

static const sph_prop props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_UPDATE, NAN},
};

static sph_status run(const sph_batch *b)
{
    (void)b;
    for (volatile int go = 1; go;)
        continue;
    return SPH_OK;
}

ITEM(item, "never-returns", props);
static const sph_function endless = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &item, .run = run, .reach_scale = 1};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &endless);
}

SPH_PLUGIN("wrong-endless", "1.0", "BSD-3-Clause", "never comes back", init, NULL)
