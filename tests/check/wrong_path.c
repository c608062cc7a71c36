/* wrong_path.c -- pair functions that say they take floats and know the ways to run: one that does,
 * and some with one fault each. */
#include "../walk.h"
#include "wrong.h"

#include <math.h>

static const sph_prop props[] = {
    {"m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"sum", "kg", "mass nearby", SPH_SCALAR, SPH_DST_SUM, 0},
};

#define FUNCTION(variable, name, sweep)                                                            \
    ITEM(variable##_item, name, props);                                                            \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_PAIR,                                       \
                                          .item = &variable##_item,                                \
                                          .run = sweep,                                            \
                                          .reach = SPH_GATHER,                                     \
                                          .reach_scale = 1,                                        \
                                          .reals = SPH_F64 | SPH_F32}

static double value(const sph_batch *b, const sph_column *column, uint64_t k)
{
    return b->real == SPH_F32 ? (double)((const float *)column->data)[k]
                              : ((const double *)column->data)[k];
}

static double step(const sph_batch *b, uint32_t c, uint64_t i, uint64_t j, int lost)
{
    const uint64_t d = c * b->x_dst.plane + i, s = c * b->x_src.plane + j;

    if (b->real == SPH_F64)
        return plane(&b->x_dst)[d] - plane(&b->x_src)[s];
    return b->quantum * ldexp((((const int32_t *)b->x_dst.data)[d] >> lost) -
                                  (((const int32_t *)b->x_src.data)[s] >> lost),
                              lost);
}

/* lost: bits of positions. */
static double near(const sph_batch *b, uint64_t i, int lost)
{
    double sum = 0;

    for (struct walk w = walk_begin(b, i); walk_next(&w);) {
        const double reach = 2 * value(b, &b->h_dst, i);
        double r2 = 0;
        for (uint32_t c = 0; c < b->dim; c++)
            r2 += step(b, c, i, w.j, lost) * step(b, c, i, w.j, lost);
        sum += value(b, &b->src[0], w.j) * fmax(0, 1 - r2 / (reach * reach));
    }
    return sum;
}

static void add(const sph_batch *b, uint64_t i, double sum)
{
    if (b->real == SPH_F32)
        ((float *)b->dst[1].data)[i] += (float)sum;
    else
        plane(&b->dst[1])[i] += sum;
}

static sph_status add_up(const sph_batch *b)
{
    EACH(i, b)
    add(b, i, near(b, i, 0));
    return SPH_OK;
}
FUNCTION(good, "right-in-both", add_up);

static sph_status rough(const sph_batch *b)
{
    EACH(i, b)
    add(b, i, near(b, i, 16));
    return SPH_OK;
}
FUNCTION(bits, "drops-bits", rough);

/* Takes floats for doubles. */
static sph_status doubles(const sph_batch *b)
{
    sph_batch other = *b;

    other.real = SPH_F64;
    return add_up(&other);
}
FUNCTION(deaf, "takes-floats-for-doubles", doubles);

static sph_status base(const sph_batch *b)
{
    EACH(i, b)
    add(b, i, near(b, i, 0) * (b->path == SPH_PATH_BASE ? 1 + 1e-12 : 1));
    return SPH_OK;
}
FUNCTION(other, "other-on-old-processors", base);

static sph_status refuses(const sph_batch *b)
{
    return b->real == SPH_F32 ? SPH_E_INVALID : add_up(b);
}
FUNCTION(refusing, "refuses-floats", refuses);

static sph_status by_pieces(const sph_batch *b)
{
    EACH(i, b)
    add(b, i, near(b, i, 0) * (b->real == SPH_F32 && i == b->first ? 1 + 1e-6 : 1));
    return SPH_OK;
}
FUNCTION(pieces, "depends-on-pieces-in-floats", by_pieces);

static sph_status init(const sph_host *host)
{
    static const sph_function *const all[] = {&good, &bits, &deaf, &other, &refusing, &pieces};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("wrong-path", "1.0", "BSD-3-Clause", "pair functions of many ways", init, NULL)
