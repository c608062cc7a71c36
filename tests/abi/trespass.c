/* trespass.c -- functions that do what they do not declare, for the audit. */
#include "../walk.h"
#include <sph/plugin.h>

#define SIZE(type) ((uint32_t)sizeof(type))

static double *plane(const sph_column *column)
{
    return column->data;
}

#define FUNCTION(variable, name, props, work)                                                      \
    static const sph_item variable##_item = {                                                      \
        SIZE(sph_item), SPH_ALL_DIMS, name, "a trespasser", "", SPH_NO_LIST, SPH_LIST(props)};     \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_POINT,                                      \
                                          .item = &variable##_item,                                \
                                          .run = work,                                             \
                                          .reach_scale = 1}

static const sph_prop reads_rho[] = {
    {"rho", "", "", SPH_SCALAR, SPH_DST_READ, 0},
    {"seen", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};

/* Writes what it declares that it reads. */
static sph_status write_read_only(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        plane(&b->dst[1])[i] = plane(&b->dst[0])[i];
        plane(&b->dst[0])[i] *= 2;
    }
    return SPH_OK;
}

FUNCTION(writer, "trespass-write", reads_rho, write_read_only);

/* Keeps a pointer to rho, which it may read ... */
static const double *volatile kept;

static sph_status keep(const sph_batch *b)
{
    kept = plane(&b->dst[0]);
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        plane(&b->dst[1])[i] = kept[i];
    return SPH_OK;
}

FUNCTION(keeper, "trespass-keep", reads_rho, keep);

/* ... and reads through it where it declares nothing of the kind. */
static const sph_prop only_seen[] = {
    {"seen", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};

static sph_status read_kept(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        plane(&b->dst[0])[i] = kept ? kept[i] : 0;
    return SPH_OK;
}

FUNCTION(reader, "trespass-read", only_seen, read_kept);

/* Leaves the seventh particle as it was. */
static sph_status leave_one(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        if (i != 7)
            plane(&b->dst[0])[i] = 1;
    return SPH_OK;
}

FUNCTION(leaver, "trespass-leave", only_seen, leave_one);

/* Writes far behind the last particle. */
static sph_status overrun(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        plane(&b->dst[0])[i] = 1;
    /* On and on: past the column's end stands a page that nobody may touch. */
    for (uint64_t i = b->n_dst; i < b->n_dst + (1u << 20); i++)
        plane(&b->dst[0])[i] = 1;
    return SPH_OK;
}

FUNCTION(overrunner, "trespass-overrun", only_seen, overrun);

/* A pair function that writes its sources' mass in its `after`. */
static const sph_prop pair_props[] = {
    {"m", "", "", SPH_SCALAR, SPH_SRC_READ, 0},
    {"sum", "", "", SPH_SCALAR, SPH_DST_SUM, 0},
};

/* With a column that is NULL too: the audit is to tell of it, not a sanitizer. */
__attribute__((no_sanitize("undefined"))) static sph_status pair_run(const sph_batch *b)
{
    const double *m = plane(&b->src[0]);
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        for (struct walk w = walk_begin(b, i); walk_next(&w);)
            plane(&b->dst[1])[i] += m[w.j];
    return SPH_OK;
}

static sph_status pair_after(const sph_batch *b)
{
    double *m = b->dst[0].data;
    m[b->first] = 0;
    return SPH_OK;
}

static const sph_item pair_item = {SIZE(sph_item),      SPH_ALL_DIMS, "trespass-pair",
                                   "a trespasser",      "",           SPH_NO_LIST,
                                   SPH_LIST(pair_props)};
static const sph_function pair = {.size = SIZE(sph_function),
                                  .shape = SPH_PAIR,
                                  .item = &pair_item,
                                  .run = pair_run,
                                  .after = pair_after,
                                  .reach = SPH_GATHER,
                                  .reach_scale = 1};

/* A pair function that reads of its sources what it declares of destinations alone. */
static const sph_prop source_props[] = {
    {"m", "", "", SPH_SCALAR, SPH_DST_READ, 0},
    {"sum", "", "", SPH_SCALAR, SPH_DST_SUM, 0},
};
static const sph_item source_item = {SIZE(sph_item),        SPH_ALL_DIMS, "trespass-source",
                                     "a trespasser",        "",           SPH_NO_LIST,
                                     SPH_LIST(source_props)};
static const sph_function source = {.size = SIZE(sph_function),
                                    .shape = SPH_PAIR,
                                    .item = &source_item,
                                    .run = pair_run,
                                    .reach = SPH_GATHER,
                                    .reach_scale = 1};

static sph_status init(const sph_host *host)
{
    const sph_function *const all[] = {&writer,     &keeper, &reader, &leaver,
                                       &overrunner, &pair,   &source};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("trespass", "1.0", "BSD-3-Clause", "functions that do what they do not declare", init,
           NULL)
