/* plugin.c -- one of every kind, for growth.py, which compiles it with the headers of two versions
 * of the ABI: 1.0, and 1.1, which defines SPH_GROWN and where each struct that may grow has a last
 * member `double added`. */
#include <sph/plugin.h>

#define SIZE(type) ((uint32_t)sizeof(type))

/* What this plugin says in the members that are new in 1.1, and what it makes of the host's. */
#if defined SPH_GROWN
#define ADD(number) .added = (number)
#if defined RECKLESS
#define ADDED(p) ((p)->added)
#else
#define ADDED(p) (SPH_HAS(p, added) ? (p)->added : 0.0)
#endif
#else
#define ADD(number) .reserved = 0
#define ADDED(p) (0.0)
#endif
/* Where 1.0 has no reserved member to name in its stead. */
#if defined SPH_GROWN
#define AND_ADD(number) , .added = (number)
#else
#define AND_ADD(number)
#endif

static double added_of_host;

static sph_status twice_run(const sph_batch *b)
{
    const double *x = b->dst[0].data;
    double *y = b->dst[1].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        y[i] = 2.0 * x[i] + ADDED(b) + added_of_host + ADDED(b->kernel);
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

static const sph_param params[] = {
    {.name = "one", .def = 1.0, .max = 2.0, ADD(1)},
    {.name = "two", .def = 2.0, .max = 2.0, ADD(2)},
};
static const sph_prop props[] = {
    {.name = "x0", .type = SPH_SCALAR, .access = SPH_DST_READ AND_ADD(3)},
    {.name = "y0", .type = SPH_SCALAR, .access = SPH_DST_WRITE AND_ADD(4)},
    {.name = "flag", .type = SPH_INT32, .access = SPH_DST_WRITE AND_ADD(5)},
};
static const sph_prop inverse_props[] = {
    {.name = "y0", .type = SPH_SCALAR, .access = SPH_DST_READ AND_ADD(18)},
    {.name = "x0", .type = SPH_SCALAR, .access = SPH_DST_WRITE AND_ADD(19)},
};
static const sph_rate rates[] = {{"x0", "y0", SPH_KICK, ADD(6)}};
static const sph_reduction reductions[] = {
    {.name = "least", .property = "y0", .op = SPH_REDUCE_MIN AND_ADD(7)}};
static const sph_step steps[] = {
    {.at = SPH_AT_EVALUATE, .kind = SPH_KIND_FUNCTION, .name = "twice", ADD(8)},
    {.at = SPH_AT_FINISH, .kind = SPH_KIND_FUNCTION, .name = "twice", ADD(9)},
};
/* W = 3/2 (1 - q)^2 in 1D. */
static const sph_kernel_term terms[] = {{.coef = 1.0, .knot = 1.0, .power = 2, ADD(10)}};
static const sph_life life = {
    .size = SIZE(sph_life), .create = create, .destroy = destroy, ADD(11)};

#define ITEM(variable, word, number, props_list, params_list)                                      \
    static const sph_item variable = {.size = SIZE(sph_item),                                      \
                                      .dims = SPH_DIM1,                                            \
                                      .name = word,                                                \
                                      .doc = "one of a kind",                                      \
                                      .params = params_list,                                       \
                                      .props = props_list AND_ADD(number)}
ITEM(twice_item, "twice", 12, SPH_LIST(props), SPH_LIST(params));
ITEM(eos_item, "eos", 13, SPH_LIST(props), SPH_LIST(params));
ITEM(exact_item, "exact", 14, SPH_LIST(props), SPH_LIST(params));
ITEM(kernel_item, "kernel", 15, SPH_NO_LIST, SPH_NO_LIST);
ITEM(scheme_item, "scheme", 16, SPH_NO_LIST, SPH_NO_LIST);
ITEM(wall_item, "wall", 17, SPH_NO_LIST, SPH_NO_LIST);

static const sph_function twice = {.size = SIZE(sph_function),
                                   .shape = SPH_POINT,
                                   .item = &twice_item,
                                   .life = &life,
                                   .run = twice_run,
                                   .rates = SPH_LIST(rates),
                                   .reductions = SPH_LIST(reductions) AND_ADD(21)};
/* A pair function, for its body as a device has it. */
static const sph_device_value values[] = {
    {.name = "x0", .index = 0, .type = SPH_SCALAR AND_ADD(31)},
    {.name = "y0", .index = 1, .type = SPH_SCALAR AND_ADD(32)},
};
static const sph_device_body body = {.size = SIZE(sph_device_body),
                                     .reach = SPH_GATHER,
                                     .text = "sph_add(y0, x0_i);",
                                     .file = "plugin.c",
                                     .i = {values, 1, SIZE(sph_device_value)},
                                     .sum = {&values[1], 1, SIZE(sph_device_value)} AND_ADD(33)};
static const sph_prop pair_props[] = {
    {.name = "x0", .type = SPH_SCALAR, .access = SPH_DST_READ AND_ADD(34)},
    {.name = "y0", .type = SPH_SCALAR, .access = SPH_DST_SUM AND_ADD(35)},
};
ITEM(pairs_item, "pairs", 36, SPH_LIST(pair_props), SPH_NO_LIST);
static const sph_function pairs = {.size = SIZE(sph_function),
                                   .shape = SPH_PAIR,
                                   .item = &pairs_item,
                                   .life = &life,
                                   .run = twice_run,
                                   .reach = SPH_GATHER,
                                   .device = &body AND_ADD(37)};
static const sph_eos eos = {.size = SIZE(sph_eos),
                            .item = &eos_item,
                            .run = twice_run,
                            .inverse = twice_run,
                            .inverse_props = SPH_LIST(inverse_props),
                            ADD(22)};
static const sph_exact exact = {
    .size = SIZE(sph_exact), .item = &exact_item, .run = twice_run, ADD(23)};
static const sph_kernel kernel = {.size = SIZE(sph_kernel),
                                  .item = &kernel_item,
                                  .support = 1.0,
                                  .norm = {0.0, 1.5, 0.0, 0.0},
                                  .terms = {SPH_NO_LIST, SPH_LIST(terms), SPH_NO_LIST, SPH_NO_LIST},
                                  ADD(24)};
static const sph_scheme scheme = {.size = SIZE(sph_scheme),
                                  .item = &scheme_item,
                                  .kernel = "kernel",
                                  .integrator = "kdk",
                                  .cfl = 0.3,
                                  .steps = SPH_LIST(steps),
                                  .rates = SPH_LIST(rates),
                                  ADD(25)};
static const sph_boundary wall = {
    .size = SIZE(sph_boundary), .item = &wall_item, .steps = SPH_LIST(steps), ADD(26)};
static const sph_population population = {.size = SIZE(sph_population), .remove = "flag", ADD(27)};
static const sph_state state = {
    .size = SIZE(sph_state), .format = 1, .save = save, .restore = restore AND_ADD(28)};

static sph_status declare(const sph_host *host)
{
    const sph_population_ext *p = host->extension(host, SPH_EXT_POPULATION);
    const sph_state_ext *s = host->extension(host, SPH_EXT_STATE);
    if (!p || !s)
        return host->fail(host, SPH_E_UNKNOWN, "the host lacks an extension");
    if (p->declare(host, "twice", &population))
        return SPH_E_INVALID;
    return s->declare(host, SPH_KIND_FUNCTION, "twice", &state);
}

static sph_status init(const sph_host *host)
{
    static const struct {
        const char *kind;
        const void *descriptor;
    } all[] = {{SPH_KIND_FUNCTION, &twice}, {SPH_KIND_FUNCTION, &pairs}, {SPH_KIND_EOS, &eos},
               {SPH_KIND_EXACT, &exact},    {SPH_KIND_KERNEL, &kernel},  {SPH_KIND_SCHEME, &scheme},
               {SPH_KIND_BOUNDARY, &wall}};
    added_of_host = ADDED(host);
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
        if (host->register_item(host, all[i].kind, all[i].descriptor))
            return SPH_E_INVALID;
    return declare(host);
}

#if defined SPH_GROWN
SPH_EXPORT const sph_plugin *sph_plugin_entry(void)
{
    static const sph_plugin plugin = {.size = SIZE(sph_plugin),
                                      .magic = SPH_PLUGIN_MAGIC,
                                      .abi_major = SPH_ABI_MAJOR,
                                      .abi_minor = SPH_ABI_WANTED_MINOR,
                                      .name = "grown",
                                      .version = "1.1",
                                      .init = init,
                                      .added = 29};
    return &plugin;
}
#else
SPH_PLUGIN("grown", "1.0", "", "", init, NULL)
#endif
