/* telling.c -- declares what ours do not: all that `sph info` can tell of a plugin. */
#include <math.h>
#include <sph/plugin.h>

static const sph_param params[] = {
    {.name = "speed", .unit = "m/s", .doc = "how fast", .def = 2, .min = 1, .max = 0},
    {.name = "path", .unit = "", .doc = "columns t and x", .def = 0, .type = SPH_PARAM_TABLE},
    {.name = "map", .unit = "", .doc = "columns a, b", .def = (double)NAN, .type = SPH_PARAM_TABLE},
};
static const sph_prop props[] = {
    {"gone", "", "not 0: away with it", SPH_INT32, SPH_DST_WRITE, 0},
    {"made", "", "copies", SPH_INT32, SPH_DST_WRITE | SPH_WORK, 0},
};
static const sph_item item = {
    (uint32_t)sizeof(sph_item), SPH_DIM2,       "tell", "removes and creates", "",
    SPH_LIST(params),           SPH_LIST(props)};

static sph_status run(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

static sph_status create(const sph_host *host, const sph_config *config, uint32_t dim, void **state)
{
    (void)host;
    (void)config;
    (void)dim;
    *state = NULL;
    return SPH_OK;
}

static void destroy(const sph_host *host, void *state)
{
    (void)host;
    (void)state;
}

static sph_status save(const sph_host *host, const void *state, const sph_writer *out)
{
    (void)host;
    (void)state;
    (void)out;
    return SPH_OK;
}

static sph_status restore(const sph_host *host, void *state, uint32_t format, const void *bytes,
                          uint64_t n)
{
    (void)host;
    (void)state;
    (void)format;
    (void)bytes;
    (void)n;
    return SPH_OK;
}

static const sph_life life = {(uint32_t)sizeof(sph_life), 0, create, destroy};
static const sph_function tell = {.size = (uint32_t)sizeof(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &item,
                                  .life = &life,
                                  .run = run};
static const sph_population population = {
    .size = (uint32_t)sizeof(sph_population), .remove = "gone", .create = "made"};
static const sph_state state = {(uint32_t)sizeof(sph_state), 7, save, restore};

static const sph_step steps[] = {
    {.at = SPH_AT_FINISH, .kind = SPH_KIND_FUNCTION, .name = "tell", .on = SPH_ON_BOUNDED},
    {.at = SPH_AT_EVALUATE, .kind = SPH_KIND_FUNCTION, .name = "tell", .after = "eos"},
    {.at = SPH_AT_EVALUATE, .kind = SPH_KIND_FUNCTION, .name = "tell", .before = "tell"},
};
static const sph_item gate_item = {
    (uint32_t)sizeof(sph_item), SPH_DIM2, "gate", "lets pass", "", SPH_NO_LIST, SPH_NO_LIST};
static const sph_boundary gate = {(uint32_t)sizeof(sph_boundary), 0, &gate_item, SPH_LIST(steps)};

static sph_status init(const sph_host *host)
{
    const sph_population_ext *p =
        (const sph_population_ext *)host->extension(host, SPH_EXT_POPULATION);
    const sph_state_ext *s = (const sph_state_ext *)host->extension(host, SPH_EXT_STATE);

    if (!p || !s)
        return SPH_E_UNKNOWN;
    if (host->register_item(host, SPH_KIND_FUNCTION, &tell) != SPH_OK ||
        p->declare(host, "tell", &population) != SPH_OK ||
        s->declare(host, SPH_KIND_FUNCTION, "tell", &state) != SPH_OK)
        return SPH_E_INVALID;
    return host->register_item(host, SPH_KIND_BOUNDARY, &gate);
}

SPH_PLUGIN("telling", "0.10.2-rc1", "BSD-3-Clause", "says a lot", init, NULL)
