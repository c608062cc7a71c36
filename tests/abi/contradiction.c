/* contradiction.c -- a pair function without a reach; and it does not care that it was refused. */
#include "module.h"

static const sph_item item = {(uint32_t)sizeof(sph_item),
                              SPH_ALL_DIMS,
                              "at-odds",
                              "a pair function "
                              "without a reach",
                              "",
                              SPH_NO_LIST,
                              SPH_LIST(module_props)};
static const sph_function at_odds = {
    .size = (uint32_t)sizeof(sph_function), .shape = SPH_PAIR, .item = &item, .run = module_run};

static sph_status init(const sph_host *host)
{
    host->register_item(host, SPH_KIND_FUNCTION, &at_odds);
    return SPH_OK;
}

SPH_PLUGIN("contradiction", "1.0", "", "", init, NULL)
