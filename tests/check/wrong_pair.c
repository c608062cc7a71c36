/* wrong_pair.c -- pair functions, each with one fault, and one without. */
#include "../walk.h"
#include "wrong.h"

#include <math.h>

static const sph_prop props[] = {
    {"m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"sum", "kg", "mass nearby", SPH_SCALAR, SPH_DST_SUM, 0},
};
static const sph_prop own_props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN},
    {"sum", "kg/m^d", "density nearby", SPH_SCALAR, SPH_DST_SUM, 0},
};

#define FUNCTION(variable, name, list, sweep, last)                                                \
    ITEM(variable##_item, name, list);                                                             \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_PAIR,                                       \
                                          .item = &variable##_item,                                \
                                          .run = sweep,                                            \
                                          .after = last,                                           \
                                          .reach = SPH_GATHER,                                     \
                                          .reach_scale = 1}

static sph_status add_up(const sph_batch *b)
{
    const double *m = plane(&b->src[0]);

    EACH(i, b)
    for (struct walk w = walk_begin(b, i); walk_next(&w);) {
        double r2 = 0;
        for (uint32_t c = 0; c < b->dim; c++) {
            const double d = plane(&b->x_dst)[c * b->x_dst.plane + i] -
                             plane(&b->x_src)[c * b->x_src.plane + w.j];
            r2 += d * d;
        }
        if (r2 < 4 * plane(&b->h_dst)[i] * plane(&b->h_dst)[i])
            plane(&b->dst[1])[i] += m[w.j];
    }
    return SPH_OK;
}
FUNCTION(good, "right", props, add_up, NULL);

/* Reads the destination's mass, which it declares for the sources only. */
static sph_status own_mass(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] += plane(&b->dst[0])[i];
    return SPH_OK;
}
FUNCTION(own, "reads-own-mass", props, add_up, own_mass);

/* Reads the sources' density, which it declares for the destination only. */
static sph_status sources_density(const sph_batch *b)
{
    EACH(i, b)
    for (struct walk w = walk_begin(b, i); walk_next(&w);)
        plane(&b->dst[1])[i] += plane(&b->src[0])[w.j];
    return SPH_OK;
}
FUNCTION(sources, "reads-sources-density", own_props, sources_density, NULL);

/* Takes the list to end with a number that is not there. */
static sph_status list_end(const sph_batch *b)
{
    const uint64_t groups = (b->n_dst + SPH_LANES - 1) / SPH_LANES;
    volatile uint64_t next = b->begin[groups + 1];

    (void)next;
    return add_up(b);
}
FUNCTION(list, "reads-past-begin", props, list_end, NULL);

/* Divides by what it finds of others: nothing, where none is near. */
static sph_status share(const sph_batch *b)
{
    volatile int32_t others = 0, part;

    EACH(i, b)
    {
        others = others + (int32_t)(b->begin[i / SPH_LANES + 1] - b->begin[i / SPH_LANES]);
        plane(&b->dst[1])[i] += 1;
    }
    part = 100 / others;
    (void)part;
    return SPH_OK;
}
FUNCTION(divider, "divides-by-none", props, share, NULL);

/* What it leaves out of the sum depends on the pieces. */
static sph_status by_pieces(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] += i == b->first ? 1 : 2;
    return SPH_OK;
}
FUNCTION(pieces, "depends-on-pieces", props, by_pieces, NULL);

static sph_status init(const sph_host *host)
{
    static const sph_function *const all[] = {&good, &own, &sources, &list, &divider, &pieces};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("wrong-pair", "1.0", "BSD-3-Clause", "pair functions with a fault each", init, NULL)
