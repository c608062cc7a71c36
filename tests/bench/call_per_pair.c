/* call_per_pair.c -- what a pair costs with a call for each, with the body in the loop, and with both
 * when particles lie in memory without order. 250 047 particles in 3D, 250 000 in 2D, as a disturbed
 * lattice with h = 1.3 spacings, in cell order; one thread.
 *   call_per_pair [SIDE_3D SIDE_2D [PLUGIN.so]] */
#include "bench.h"
#include "fluid.h"
#include "machine.h"
#include "pair_plugin.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { REPEATS = 5, FLOPS = 46 /* of a pair in 3D, roots and divisions as one */ };

/* rms difference of accelerations and density rates, relative; particle k of b was was[k] of a. */
static double difference(const struct pair_rates *a, const struct pair_rates *b, uint32_t n,
                         const uint32_t *was)
{
    double worst = 0.0;

    for (int c = 0; c < 4; c++) {
        const double *of_a = c < 3 ? a->a[c] : a->drho, *of_b = c < 3 ? b->a[c] : b->drho;
        double square = 0.0, size = 0.0;
        for (uint32_t k = 0; k < n; k++) {
            const double value = of_a[was ? was[k] : k];
            square += (of_b[k] - value) * (of_b[k] - value);
            size += value * value;
        }
        if (size > 0.0 && sqrt(square / size) > worst)
            worst = sqrt(square / size);
    }
    return worst;
}

/* All four in turn, several times; returns 1 if their numbers differ. */
static int measure(int dim, int side, const struct pair_plugin *plugin,
                   const struct machine *machine)
{
    static const char *const name[] = {"a call for each pair", "the body in the loop",
                                       "a call, no order", "in the loop, no order"};
    struct fluid f;
    const uint32_t *was;
    double seconds[4][REPEATS];

    fluid_fill(&f, dim, side);
    struct pair_case *shuffled = bench_need(pair_shuffle(&f.c, 7, &was));
    struct pair_rates reference = fluid_rates(f.c.n), other = fluid_rates(f.c.n);
    const double pairs = (double)pair_count(&f.c);
    double worst = 0.0;
    for (int k = 0; k < REPEATS; k++) {
        seconds[0][k] = pair_sweep_called(&f.c, &reference, plugin->pair[dim], plugin->kernel[dim]);
        seconds[1][k] = pair_sweep_inlined(&f.c, &other);
        worst = fmax(worst, difference(&reference, &other, f.c.n, NULL));
        seconds[2][k] = pair_sweep_called(shuffled, &other, plugin->pair[dim], plugin->kernel[dim]);
        worst = fmax(worst, difference(&reference, &other, f.c.n, was));
        seconds[3][k] = pair_sweep_inlined(shuffled, &other);
        worst = fmax(worst, difference(&reference, &other, f.c.n, was));
    }
    printf("%dD, %u particles, %.2f neighbours    ns/pair  us/particle  beside the first", dim,
           f.c.n, pairs / f.c.n);
    printf(dim == 3 ? "  share of the FMA peak\n" : "\n");
    double first = 0.0;
    for (int k = 0; k < 4; k++) {
        const double median = bench_median(seconds[k], REPEATS);
        first = k == 0 ? median : first;
        printf("  %-38s %7.2f %12.3f %17.2f", name[k], 1e9 * median / pairs, 1e6 * median / f.c.n,
               median / first);
        if (dim == 3 && machine->fma_f64 > 0.0)
            printf("%21.1f %%", 1e-7 * FLOPS * pairs / median / machine->fma_f64);
        printf("\n");
    }
    printf("  they differ by %.1e (rms, relative)\n", worst);
    pair_shuffle_free(shuffled);
    fluid_rates_free(&reference);
    fluid_rates_free(&other);
    fluid_free(&f);
    return !(worst < 1e-11);
}

int main(int argc, char **argv)
{
    struct pair_plugin plugin;
    struct machine machine;

    pair_plugin_open(&plugin, argc > 3 ? argv[3] : NULL);
    machine_measure(&machine, 1);
    int failed = measure(3, argc > 1 ? atoi(argv[1]) : 63, &plugin, &machine);
    failed |= measure(2, argc > 2 ? atoi(argv[2]) : 500, &plugin, &machine);
    pair_plugin_close(&plugin);
    if (failed)
        printf("the numbers differ\n");
    return failed;
}
