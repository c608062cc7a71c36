/* border.c -- what the border of the ABI costs: one sweep over 4096 particles in three dimensions,
 * done by a plugin chunk by chunk as the core does it, and by the same loop within this program,
 * at one go.
 *   border PLUGIN.so         30 timings of each, interleaved: the mean difference, its interval
 *   border PLUGIN.so CHUNK   each once, with so many destinations a call
 * Fails if the two sides' numbers differ in a bit. */
#include "border_inside.h"
#include "neighbours/neighbours.h"
#include "registry/registry.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    COLUMNS = 6, /* of the plugin: m, rho, p, v, drho, a */
    SIDE = 16,
    N = SIDE * SIDE * SIDE,
    PLANE = N + 2 * (int)SPH_LANES,
    CHUNK = 512, /* destinations a call, as in run/passes.c */
    TIMINGS = 30,
    PASSES = 3 /* a timing */
};
#define STUDENT 2.04523 /* t of 29 degrees of freedom, 95 % */

struct fluid {
    double x[3 * PLANE], h[PLANE], m[PLANE], rho[PLANE], p[PLANE], v[3 * PLANE];
    double out[4 * PLANE]; /* drho, a */
    double inside[4 * PLANE];
};

static double random_unit(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* A disturbed lattice in the unit cube with 74 neighbours each, sorted by cells. */
static int fill(struct fluid *f, struct cloud *cloud, struct error *e)
{
    static double x[3 * PLANE];
    static uint32_t order[N];
    const double dx = 1.0 / SIDE;
    uint64_t seed = 1;

    for (int i = 0; i < N; i++) {
        x[i] = (i % SIDE + 0.3 * random_unit(&seed)) * dx;
        x[PLANE + i] = (i / SIDE % SIDE + 0.3 * random_unit(&seed)) * dx;
        x[2 * PLANE + i] = (i / SIDE / SIDE + 0.3 * random_unit(&seed)) * dx;
    }
    for (int i = 0; i < PLANE; i++) {
        f->h[i] = 1.3 * dx * (1.0 + 0.02 * random_unit(&seed));
        f->m[i] = dx * dx * dx;
        f->rho[i] = 1.0 + 0.01 * random_unit(&seed);
        f->p[i] = random_unit(&seed);
        for (int c = 0; c < 3; c++)
            f->v[c * PLANE + i] = random_unit(&seed) - 0.5;
    }
    *cloud = (struct cloud){
        .dim = 3, .n = N, .x = {x, x + PLANE, x + 2 * PLANE}, .h = f->h, .scale = 2.0};
    if (cell_order(cloud, NULL, 2.6 * dx, 1, order, e))
        return -1;
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < N; i++)
            f->x[c * PLANE + i] = x[c * PLANE + (int)order[i]];
        cloud->x[c] = f->x + c * PLANE;
    }
    return 0;
}

/* Wendland's C2 in three dimensions: (21 / 16 pi) (1 - q/2)^4 (2 q + 1), with t = 2 - q. */
static const sph_kernel_form kernel = {.size = (uint32_t)sizeof(sph_kernel_form),
                                       .dim = 3,
                                       .n_pieces = 1,
                                       .support = 2.0,
                                       .norm = 21.0 / (16.0 * 3.14159265358979324),
                                       .piece = {{.knot = 2.0,
                                                  .power = 4,
                                                  .n_coef = 2,
                                                  .dpower = 3,
                                                  .dn_coef = 2,
                                                  .c = {5.0 / 16.0, -2.0 / 16.0},
                                                  .d = {-20.0 / 16.0, 10.0 / 16.0}}}};

static sph_column column(double *data, uint32_t ncomp)
{
    return (sph_column){data, PLANE, ncomp > 1 ? SPH_VECTOR : SPH_SCALAR, ncomp};
}

/* The two that are measured. Not static, not inlined: callgrind knows them by name. */
sph_status measured_inside(const sph_batch *b);
sph_status measured_plugin(sph_range_fn run, const sph_batch *batch, uint64_t chunk);

__attribute__((noinline)) sph_status measured_inside(const sph_batch *b)
{
    return border_inside(b);
}

__attribute__((noinline)) sph_status measured_plugin(sph_range_fn run, const sph_batch *batch,
                                                     uint64_t chunk)
{
    sph_status worst = SPH_OK;

    for (uint64_t first = 0; first < batch->n_dst; first += chunk) {
        sph_batch b = *batch;
        b.first = first;
        b.count = b.n_dst - first < chunk ? b.n_dst - first : chunk;
        sph_status status = run(&b);
        if (status < worst)
            worst = status;
    }
    return worst;
}

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Seconds of the processor for so many passes on one side. */
static double timing(struct fluid *f, sph_range_fn run, const sph_batch *b, uint64_t chunk,
                     int passes)
{
    double begin;

    memset(f->out, 0, sizeof f->out);
    begin = now();
    for (int k = 0; k < passes; k++)
        if (run ? measured_plugin(run, b, chunk) : measured_inside(b))
            return NAN;
    return now() - begin;
}

static void compare_times(struct fluid *f, sph_range_fn run, const sph_batch *b)
{
    double inside = 0, sum = 0, squares = 0;

    for (int k = 0; k < TIMINGS; k++) {
        double t[2];
        for (int turn = 0; turn < 2; turn++) { /* each goes first as often as the other */
            int side = (k + turn) % 2;
            t[side] = timing(f, side ? run : NULL, b, CHUNK, PASSES) / PASSES;
        }
        inside += t[0] / TIMINGS;
        sum += t[1] - t[0];
        squares += (t[1] - t[0]) * (t[1] - t[0]);
    }
    double mean = sum / TIMINGS;
    double spread = sqrt((squares - TIMINGS * mean * mean) / (TIMINGS - 1));
    double interval = STUDENT * spread / sqrt(TIMINGS);
    printf("a pass inside: %.1f us; through the ABI: %+.2f us +- %.2f us (%+.2f %% +- %.2f %%), "
           "95 %% of %d paired timings: %s\n",
           1e6 * inside, 1e6 * mean, 1e6 * interval, 100 * mean / inside, 100 * interval / inside,
           TIMINGS, fabs(mean) <= interval ? "no difference" : "a difference");
}

static int measure(const struct registry *r, uint64_t chunk, int timed, struct error *e)
{
    static struct fluid fluid __attribute__((aligned(64)));
    struct fluid *f = &fluid;
    const struct entry *x = registry_find(r, KIND_FUNCTION, "sweep");
    sph_range_fn run = x ? entry_function(x)->run : NULL;
    struct group_list list = {0};
    struct cloud cloud;
    const double alpha = 0.1;

    if (!run || fill(f, &cloud, e) || group_list_make(&list, &cloud, &cloud, true, 0.1, NULL, 1, e))
        return -1;
    const sph_column dst[COLUMNS] = {column(f->m, 1), column(f->rho, 1), column(f->p, 1),
                                     column(f->v, 3), column(f->out, 1), column(f->out + PLANE, 3)};
    const sph_batch b = {.size = (uint32_t)sizeof(sph_batch),
                         .dim = 3,
                         .real = SPH_F64,
                         .lanes = SPH_LANES,
                         .count = N,
                         .n_dst = N,
                         .n_src = N,
                         .begin = list.begin,
                         .span = list.span,
                         .list = list.step,
                         .same = 1,
                         .x_dst = column(f->x, 3),
                         .x_src = column(f->x, 3),
                         .h_dst = column(f->h, 1),
                         .h_src = column(f->h, 1),
                         .dst = dst,
                         .src = dst,
                         .n_columns = COLUMNS,
                         .n_params = 1,
                         .param = &alpha,
                         .kernel = &kernel,
                         .host = &r->host};
    timing(f, NULL, &b, chunk, 1);
    memcpy(f->inside, f->out, sizeof f->out);
    timing(f, run, &b, chunk, 1);
    if (memcmp(f->inside, f->out, sizeof f->out) || f->out[N / 2] == 0 || isnan(f->out[N / 2]))
        return error_set(e, EXIT_RUN, "the two sides differ: %g, %g", f->inside[N / 2],
                         f->out[N / 2]);
    printf("%d particles, %.1f neighbours each, %.1f in a group's list\n", N,
           (double)group_list_count(&list, &cloud, &cloud, 1) / N,
           (double)group_list_entries(&list, 0, list.n_group) / (double)list.n_group);
    if (timed)
        compare_times(f, run, &b);
    group_list_fini(&list);
    return 0;
}

int main(int argc, char **argv)
{
    struct registry r;
    struct error e = {.exit_code = EXIT_RUN, .text = "usage: border PLUGIN.so [CHUNK]"};
    void *handle = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    sph_plugin_entry_fn entry;
    uint64_t chunk = argc > 2 ? strtoull(argv[2], NULL, 10) : CHUNK;
    int status;

    if (!handle || !chunk || registry_init(&r, &e)) {
        fprintf(stderr, "%s\n", e.text);
        return EXIT_USAGE;
    }
    *(void **)&entry = dlsym(handle, "sph_plugin_entry");
    status = registry_add(&r, argv[1], entry, NULL, NULL, &e) || measure(&r, chunk, argc == 2, &e);
    if (status)
        fprintf(stderr, "%s\n", e.text);
    registry_fini(&r);
    dlclose(handle);
    return status ? e.exit_code : 0;
}
