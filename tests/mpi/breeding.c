/* breeding.c -- a function by which particles of any place are taken away, and others make one to three copies, as
 * their ids and the step say. Whoever numbers the copies in another order gets other ones from then on. And one that
 * heats by what an earlier step of the same evaluation has found as the least of all particles. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

enum { ID, U, LEAVES, COPIES };
static const sph_prop props[] = {
    SPH_PROP("id", "", "who it is", SPH_INT64, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_UPDATE, NAN),
    SPH_PROP("leaves", "", "1: to be taken away", SPH_INT32, SPH_DST_WRITE | SPH_WORK, 0),
    SPH_PROP("copies", "", "how many copies to make", SPH_INT32, SPH_DST_WRITE | SPH_WORK, 0),
};

static sph_status run(const sph_batch *b)
{
    const int64_t *id = b->dst[ID].data;
    double *u = b->dst[U].data;
    int32_t *leaves = b->dst[LEAVES].data, *copies = b->dst[COPIES].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        const uint64_t lot = ((uint64_t)id[i] * 2654435761u + b->step * 40503u) >> 3;
        u[i] *= 1.0 + 1e-4 * (double)(lot % 3);
        leaves[i] = lot % 47 == 1;
        copies[i] = lot % 53 == 2 ? 1 + (int32_t)(lot / 53 % 3) : 0;
    }
    return SPH_OK;
}

enum { BORN_X, BORN_NUMBER };
static const sph_prop born_props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_UPDATE, NAN),
    SPH_PROP("copies", "", "number of the copy", SPH_INT32, SPH_DST_READ, 0),
};

static sph_status born(const sph_batch *b)
{
    double *x = b->dst[BORN_X].data;
    const int32_t *number = b->dst[BORN_NUMBER].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++)
        x[i] += 0.013 * number[i];
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "breed",
    .doc = "takes particles away and makes others",
    .source = "breeding.c",
    .props = SPH_LIST(props),
};
static const sph_function function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .reach_scale = 1,
};
static const sph_population population = {
    .size = SIZE(sph_population),
    .remove = "leaves",
    .create = "copies",
    .born = born,
    .born_props = SPH_LIST(born_props),
};

enum { HEED_U };
static const sph_prop heed_props[] = {
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_UPDATE, NAN),
};

static sph_status heed(const sph_batch *b)
{
    const sph_reductions *reductions = b->host->extension(b->host, SPH_EXT_REDUCTIONS);
    double *u = b->dst[HEED_U].data;

    if (!reductions)
        return b->host->fail(b->host, SPH_E_UNKNOWN, "heed needs the extension sph.reductions/0");
    const double least = reductions->value(b, "gsph-rates", "dt");
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        u[i] *= 1.0 + 1e-2 * least;
    return SPH_OK;
}

static const sph_item heed_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "heed",
    .doc = "heats by the bound of the time step",
    .source = "breeding.c",
    .props = SPH_LIST(heed_props),
};
static const sph_function heed_function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &heed_item,
    .run = heed,
    .reach_scale = 1,
};

static sph_status init(const sph_host *host)
{
    const sph_population_ext *extension = host->extension(host, SPH_EXT_POPULATION);

    if (!extension)
        return host->fail(host, SPH_E_UNKNOWN, "breeding needs the extension sph.population/0");
    if (host->register_item(host, SPH_KIND_FUNCTION, &function) != SPH_OK ||
        host->register_item(host, SPH_KIND_FUNCTION, &heed_function) != SPH_OK)
        return SPH_E_INVALID;
    return extension->declare(host, "breed", &population);
}

SPH_PLUGIN("breeding", "1.0", "BSD-3-Clause", "makes particles and takes them away", init, NULL)
