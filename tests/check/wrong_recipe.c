/* wrong_recipe.c -- kernels given as functions, schemes and a state, right and wrong. */
#include "wrong.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* (1 - q^2)^4 in one dimension: its integral over -1 to 1 is 256/315. */
static double value(double q, uint32_t dim)
{
    (void)dim;
    return pow(1 - q * q, 4);
}
static double slope(double q, uint32_t dim)
{
    (void)dim;
    return -8 * q * pow(1 - q * q, 3);
}
/* (1 - q^2 / 2)^2, which is not 0 at the support. */
static double cut_value(double q, uint32_t dim)
{
    (void)dim;
    return (1 - q * q / 2) * (1 - q * q / 2);
}
static double cut_slope(double q, uint32_t dim)
{
    (void)dim;
    return -2 * q * (1 - q * q / 2);
}

#define KERNEL(variable, name_, norm_, value_, slope_)                                             \
    static const sph_item variable##_item = {.size = SIZE(sph_item),                               \
                                             .dims = SPH_DIM1,                                     \
                                             .name = name_,                                        \
                                             .doc = "a bell",                                      \
                                             .source = "nobody"};                                  \
    static const sph_kernel variable = {.size = SIZE(sph_kernel),                                  \
                                        .item = &variable##_item,                                  \
                                        .support = 1,                                              \
                                        .norm = {0, norm_, 0, 0},                                  \
                                        .value = value_,                                           \
                                        .slope = slope_}
KERNEL(bell, "bell", 315. / 256, value, slope);
KERNEL(cut_bell, "cut-bell", 30. / 43, cut_value, cut_slope);

static const sph_step steps[] = {
    {.at = SPH_AT_EVALUATE, .kind = SPH_KIND_FUNCTION, .name = "no-such-function"}};
static const sph_item lost_item = {.size = SIZE(sph_item),
                                   .dims = SPH_ALL_DIMS,
                                   .name = "lost",
                                   .doc = "a scheme whose parts are not there"};
static const sph_scheme lost = {.size = SIZE(sph_scheme),
                                .item = &lost_item,
                                .kernel = "no-such-kernel",
                                .integrator = "no-such-integrator",
                                .cfl = 0.3,
                                .steps = SPH_LIST(steps)};

/* A number that grows with each pass, saved or not. */
static const sph_prop props[] = {
    {"seen", "", "a number", SPH_SCALAR, SPH_DST_WRITE, 0},
};
static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    (void)host;
    (void)c;
    (void)dim;
    *state = calloc(1, sizeof(double));
    return *state ? SPH_OK : SPH_E_NOMEM;
}
static void destroy(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}
static sph_status prepare(const sph_batch *b)
{
    *(double *)b->state += 1;
    return SPH_OK;
}
static sph_status run(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[0])[i] = *(const double *)b->state;
    return SPH_OK;
}
static sph_status save(const sph_host *host, const void *state, const sph_writer *out)
{
    (void)host;
    return out->write(out, state, sizeof(double));
}
static sph_status restore(const sph_host *host, void *state, uint32_t format, const void *bytes,
                          uint64_t n)
{
    if (format != 3 || n != sizeof(double))
        return host->fail(host, SPH_E_ABI, "this state is not mine");
    memcpy(state, bytes, sizeof(double));
    return SPH_OK;
}
static sph_status forget(const sph_host *host, void *state, uint32_t format, const void *bytes,
                         uint64_t n)
{
    (void)state;
    (void)bytes;
    return format == 3 && n ? SPH_OK : host->fail(host, SPH_E_ABI, "this state is not mine");
}
static sph_status take_any(const sph_host *host, void *state, uint32_t format, const void *bytes,
                           uint64_t n)
{
    (void)host;
    (void)format;
    memcpy(state, bytes, n < sizeof(double) ? (size_t)n : sizeof(double));
    return SPH_OK;
}
static const sph_life life = {SIZE(sph_life), 0, create, destroy};
#define STATE(variable, name, restore_)                                                            \
    ITEM(variable##_item, name, props);                                                            \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_POINT,                                      \
                                          .item = &variable##_item,                                \
                                          .life = &life,                                           \
                                          .run = run,                                              \
                                          .reach_scale = 1,                                        \
                                          .prepare = prepare};                                     \
    static const sph_state variable##_state = {SIZE(sph_state), 3, save, restore_}
STATE(good, "remembers", restore);
STATE(forgetful, "forgets", forget);
STATE(any, "takes-any-format", take_any);

static sph_status add(const sph_host *host, const sph_function *f, const sph_state *state)
{
    const sph_state_ext *ext = (const sph_state_ext *)host->extension(host, SPH_EXT_STATE);
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, f);

    if (status != SPH_OK || !ext)
        return status != SPH_OK ? status : host->fail(host, SPH_E_UNKNOWN, "no states here");
    return ext->declare(host, SPH_KIND_FUNCTION, f->item->name, state);
}

/* Splits nobody, but could. */
static const sph_prop split_props[] = {
    {"split", "", "copies to be made", SPH_INT32, SPH_DST_WRITE, 0},
};
static const sph_prop born_props[] = {
    {"split", "", "which copy", SPH_INT32, SPH_DST_READ, 0},
    {"m", "kg", "mass", SPH_SCALAR, SPH_DST_UPDATE, NAN},
};
static sph_status split_run(const sph_batch *b)
{
    EACH(i, b)
    ((int32_t *)b->dst[0].data)[i] = 0;
    return SPH_OK;
}
static sph_status born(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] /= 1 + ((const int32_t *)b->dst[0].data)[i];
    return SPH_OK;
}
static sph_status born_wrongly(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] = sqrt(0.5 - ((const int32_t *)b->dst[0].data)[i]);
    return SPH_OK;
}
#define SPLIT(variable, name, born_)                                                               \
    ITEM(variable##_item, name, split_props);                                                      \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_POINT,                                      \
                                          .item = &variable##_item,                                \
                                          .run = split_run,                                        \
                                          .reach_scale = 1};                                       \
    static const sph_population variable##_population = {.size = SIZE(sph_population),             \
                                                         .create = "split",                        \
                                                         .born = born_,                            \
                                                         .born_props = SPH_LIST(born_props)}
SPLIT(splits, "splits", born);
SPLIT(splits_wrongly, "splits-wrongly", born_wrongly);

static sph_status add_population(const sph_host *host, const sph_function *f,
                                 const sph_population *p)
{
    const sph_population_ext *ext =
        (const sph_population_ext *)host->extension(host, SPH_EXT_POPULATION);
    const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, f);

    if (status != SPH_OK || !ext)
        return status != SPH_OK ? status : host->fail(host, SPH_E_UNKNOWN, "no births here");
    return ext->declare(host, f->item->name, p);
}

static sph_status init(const sph_host *host)
{
    sph_status status = host->register_item(host, SPH_KIND_KERNEL, &bell);

    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_KERNEL, &cut_bell);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_SCHEME, &lost);
    if (status == SPH_OK)
        status = add(host, &good, &good_state);
    if (status == SPH_OK)
        status = add(host, &forgetful, &forgetful_state);
    if (status == SPH_OK)
        status = add(host, &any, &any_state);
    if (status == SPH_OK)
        status = add_population(host, &splits, &splits_population);
    if (status == SPH_OK)
        status = add_population(host, &splits_wrongly, &splits_wrongly_population);
    return status;
}

SPH_PLUGIN("wrong-recipe", "1.0", "BSD-3-Clause", "kernels, a scheme and states", init, NULL)
