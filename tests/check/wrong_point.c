/* wrong_point.c -- point functions, each with one fault. */
#include "wrong.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const sph_prop props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN},
    {"seen", "kg/m^d", "what was found", SPH_SCALAR, SPH_DST_WRITE, 0},
};

#define FUNCTION(variable, name)                                                                   \
    ITEM(variable##_item, name, props);                                                            \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_POINT,                                      \
                                          .item = &variable##_item,                                \
                                          .run = variable##_run,                                   \
                                          .reach_scale = 1}

static sph_status copy(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] = plane(&b->dst[0])[i];
    return SPH_OK;
}

/* Writes what it only reads. */
static sph_status read_only_run(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[0])[i] = plane(&b->dst[1])[i] = 1;
    return SPH_OK;
}
FUNCTION(read_only, "writes-read-only");

/* Keeps a pointer ... */
static const double *volatile kept;
static sph_status keeper_run(const sph_batch *b)
{
    kept = plane(&b->dst[0]);
    return copy(b);
}
FUNCTION(keeper, "keeps");

/* ... and reads what it has not been given. */
static sph_status undeclared_run(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] = kept ? kept[i] : plane(&b->dst[0])[i];
    return SPH_OK;
}
FUNCTION(undeclared, "reads-undeclared");

/* Takes a column that it has not declared: there is no third one. */
static sph_status third_run(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] = plane(&b->dst[2])[i];
    return SPH_OK;
}
FUNCTION(third, "takes-third-column");

/* Writes one destination too many. */
static sph_status too_far_run(const sph_batch *b)
{
    copy(b);
    if (b->count)
        plane(&b->dst[1])[b->first + b->count] = 7;
    return SPH_OK;
}
FUNCTION(too_far, "writes-past-range");

/* Does all particles at each call. */
static sph_status everybody_run(const sph_batch *b)
{
    for (uint64_t i = 0; i < b->n_dst; i++)
        plane(&b->dst[1])[i] = plane(&b->dst[0])[i];
    return SPH_OK;
}
FUNCTION(everybody, "ignores-range");

/* Writes far behind the column. */
static sph_status overrun_run(const sph_batch *b)
{
    copy(b);
    for (uint64_t i = b->n_dst; i < b->n_dst + (1u << 16); i++)
        plane(&b->dst[1])[i] = 1;
    return SPH_OK;
}
FUNCTION(overrun, "overruns");

static sph_status leaver_run(const sph_batch *b)
{
    EACH(i, b)
    if (i != 5)
        plane(&b->dst[1])[i] = 1;
    return SPH_OK;
}
FUNCTION(leaver, "leaves-unset");

/* Counts its calls. */
static sph_status counter_run(const sph_batch *b)
{
    static double calls;

    calls++;
    EACH(i, b)
    plane(&b->dst[1])[i] = calls;
    return SPH_OK;
}
FUNCTION(counter, "counts-calls");

/* Its scratch is everybody's. */
static sph_status scratch_run(const sph_batch *b)
{
    static volatile double scratch;

    EACH(i, b)
    {
        scratch = plane(&b->dst[0])[i];
        for (volatile int k = 0; k < 1000; k++)
            continue;
        plane(&b->dst[1])[i] = scratch;
    }
    return SPH_OK;
}
FUNCTION(scratch, "shares-scratch");

/* A share of each particle, where there may be none. */
static sph_status last_run(const sph_batch *b)
{
    volatile int n = (int)b->n_dst;
    volatile int share = 100 / n;

    (void)share;
    return copy(b);
}
FUNCTION(last, "crashes-on-none");

static sph_status not_a_number_run(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[1])[i] = sqrt(0.5 - plane(&b->dst[0])[i]);
    return SPH_OK;
}
FUNCTION(not_a_number, "gives-nan");

static sph_status rounding_run(const sph_batch *b)
{
    fesetround(FE_UPWARD);
    return copy(b);
}
FUNCTION(rounding, "changes-rounding");

static sph_status leaves_run(const sph_batch *b)
{
    (void)b;
    exit(0);
}
FUNCTION(leaves, "exits");

static sph_status aborts_run(const sph_batch *b)
{
    (void)b;
    abort();
}
FUNCTION(aborts, "aborts");

static sph_status prints_run(const sph_batch *b)
{
    if (b->count == 7)
        puts("seven");
    return copy(b);
}
FUNCTION(prints, "prints");

static sph_status fails_run(const sph_batch *b)
{
    return b->host->fail(b->host, SPH_E_NUMERIC, "no luck today");
}
FUNCTION(fails, "fails");

/* A use that is not given back. */
static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    (void)host;
    (void)c;
    (void)dim;
    *state = malloc(100);
    return *state ? SPH_OK : SPH_E_NOMEM;
}
static void destroy(const sph_host *host, void *state)
{
    (void)host;
    (void)state;
}
static const sph_life life = {SIZE(sph_life), 0, create, destroy};
ITEM(leak_item, "leaks", props);
static const sph_function leak = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &leak_item,
                                  .life = &life,
                                  .run = copy,
                                  .reach_scale = 1};

static sph_status init(const sph_host *host)
{
    static const sph_function *const all[] = {
        &read_only, &keeper, &undeclared, &third,   &too_far, &everybody,
        &overrun,   &leaver, &counter,    &scratch, &last,    &not_a_number,
        &rounding,  &leaves, &aborts,     &prints,  &fails,   &leak};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("wrong-point", "1.0", "BSD-3-Clause", "point functions with a fault each", init, NULL)
