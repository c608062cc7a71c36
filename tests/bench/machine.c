/* machine.c -- measures and prints what this machine can do. */
#include "machine_parts.h"

#include <omp.h>
#include <stdio.h>
#include <time.h>

static double seconds(clockid_t clock)
{
    struct timespec t;

    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double machine_cpu_time(void)
{
    return seconds(CLOCK_THREAD_CPUTIME_ID);
}

double machine_wall_time(void)
{
    return seconds(CLOCK_MONOTONIC);
}

int machine_bits(int width)
{
    return 128 << width;
}

void machine_measure(struct machine *m, int threads)
{
    *m = (struct machine){.threads = threads > 0 ? threads : omp_get_max_threads()};
    machine_core(m);
    machine_memory(m);
}

static void print_rates(const struct machine *m)
{
    printf("fused multiply-adds, GF/s: double          float\n");
    printf("  threads              %8d %8d %8d %8d\n", 1, m->threads, 1, m->threads);
    for (int k = 0; k < MACHINE_WIDTHS; k++) {
        const struct machine_width *w = &m->width[k];
        if (w->fma_f64 > 0.0)
            printf("  %d bits             %8.1f %8.1f %8.1f %8.1f\n", machine_bits(k), w->fma_f64,
                   w->fma_f64_all, w->fma_f32, w->fma_f32_all);
    }
}

static void print_costs(const struct machine *m)
{
    printf("ns (cycles) a vector:      double                          float\n");
    printf("                           square root     division        square root     division\n");
    for (int k = 0; k < MACHINE_WIDTHS; k++) {
        const struct machine_width *w = &m->width[k];
        const double cost[] = {w->sqrt_f64, w->div_f64, w->sqrt_f32, w->div_f32};
        if (w->fma_f64 <= 0.0)
            continue;
        printf("  %d bits               ", machine_bits(k));
        for (int c = 0; c < 4; c++)
            printf("  %5.2f (%5.1f) ", cost[c], cost[c] * m->clock);
        printf("\n");
    }
}

void machine_print(const struct machine *m)
{
    printf("clock                  %8.2f GHz\n", m->clock);
    if (m->fma_f64 > 0.0) {
        print_rates(m);
        print_costs(m);
    } else {
        printf("arithmetic: not measured on this kind of processor\n");
    }
    printf("memory, GB/s               read           triad\n");
    printf("  threads              %8d %8d %8d %8d\n", 1, m->threads, 1, m->threads);
    printf("                       %8.1f %8.1f %8.1f %8.1f\n", m->read_bw, m->read_bw_all,
           m->triad_bw, m->triad_bw_all);
}
