/* lanes.c -- what exp, log, pow and the reciprocal root cost on lanes, per instruction set and
 * precision, beside libm lane by lane. Prints ns per value (throughput: the least of many rounds
 * over arrays that stay in the first cache). Not a test. */
#include "../unit/lanes_sets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { N = 1024, ROUNDS = 400 };

static const char *const names[LANES_FUNCTIONS] = {"exp", "log", "pow", "sqrt", "rsqrt", "1/sqrt"};

static union {
    double d[N];
    float f[N];
} x, y, out;

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ns per value */
static double cost(void (*function)(const void *, const void *, void *, size_t))
{
    double best = INFINITY;

    for (int r = 0; r < ROUNDS; r++) {
        const double start = now();
        function(&x, &y, &out, N);
        best = fmin(best, now() - start);
    }
    return best / N * 1e9;
}

static void fill(bool f32)
{
    for (int i = 0; i < N; i++) {
        const double a = 0.01 + 0.013 * i, b = 0.3 + 0.002 * i;
        if (f32) {
            x.f[i] = (float)a;
            y.f[i] = (float)b;
        } else {
            x.d[i] = a;
            y.d[i] = b;
        }
    }
}

int main(void)
{
    const struct lanes_set *set;

    printf("%-18s", "ns per value");
    for (int k = 0; k < LANES_FUNCTIONS; k++)
        printf(k <= LANES_POW ? "%8s (libm %5s)" : "%9s", names[k], "x");
    printf("\n");
    for (size_t s = 0; (set = lanes_set(s)); s++) {
        printf("%-18s", set->name);
        fill(set->f32);
        for (int k = 0; k < LANES_FUNCTIONS; k++) {
            const double ns = cost(set->function[k]);
            if (k <= LANES_POW) {
                const double libm = cost(set->libm[k]);
                printf("%8.2f (%5.2f %4.1fx)", ns, libm, libm / ns);
            } else {
                printf("%9.2f", ns);
            }
        }
        printf("\n");
    }
    return EXIT_SUCCESS;
}
