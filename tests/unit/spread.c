/* spread.c -- see spread.h. */
#include "spread.h"

#include "spread.macros.h"

enum { M, SHARE, GUESS, TOTAL, FLOW, LEAST, MOST, STRESS, CALLS };
enum { KIND, HEAVIEST };

static const sph_param params[] = {
    SPH_PARAM_CHOICE("kind", "adds 1 to the guess", 1.0, "bare|more"),
    SPH_PARAM("heaviest", "", "largest mass", 1e300, 0.0, 1e300),
};

static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, 0.0),
    SPH_PROP("share", "", "what sources give", SPH_SCALAR, SPH_SRC_READ | SPH_DST_WRITE, 0.5),
    SPH_PROP("guess", "", "what destinations add", SPH_SCALAR, SPH_DST_UPDATE | SPH_SRC_READ, 0.25),
    SPH_PROP("total", "", "sum", SPH_SCALAR, SPH_DST_SUM, 0.75),
    SPH_PROP("flow", "", "sum", SPH_VECTOR, SPH_DST_SUM, -0.5),
    SPH_PROP("least", "", "minimum", SPH_SCALAR, SPH_DST_MIN, 1e300),
    SPH_PROP("most", "", "maximum", SPH_SCALAR, SPH_DST_MAX, -1e300),
    SPH_PROP("stress", "", "products", SPH_SYM, SPH_DST_WRITE, 0.0),
    SPH_PROP("calls", "", "how often", SPH_INT32, SPH_DST_UPDATE, 3.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) S(guess, GUESS)
#define SPH_LOOP_J(S, V_, M_) S(m, M) S(share, SHARE) S(guess, GUESS)
#define SPH_LOOP_SUM(S, V_, M_) S(total, TOTAL) V_(flow, FLOW)
#define SPH_LOOP_MIN(S) S(least, LEAST)
#define SPH_LOOP_MAX(S) S(most, MOST)
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "spread.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_ANY_KERNEL
#define SPH_LOOP_DEVICE spread_device
#define SPH_LOOP_PRELUDE "spread.macros.h"
#include <sph/pair-loop.h>

#define SPH_POINT_LOOP before
#define SPH_POINT_INOUT(P) P(scalar, guess, GUESS)
#define SPH_POINT_PARAM(P) P(kind, KIND)
#define SPH_POINT_STATE(P) P(tick, 1)
#define SPH_POINT_BODY "spread_before.body.h"
#define SPH_POINT_DEVICE spread_before
#define SPH_POINT_PRELUDE "spread.macros.h"
#include <sph/point-loop.h>

#define SPH_POINT_LOOP after
#define SPH_POINT_IN(P) P(scalar, m, M) P(scalar, total, TOTAL) P(vector, flow, FLOW)
#define SPH_POINT_OUT(P) P(scalar, share, SHARE) P(sym, stress, STRESS)
#define SPH_POINT_INOUT(P) P(int32, calls, CALLS)
#define SPH_POINT_PARAM(P) P(heaviest, HEAVIEST)
#define SPH_POINT_H
#define SPH_POINT_FAIL "nothing", "a particle is too heavy"
#define SPH_POINT_BODY "spread_after.body.h"
#define SPH_POINT_DEVICE spread_after
#define SPH_POINT_PRELUDE "spread.macros.h"
#include <sph/point-loop.h>

static sph_status create(const sph_host *host, const sph_config *config, uint32_t dim, void **state)
{
    static double numbers[2];

    (void)host;
    (void)config;
    (void)dim;
    numbers[0] = -1.0;
    numbers[1] = 0.0;
    *state = numbers;
    return SPH_OK;
}

static void destroy(const sph_host *host, void *state)
{
    (void)host;
    (void)state;
}

static sph_status prepare(const sph_batch *b)
{
    ((double *)b->state)[1] = 7.0 + (double)b->step;
    return SPH_OK;
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "spread",
    .doc = "all that a pass may have",
    .source = "",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};
static const sph_life life = {
    .size = (uint32_t)sizeof(sph_life), .create = create, .destroy = destroy};

static const sph_function function = {
    .size = (uint32_t)sizeof(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .life = &life,
    .before = before,
    .run = sweep,
    .after = after,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .prepare = prepare,
    .device = &spread_device,
    .device_before = &spread_before,
    .device_after = &spread_after,
    .reals = SPH_F64 | SPH_F32,
};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &function);
}

const sph_plugin *spread_entry(void)
{
    static const sph_plugin plugin = {(uint32_t)sizeof(sph_plugin),
                                      SPH_PLUGIN_MAGIC,
                                      SPH_ABI_MAJOR,
                                      SPH_ABI_MINOR,
                                      "spread",
                                      "1.0",
                                      "none",
                                      "the function of a test",
                                      init,
                                      NULL};
    return &plugin;
}
