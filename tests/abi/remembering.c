/* remembering.c -- a function with a state of its own: numbers drawn from a seed heat the particles, and now and
 * then one particle more is made. Whoever forgets the state, the order of the particles or the next id gets
 * other results. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)
#define EVERY 9 /* steps */

struct memory {
    uint64_t seed, calls;
};

enum { U, COPIES };
static const sph_prop props[] = {
    {"u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_UPDATE, (double)NAN},
    {"copies", "", "how many copies to make", SPH_INT32, SPH_DST_WRITE | SPH_WORK, 0},
};
static const sph_prop born_props[] = {
    {"x", "m", "position", SPH_VECTOR, SPH_DST_UPDATE, (double)NAN},
};

static sph_status prepare(const sph_batch *b)
{
    struct memory *m = b->state;
    m->seed = m->seed * 6364136223846793005u + 1442695040888963407u;
    m->calls++;
    return SPH_OK;
}

static sph_status run(const sph_batch *b)
{
    const struct memory *m = b->state;
    double *u = b->dst[U].data;
    int32_t *copies = b->dst[COPIES].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        u[i] *= 1 + 1e-4 * (double)(m->seed >> 40) / 16777216.0;
        copies[i] = i == 7 && m->calls % EVERY == 0;
    }
    return SPH_OK;
}

static sph_status born(const sph_batch *b)
{
    double *x = b->dst[0].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        x[i] += 1e-3;
    return SPH_OK;
}

static sph_status create(const sph_host *host, const sph_config *config, uint32_t dim, void **state)
{
    (void)host;
    (void)config;
    (void)dim;
    struct memory *m = calloc(1, sizeof *m);
    if (!m)
        return SPH_E_NOMEM;
    m->seed = 1;
    *state = m;
    return SPH_OK;
}

static void destroy(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}

static sph_status save(const sph_host *host, const void *state, const sph_writer *out)
{
    (void)host;
    return out->write(out, state, sizeof(struct memory));
}

static sph_status restore(const sph_host *host, void *state, uint32_t format, const void *bytes,
                          uint64_t n)
{
    if (format != 1 || n != sizeof(struct memory))
        return host->fail(host, SPH_E_ABI, "a memory of another format");
    memcpy(state, bytes, n);
    return SPH_OK;
}

static const sph_item item = {
    SIZE(sph_item), SPH_ALL_DIMS,   "remember", "heats, and makes particles", "",
    SPH_NO_LIST,    SPH_LIST(props)};
static const sph_life life = {SIZE(sph_life), 0, create, destroy};
static const sph_function function = {.size = SIZE(sph_function),
                                      .shape = SPH_POINT,
                                      .item = &item,
                                      .life = &life,
                                      .run = run,
                                      .reach_scale = 1,
                                      .prepare = prepare};
static const sph_population population = {.size = SIZE(sph_population),
                                          .create = "copies",
                                          .born = born,
                                          .born_props = SPH_LIST(born_props)};
static const sph_state state = {SIZE(sph_state), 1, save, restore};

static sph_status init(const sph_host *host)
{
    const sph_population_ext *p =
        (const sph_population_ext *)host->extension(host, SPH_EXT_POPULATION);
    const sph_state_ext *s = (const sph_state_ext *)host->extension(host, SPH_EXT_STATE);

    if (!p || !s)
        return SPH_E_UNKNOWN;
    if (host->register_item(host, SPH_KIND_FUNCTION, &function) != SPH_OK ||
        p->declare(host, "remember", &population) != SPH_OK)
        return SPH_E_INVALID;
    return s->declare(host, SPH_KIND_FUNCTION, "remember", &state);
}

SPH_PLUGIN("remembering", "1.0", "BSD-3-Clause", "has a state of its own", init, NULL)
