/* sweep.c -- what a sweep over the neighbours costs: the designs that the engine is measured against, the
 * engine in all its forms, and the sweeps of gsph; on 250 047 particles in 3D and 250 000 in 2D. All take
 * their turn in every round, and medians are shown: what else the machine does meanwhile meets all alike.
 * One thread, its own processor time, where nothing else is said; wall time with two. Whatever the figures
 * are, it ends with 0: the last lines hold them against bars.
 *   sweep [SIDE_3D SIDE_2D [ROUNDS]] */
#include "bench.h"
#include "fluid.h"
#include "machine.h"
#include "pair_plugin.h"
#include "sweep_gsph.h"

#include <math.h>

enum { CHUNK = 512 /* destinations a call, as in core/run */ };

/* Useful operations of a pair of wcsph-rates, roots and divisions as one; each dimension has eight. */
static int flops(int dim)
{
    return 46 - 8 * (3 - dim);
}

enum design_kind { CALLED, INLINED, ENGINE, ENGINE_PARTS };

struct design {
    enum design_kind kind;
    int shuffled; /* no engine */
    uint32_t real, path, uniform_h;
    int skin; /* 1: 0.1 */
    uint64_t chunk;
    int threads;
};

/* The engine as the core runs it. */
#define AS_RUN(real, threads) ENGINE, 0, real, SPH_PATH_BEST, 1, 1, CHUNK, threads
#define OF(real, path, uniform, skin)                                                              \
    {                                                                                              \
        ENGINE, 0, real, path, uniform, skin, 0, 1                                                 \
    }
#define ALL_OF(real)                                                                               \
    OF(real, SPH_PATH_BEST, 1, 0), OF(real, SPH_PATH_BEST, 0, 0), OF(real, SPH_PATH_BEST, 1, 1),   \
        OF(real, SPH_PATH_BEST, 0, 1), OF(real, SPH_PATH_AVX512, 1, 1),                            \
        OF(real, SPH_PATH_AVX2, 1, 1), OF(real, SPH_PATH_AVX2, 0, 1),                              \
        OF(real, SPH_PATH_BASE, 1, 1), OF(real, SPH_PATH_BASE, 0, 1),                              \
        OF(real, SPH_PATH_BEST + SPH_PATH_ANY_KERNEL, 0, 1),                                       \
        {ENGINE_PARTS, 0, real, SPH_PATH_BEST, 0, 1, 0, 1}, {AS_RUN(real, 1)},                     \
    {                                                                                              \
        AS_RUN(real, 2)                                                                            \
    }
static const struct design designs[] = {
    {CALLED, 0, SPH_F64, 0, 0, 0, 0, 1},
    {INLINED, 0, SPH_F64, 0, 0, 0, 0, 1},
    {CALLED, 1, SPH_F64, 0, 0, 0, 0, 1},
    {INLINED, 1, SPH_F64, 0, 0, 0, 0, 1},
    OF(SPH_F64, SPH_PATH_REFERENCE, 0, 1),
    ALL_OF(SPH_F64),
    ALL_OF(SPH_F32),
};
enum { DESIGNS = (int)(sizeof(designs) / sizeof(designs[0])), REFERENCE_PATH = 4 };

/* Of one dimension. */
struct bench {
    struct fluid fluid;
    struct pair_case *shuffled;
    struct pair_rates rates;
    struct engine engine;
    struct engine_use whole, part[2];
    double *exact; /* accelerations in long double, dim columns of n */
    double cpu[DESIGNS][ROUNDS_MOST], wall[DESIGNS][ROUNDS_MOST], error[DESIGNS];
    double seconds[DESIGNS]; /* the median */
};

/* How much faster: of the medians, and of the quickest times, which company disturbs least. */
struct ratio {
    double median, best;
};

/* What the acceptance looks at: doubles, then mixed. */
struct figures {
    struct ratio even[2], call[2], threads[2]; /* even: lists without a skin, as the call's are */
    double list, error;
};

static const char *path_word(const struct design *d)
{
    static const char *const word[] = {"best", "reference", "extended", "base", "avx2", "avx512"};

    return d->path >= SPH_PATH_ANY_KERNEL ? "any kernel" : word[d->path];
}

static struct engine_sweep sweep_of(const struct bench *b, const struct design *d)
{
    struct engine_sweep s = {.real = d->real,
                             .path = d->path,
                             .uniform_h = d->uniform_h,
                             .skin = d->skin,
                             .chunk = d->chunk,
                             .threads = d->threads};

    s.use[0] = d->kind == ENGINE ? &b->whole : &b->part[0];
    s.use[1] = d->kind == ENGINE ? NULL : &b->part[1];
    return s;
}

/* -- Right or not ------------------------------------------------------------------------------- */

/* Accelerations in long double, of the places that the particles have now. */
static void find_exact(struct bench *b)
{
    const struct engine *g = &b->engine;
    const struct engine_sweep s = {.use = {&b->whole},
                                   .path = SPH_PATH_EXTENDED,
                                   .threads = 2,
                                   .real = SPH_F64,
                                   .skin = 1,
                                   .chunk = CHUNK};
    const int a = particles_find(&g->p, "a");

    engine_run(g, &s);
    for (uint32_t c = 0; c < (uint32_t)g->p.dim; c++) {
        for (size_t i = 0; i < g->p.n; i++)
            b->exact[c * g->p.n + i] = engine_value(g, a, SPH_F64, c, i);
    }
}

/* rms, relative, of the accelerations that stand in the columns now. */
static double error_of(const struct bench *b, uint32_t real)
{
    const struct engine *g = &b->engine;
    const int a = particles_find(&g->p, "a");
    double square = 0.0, size = 0.0;

    for (uint32_t c = 0; c < (uint32_t)g->p.dim; c++) {
        for (size_t i = 0; i < g->p.n; i++) {
            const double exact = b->exact[c * g->p.n + i];
            const double difference = engine_value(g, a, real, c, i) - exact;
            square += difference * difference;
            size += exact * exact;
        }
    }
    return sqrt(square / size);
}

/* The rate of the density is the same formula in all designs: do they sum over the same pairs? */
static double rates_differ(const struct bench *b)
{
    const struct engine *g = &b->engine;
    const int drho = particles_find(&g->p, "drho");
    double square = 0.0, size = 0.0;

    for (size_t i = 0; i < g->p.n; i++) {
        const double exact = engine_value(g, drho, SPH_F64, 0, i);
        const double difference = b->rates.drho[g->was[i]] - exact;
        square += difference * difference;
        size += exact * exact;
    }
    return sqrt(square / size);
}

/* -- Rounds ------------------------------------------------------------------------------------- */

static struct engine_time turn(struct bench *b, const struct pair_plugin *plugin,
                               const struct design *d)
{
    const struct pair_case *c = d->shuffled ? b->shuffled : &b->fluid.c;
    double t;

    if (d->kind >= ENGINE) {
        const struct engine_sweep s = sweep_of(b, d);
        /* A run's threads come from the sweep before: on a virtual machine a processor that has been
         * idle takes milliseconds to come back. */
        if (d->chunk)
            engine_run(&b->engine, &s);
        return engine_run(&b->engine, &s);
    }
    if (d->kind == CALLED)
        t = pair_sweep_called(c, &b->rates, plugin->pair[c->dim], plugin->kernel[c->dim]);
    else
        t = pair_sweep_inlined(c, &b->rates);
    return (struct engine_time){t, t};
}

static void rounds(struct bench *b, const struct pair_plugin *plugin, int n)
{
    for (int k = -1; k < n; k++) { /* the first is not counted: code and memory are new to it */
        for (int i = 0; i < DESIGNS; i++) {
            const struct design *d = &designs[i];
            if (k < 0 && d->kind < ENGINE)
                continue;
            const struct engine_time t = turn(b, plugin, d);
            if (k < 0) {
                b->error[i] = error_of(b, d->real);
                continue;
            }
            b->cpu[i][k] = t.cpu;
            b->wall[i][k] = t.wall;
        }
    }
    for (int i = 0; i < DESIGNS; i++)
        b->seconds[i] = bench_median(designs[i].threads > 1 ? b->wall[i] : b->cpu[i], (size_t)n);
}

/* -- Tables ------------------------------------------------------------------------------------- */

static void name_of(const struct design *d, char *out, size_t size)
{
    static const char *const name[] = {"call for each pair", "inlined, scalar", "engine",
                                       "engine, two sweeps"};
    const char *real = d->real == SPH_F64 ? "double" : "mixed";

    if (d->kind < ENGINE)
        snprintf(out, size, "%s%s", name[d->kind], d->shuffled ? ", shuffled" : "");
    else
        snprintf(out, size, "%s, %s, %s%s%s%s%s", name[d->kind], real, path_word(d),
                 d->uniform_h ? ", one h" : "", d->skin ? "" : ", no skin",
                 d->chunk ? ", chunks" : "", d->threads > 1 ? ", 2 threads" : "");
}

/* Bytes a particle, at least: each column and the list once. */
static double bytes_of(const struct bench *b, const struct design *d)
{
    const struct pair_case *c = &b->fluid.c;

    if (d->kind < ENGINE) /* x, v, m, rho, p, h; p / rho^2 twice; out; list */
        return 8.0 * (2 * c->dim + 4 + 2 + c->dim + 1 + 1) + 4.0 * (double)c->first[c->n] / c->n;
    const struct engine_sweep s = sweep_of(b, d);
    return engine_bytes(&b->engine, &s);
}

static double list_of(const struct bench *b, const struct design *d)
{
    const struct pair_case *c = &b->fluid.c;

    return d->kind < ENGINE ? 8.0 + 4.0 * (double)c->first[c->n] / c->n
                            : (double)group_list_bytes(&b->engine.list[1][d->skin]) / c->n;
}

static double fma_of(const struct machine *m, const struct design *d)
{
    if (d->threads > 1)
        return d->real == SPH_F64 ? m->fma_f64_all : m->fma_f32_all;
    return d->real == SPH_F64 ? m->fma_f64 : m->fma_f32;
}

static double bandwidth_of(const struct machine *m, const struct design *d)
{
    return d->threads > 1 ? m->read_bw_all : m->read_bw;
}

static void row(const struct bench *b, const struct machine *m, int i)
{
    const struct design *d = &designs[i];
    const double pairs = b->engine.pairs, n = b->fluid.c.n, t = b->seconds[i];
    const double gigabytes = 1e-9 * bytes_of(b, d) * n / t, bandwidth = bandwidth_of(m, d);
    const double gigaflops = 1e-9 * flops(b->fluid.c.dim) * pairs / t;
    char name[80];

    name_of(d, name, sizeof(name));
    printf("  %-46s %7.2f %8.4f %7.1f %6.2f %6.2f %6.1f %6.2f %5.1f %7.1f", name, 1e9 * t / pairs,
           1e6 * t / n, 1e-6 * pairs / t, b->seconds[0] / t, b->seconds[REFERENCE_PATH] / t,
           100.0 * gigaflops / fma_of(m, d), gigabytes,
           bandwidth > 0.0 ? 100.0 * gigabytes / bandwidth : 0.0, list_of(b, d));
    if (d->kind < ENGINE)
        printf("       -\n");
    else
        printf(" %7.1e\n", b->error[i]);
}

/* Steps of eight lanes through a list: two sources that take turns are one. */
static double steps_of(const struct group_list *list)
{
    uint64_t steps = 0;

    for (size_t s = 0; s < list->n_span; s++)
        steps += (uint64_t)(list->span[s].count + list->span[s].common) / 2;
    return (double)steps;
}

static void table(const struct bench *b, const struct machine *m)
{
    const struct engine *g = &b->engine;
    const double n = b->fluid.c.n;

    printf("\n%dD: %.0f particles, %.2f true neighbours; %d operations a pair\n", g->p.dim, n,
           g->pairs / n, flops(g->p.dim));
    for (int skin = 0; skin < 2; skin++) {
        const struct group_list *list = &g->list[1][skin];
        const double steps = steps_of(list);
        printf(
            "  %s skin %.1f sources listed for a group, met in %.1f steps: %.0f %% of the lanes are "
            "true pairs\n",
            skin ? "with the" : "without", (double)list->n_entry * SPH_LANES / n,
            steps * SPH_LANES / n, 100.0 * g->pairs / (steps * SPH_LANES));
    }
    printf("  %-46s %7s %8s %7s %6s %6s %6s %6s %5s %7s %7s\n", "", "ns/pair", "us/part", "Mpair/s",
           "/call", "/ref", "FMA %", "GB/s", "bw %", "list B", "error");
    for (int i = 0; i < DESIGNS; i++)
        row(b, m, i);
}

static int same(const struct design *a, const struct design *b)
{
    return a->kind == b->kind && a->real == b->real && a->path == b->path &&
           a->uniform_h == b->uniform_h && a->skin == b->skin && a->chunk == b->chunk &&
           a->threads == b->threads;
}

/* The place of one of the designs. */
static int find(struct design d)
{
    int i = 0;

    while (i < DESIGNS - 1 && !same(&designs[i], &d))
        i++;
    return i;
}

/* What fusion and forms of the loop are worth, of one precision. */
static void gains(const struct bench *b, uint32_t real)
{
    const double *t = b->seconds;
    const int best = find((struct design)OF(real, SPH_PATH_BEST, 1, 1));
    const int several = find((struct design)OF(real, SPH_PATH_BEST, 0, 1));
    const int any = find((struct design)OF(real, SPH_PATH_BEST + SPH_PATH_ANY_KERNEL, 0, 1));
    const int parts = find((struct design){ENGINE_PARTS, 0, real, SPH_PATH_BEST, 0, 1, 0, 1});
    const int close = find((struct design)OF(real, SPH_PATH_BEST, 1, 0));
    const int chunks = find((struct design){AS_RUN(real, 1)});

    printf("  %s: two sweeps cost %.2f of the fused one, %.2f of it with no kernel compiled in (as "
           "they have none)\n    worth: the kernel compiled in %.2f, one h for all %.2f; the skin "
           "costs %+.1f %%, chunks %+.1f %%\n",
           real == SPH_F64 ? "double" : "mixed", t[parts] / t[several], t[parts] / t[any],
           t[any] / t[several], t[several] / t[best], 100.0 * (t[best] / t[close] - 1.0),
           100.0 * (t[chunks] / t[best] - 1.0));
}

/* The positions far away from the origin: nothing may get worse. */
static void offsets(struct bench *b, struct figures *worst)
{
    static const double offset[] = {0.0, 16.0, 100.0};

    printf("  error, the box so many box lengths away:");
    for (size_t k = 0; k < sizeof(offset) / sizeof(offset[0]); k++) {
        struct engine_sweep s = {.use = {&b->whole},
                                 .uniform_h = 1,
                                 .skin = 1,
                                 .threads = 2,
                                 .chunk = CHUNK,
                                 .path = SPH_PATH_BEST,
                                 .real = SPH_F64};
        engine_place(&b->engine, offset[k]);
        find_exact(b);
        engine_run(&b->engine, &s);
        const double in_double = error_of(b, SPH_F64);
        s.real = SPH_F32;
        engine_run(&b->engine, &s);
        const double mixed = error_of(b, SPH_F32);
        printf("  %g: double %.1e, mixed %.2e%s", offset[k], in_double, mixed, k < 2 ? ";" : "\n");
        worst->error = fmax(worst->error, mixed);
    }
    engine_place(&b->engine, 0.0);
}

/* -- All ---------------------------------------------------------------------------------------- */

/* Of so many times each; sorts them. */
static struct ratio ratio(double *slow, double *fast, int n)
{
    const struct ratio out = {bench_median(slow, (size_t)n) / bench_median(fast, (size_t)n),
                              slow[0] / fast[0]};
    return out;
}

static void ratios(struct bench *b, int n, struct figures *out)
{
    for (int k = 0; k < 2; k++) {
        const uint32_t real = k ? SPH_F32 : SPH_F64;
        const int one = find((struct design){AS_RUN(real, 1)});
        const int two = find((struct design){AS_RUN(real, 2)});
        const int close = find((struct design)OF(real, SPH_PATH_BEST, 1, 0));
        out->even[k] = ratio(b->cpu[0], b->cpu[close], n);
        out->call[k] = ratio(b->cpu[0], b->cpu[one], n);
        out->threads[k] = ratio(b->wall[one], b->wall[two], n);
    }
}

static void measure(int dim, int side, struct registry *r, const struct pair_plugin *plugin,
                    const struct machine *m, int n, struct figures *out)
{
    static struct bench b;
    const uint32_t *was;

    fluid_fill(&b.fluid, dim, side);
    b.shuffled = bench_need(pair_shuffle(&b.fluid.c, 7, &was));
    b.rates = fluid_rates(b.fluid.c.n);
    engine_make(&b.engine, r, &b.fluid.c, "wendland-c2");
    engine_use_make(&b.whole, &b.engine, "wcsph-rates");
    engine_use_make(&b.part[0], &b.engine, "wcsph-continuity");
    engine_use_make(&b.part[1], &b.engine, "wcsph-momentum");
    engine_mirror(&b.engine);
    b.exact = bench_need(malloc((size_t)dim * b.fluid.c.n * sizeof(*b.exact)));
    find_exact(&b);
    turn(&b, plugin, &designs[0]);
    const double differ = rates_differ(&b);
    rounds(&b, plugin, n);
    table(&b, m);
    gains(&b, SPH_F64);
    gains(&b, SPH_F32);
    printf(
        "  a call for each pair and the engine in long double: rates of the density %.1e apart%s, "
        "%s pairs\n",
        differ, differ < 1e-12 ? "" : " MISS",
        (double)pair_count(&b.fluid.c) == b.engine.pairs ? "the same" : "MISS other");
    *out = (struct figures){.list = list_of(&b, &designs[DESIGNS - 1])};
    ratios(&b, n, out);
    offsets(&b, out);
    sweep_gsph(r, &b.fluid.c, m, n);
    engine_use_free(&b.whole);
    engine_use_free(&b.part[0]);
    engine_use_free(&b.part[1]);
    engine_free(&b.engine);
    pair_shuffle_free(b.shuffled);
    fluid_rates_free(&b.rates);
    fluid_free(&b.fluid);
    free(b.exact);
}

static void bar(const char *what, double value, int at_least, double limit)
{
    const int good = at_least ? value >= limit : value <= limit;

    printf("%-4s %-52s %9.3g  (%s %g)\n", good ? "OK" : "MISS", what, value,
           at_least ? ">=" : "<=", limit);
}

/* known: what it has come to where it misses, if that is known. */
static void bar_of(const char *what, struct ratio r, double limit, const char *known)
{
    printf("%-4s %-52s %9.3g  (>= %g); of the quickest times %.3g%s%s\n",
           r.median >= limit ? "OK" : "MISS", what, r.median, limit, r.best,
           known ? "; known: " : "", known ? known : "");
}

static void bars(const struct figures *f3, const struct figures *f2)
{
    printf(
        "\nBest path, one h. The call for each pair has lists of true pairs alone, without a skin; the "
        "engine in\nthe first two likewise, in the others as the core runs it: a skin of 0.1 (a run in "
        "2D: 0.15), chunks of %d\n",
        CHUNK);
    bar_of("3D, double: a call for each pair takes as much more", f3->even[0], 6.5, NULL);
    bar_of("3D, mixed: likewise", f3->even[1], 9.0, NULL);
    bar_of("3D, double: likewise, with the skin", f3->call[0], 6.5, "5.9 to 7.1");
    bar_of("3D, mixed: likewise, with the skin", f3->call[1], 9.0, NULL);
    bar_of("3D, double: two threads, wall time", f3->threads[0], 1.85, NULL);
    bar_of("3D, mixed: two threads, wall time", f3->threads[1], 1.85, "1.7 to 2.0");
    bar_of("2D, double: two threads, wall time", f2->threads[0], 1.85, "1.5 to 1.9");
    bar_of("2D, mixed: two threads, wall time", f2->threads[1], 1.85, "1.4 to 2.0");
    bar("3D: bytes of the list a particle", f3->list, 0, 120.0);
    bar("3D, mixed: error of accelerations, worst offset", f3->error, 0, 1e-6);
    bar("2D, mixed: error of accelerations, worst offset", f2->error, 0, 1e-6);
}

int main(int argc, char **argv)
{
    const int n = argc > 3 ? atoi(argv[3]) : 5;
    struct pair_plugin plugin;
    struct registry registry;
    struct machine machine;
    struct figures figures[2];
    struct error e;

    if (n < 1 || n > ROUNDS_MOST || registry_init(&registry, &e)) {
        fprintf(stderr, "usage: sweep [SIDE_3D SIDE_2D [ROUNDS]]\n");
        return 1;
    }
    pair_plugin_open(&plugin, NULL);
    engine_load(&registry, "kernels");
    engine_load(&registry, "wcsph");
    engine_load(&registry, "gsph");
    machine_measure(&machine, 2);
    printf("%.2f GHz; FMA %.1f GF/s double, %.1f float; reads %.1f GB/s (two threads: %.1f, %.1f; "
           "%.1f)\n",
           machine.clock, machine.fma_f64, machine.fma_f32, machine.read_bw, machine.fma_f64_all,
           machine.fma_f32_all, machine.read_bw_all);
    printf(
        "/call, /ref: so much faster than a call for each pair, than the engine's plain loop. FMA "
        "%%: useful\noperations a second, of the peak. error: rms, relative, of the accelerations "
        "in long double.\n");
    measure(3, argc > 1 ? atoi(argv[1]) : 63, &registry, &plugin, &machine, n, &figures[0]);
    measure(2, argc > 2 ? atoi(argv[2]) : 500, &registry, &plugin, &machine, n, &figures[1]);
    bars(&figures[0], &figures[1]);
    registry_fini(&registry);
    pair_plugin_close(&plugin);
    return 0;
}
