/* sweep_gsph.c -- what the sweeps of gsph cost, in doubles and in floats, in turn. */
#include "sweep_gsph.h"
#include "bench.h"

#include <math.h>

enum { SWEEPS = 3 };
static const char *const gsph[SWEEPS] = {"gsph-density", "gsph-gradients", "gsph-rates"};

/* A gas: pressures near 1, the speed of sound that goes with them. */
static void make_gas(struct engine *g)
{
    double *p = particles_real(&g->p, "p", 0), *cs = particles_real(&g->p, "cs", 0);
    const double *rho = particles_real(&g->p, "rho", 0);

    for (size_t i = 0; i < g->p.n; i++) {
        p[i] = 1.0 + 0.1 * p[i];
        cs[i] = sqrt(5.0 / 3.0 * p[i] / rho[i]);
    }
}

/* h is taken to differ from particle to particle, as it does in a run. */
void sweep_gsph(struct registry *r, const struct pair_case *fluid, const struct machine *m, int n)
{
    static double cpu[SWEEPS][2][ROUNDS_MOST];
    struct engine g;
    struct engine_use use[SWEEPS];

    engine_make(&g, r, fluid, "wendland-c2");
    make_gas(&g);
    for (int i = 0; i < SWEEPS; i++)
        engine_use_make(&use[i], &g, gsph[i]);
    for (int k = -1; k < n; k++) {
        for (int i = 0; i < SWEEPS; i++) {
            for (int real = 0; real < 2; real++) {
                const struct engine_sweep s = {
                    .use = {&use[i]}, .real = real ? SPH_F32 : SPH_F64, .skin = 1, .threads = 1};
                const struct engine_time t = engine_run(&g, &s);
                cpu[i][real][k < 0 ? 0 : k] = t.cpu;
            }
            if (k < 0 && i == 1) { /* what the rates read: gradients as they should be */
                engine_finish(&g, &use[i]);
                engine_mirror(&g);
            }
        }
    }
    printf(
        "\n%dD, gsph   ns/pair: double   mixed   gain   us/part: double    mixed   GB/s: double  "
        "bw %%   mixed  bw %%\n",
        g.p.dim);
    for (int i = 0; i < SWEEPS; i++) {
        double t[2], gigabytes[2];
        for (int real = 0; real < 2; real++) {
            const struct engine_sweep s = {
                .use = {&use[i]}, .real = real ? SPH_F32 : SPH_F64, .skin = 1};
            t[real] = bench_median(cpu[i][real], (size_t)n);
            gigabytes[real] = 1e-9 * engine_bytes(&g, &s) * (double)g.p.n / t[real];
        }
        const double per = m->read_bw > 0.0 ? 100.0 / m->read_bw : 0.0;
        printf("  %-18s %8.2f %7.2f %6.2f %17.4f %8.4f %14.2f %5.1f %7.2f %5.1f\n", gsph[i],
               1e9 * t[0] / g.pairs, 1e9 * t[1] / g.pairs, t[0] / t[1], 1e6 * t[0] / (double)g.p.n,
               1e6 * t[1] / (double)g.p.n, gigabytes[0], per * gigabytes[0], gigabytes[1],
               per * gigabytes[1]);
    }
    for (int i = 0; i < SWEEPS; i++)
        engine_use_free(&use[i]);
    engine_free(&g);
}
