/* undefined_symbol.c -- calls what nobody has, late: a lazy loader would find out in the middle of
 * a run. Linked without -z defs and without -z now. */
#include "module.h"

extern sph_status nobody_has_this_function(const sph_batch *b);

static sph_status run(const sph_batch *b)
{
    return nobody_has_this_function(b);
}

static const sph_item item = {(uint32_t)sizeof(sph_item),
                              SPH_ALL_DIMS,
                              "lost",
                              "calls a function "
                              "that is nowhere",
                              "",
                              SPH_NO_LIST,
                              SPH_LIST(module_props)};
static const sph_function lost = {
    .size = (uint32_t)sizeof(sph_function), .shape = SPH_POINT, .item = &item, .run = run};

static sph_status init(const sph_host *host)
{
    (void)module_run;
    return host->register_item(host, SPH_KIND_FUNCTION, &lost);
}

SPH_PLUGIN("undefined-symbol", "1.0", "", "", init, NULL)
