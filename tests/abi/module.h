/* module.h -- what the test modules share: one harmless function to register. */
#ifndef MODULE_H
#define MODULE_H

#include <sph/plugin.h>

static const sph_prop module_props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_UPDATE, 0},
};

static sph_status module_run(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

/* A point function called `name`. */
#define MODULE_FUNCTION(variable, name)                                                            \
    static const sph_item variable##_item = {                                                      \
        (uint32_t)sizeof(sph_item), SPH_ALL_DIMS, (name), "does nothing", "", SPH_NO_LIST,         \
        SPH_LIST(module_props)};                                                                   \
    static const sph_function variable = {.size = (uint32_t)sizeof(sph_function),                  \
                                          .shape = SPH_POINT,                                      \
                                          .item = &variable##_item,                                \
                                          .run = module_run}

#endif
