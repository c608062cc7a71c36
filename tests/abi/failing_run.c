/* failing_run.c -- functions that end the run from the third step on: for one particle, which one rank has, or
 * wherever they are called. */
#include <sph/plugin.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define CULPRIT 7

static const sph_prop props[] = {
    {"id", "", "", SPH_INT64, SPH_DST_READ, 0},
    {"seen", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};

static sph_status one(const sph_batch *b)
{
    const int64_t *name = b->dst[0].data;
    double *seen = b->dst[1].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        seen[i] = 1;
        if (b->step >= 2 && name[i] == CULPRIT)
            return b->host->fail(b->host, SPH_E_NUMERIC, "a particle has had enough");
    }
    return SPH_OK;
}

static sph_status all(const sph_batch *b)
{
    double *seen = b->dst[1].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        seen[i] = 1;
    return b->step < 2 ? SPH_OK
                       : b->host->fail(b->host, SPH_E_NUMERIC, "particles have had enough");
}

static const sph_item one_item = {SIZE(sph_item),         SPH_ALL_DIMS, "fail-one",
                                  "fails for a particle", "",           SPH_NO_LIST,
                                  SPH_LIST(props)};
static const sph_item all_item = {SIZE(sph_item), SPH_ALL_DIMS,   "fail-all", "fails for all", "",
                                  SPH_NO_LIST,    SPH_LIST(props)};
static const sph_function fails_one = {.size = SIZE(sph_function),
                                       .shape = SPH_POINT,
                                       .item = &one_item,
                                       .run = one,
                                       .reach_scale = 1};
static const sph_function fails_all = {.size = SIZE(sph_function),
                                       .shape = SPH_POINT,
                                       .item = &all_item,
                                       .run = all,
                                       .reach_scale = 1};

static sph_status init(const sph_host *host)
{
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &fails_one);

    return status != SPH_OK ? status : host->register_item(host, SPH_KIND_FUNCTION, &fails_all);
}

SPH_PLUGIN("failing-run", "1.0", "BSD-3-Clause", "functions that fail in mid-run", init, NULL)
