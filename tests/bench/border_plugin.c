/* border_plugin.c -- the sweep as a plugin. */
#include "border_sweep.h"

#define READ (SPH_DST_READ | SPH_SRC_READ)

static const sph_param params[] = {{.name = "alpha", .def = 0.1, .max = 1.0}};
static const sph_prop props[] = {
    {.name = "m", .type = SPH_SCALAR, .access = SPH_SRC_READ},
    {.name = "rho", .type = SPH_SCALAR, .access = READ},
    {.name = "p", .type = SPH_SCALAR, .access = READ},
    {.name = "v", .type = SPH_VECTOR, .access = READ},
    {.name = "drho", .type = SPH_SCALAR, .access = SPH_DST_SUM},
    {.name = "a", .type = SPH_VECTOR, .access = SPH_DST_SUM},
};
static const sph_item item = {.size = (uint32_t)sizeof(sph_item),
                              .dims = SPH_ALL_DIMS,
                              .name = "sweep",
                              .doc = "a sweep to be measured",
                              .params = SPH_LIST(params),
                              .props = SPH_LIST(props)};
static const sph_function sweep = {.size = (uint32_t)sizeof(sph_function),
                                   .shape = SPH_PAIR,
                                   .item = &item,
                                   .run = border_sweep,
                                   .reach = SPH_SYMMETRIC};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &sweep);
}

SPH_PLUGIN("border", "1.0", "BSD-3-Clause", "a sweep to be measured", init, NULL)
