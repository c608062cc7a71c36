/* nan_result.c -- functions that give what is no number, for one particle, from the third step
 * on: in a rate, which everything else follows from, and in a property that nothing else reads. */
#include <sph/plugin.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define CULPRIT 7u

static void spoil(const sph_batch *b, uint32_t column, uint32_t id)
{
    const int64_t *name = b->dst[id].data;
    double *value = b->dst[column].data;
    double zero = (double)(b->step < 2);
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        if (name[i] == CULPRIT && b->step >= 2)
            value[i] = zero / zero;
}

static const sph_prop heat_props[] = {
    {"id", "", "", SPH_INT64, SPH_DST_READ, 0},
    {"a", "m/s^2", "", SPH_VECTOR, SPH_DST_UPDATE, 0},
};

static sph_status heat(const sph_batch *b)
{
    spoil(b, 1, 0);
    return SPH_OK;
}

static const sph_prop aside_props[] = {
    {"id", "", "", SPH_INT64, SPH_DST_READ, 0},
    {"aside", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};

static sph_status aside(const sph_batch *b)
{
    double *value = b->dst[1].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        value[i] = 1;
    spoil(b, 1, 0);
    return SPH_OK;
}

static const sph_item heat_item = {SIZE(sph_item),      SPH_ALL_DIMS, "nan-rate",
                                   "gives no number",   "",           SPH_NO_LIST,
                                   SPH_LIST(heat_props)};
static const sph_item aside_item = {SIZE(sph_item),       SPH_ALL_DIMS, "nan-aside",
                                    "gives no number",    "",           SPH_NO_LIST,
                                    SPH_LIST(aside_props)};
static const sph_function heater = {.size = SIZE(sph_function),
                                    .shape = SPH_POINT,
                                    .item = &heat_item,
                                    .run = heat,
                                    .reach_scale = 1};
static const sph_function setter = {.size = SIZE(sph_function),
                                    .shape = SPH_POINT,
                                    .item = &aside_item,
                                    .run = aside,
                                    .reach_scale = 1};

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &heater);

    return status != SPH_OK ? status : host->register_item(host, SPH_KIND_FUNCTION, &setter);
}

SPH_PLUGIN("nan-result", "1.0", "BSD-3-Clause", "functions that give what is no number", init, NULL)
