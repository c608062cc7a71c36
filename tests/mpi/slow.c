/* slow.c -- a function that on rank 1 takes some microseconds a particle and does nothing: what pairs do not tell. */
#include <math.h>
#include <sph/plugin.h>
#include <stdlib.h>
#include <time.h>

#define SIZE(type) (uint32_t)sizeof(type)
#define NANOSECONDS 3000

static const sph_prop props[] = {
    SPH_PROP("id", "", "who it is", SPH_INT64, SPH_DST_READ, NAN),
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static sph_status run(const sph_batch *b)
{
    const char *rank = getenv("OMPI_COMM_WORLD_RANK");
    const double end = now() + (double)NANOSECONDS * (double)b->count;

    while (rank && rank[0] == '1' && now() < end) {
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "slow",
    .doc = "takes time on rank 1",
    .source = "slow.c",
    .props = SPH_LIST(props),
};
static const sph_function function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .reach_scale = 1,
};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_FUNCTION, &function);
}

SPH_PLUGIN("slow", "1.0", "BSD-3-Clause", "takes time", init, NULL)
