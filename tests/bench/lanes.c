/* lanes.c -- what exp, log, pow and the reciprocal root cost on lanes, per instruction set and
 * precision, beside libm lane by lane. Prints ns per value (throughput: the least of many rounds
 * over arrays that stay in the first cache). Not a test. */
#include "lanes_sets.h"

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

/* libm, a value at a time, as pow_where of a body without these functions would. */
static double libm_value(int k, double a, double b)
{
    return k == LANES_EXP ? exp(a) : k == LANES_LOG ? log(a) : k == LANES_POW ? pow(a, b) : 0;
}

static float libm_float(int k, float a, float b)
{
    return k == LANES_EXP ? expf(a) : k == LANES_LOG ? logf(a) : k == LANES_POW ? powf(a, b) : 0;
}

static void libm_over(int k, bool f32)
{
    if (f32)
        for (int i = 0; i < N; i++)
            out.f[i] = libm_float(k, x.f[i], y.f[i]);
    else
        for (int i = 0; i < N; i++)
            out.d[i] = libm_value(k, x.d[i], y.d[i]);
}

/* ns per value; set NULL: libm */
static double cost(const struct lanes_set *set, int k, bool f32)
{
    double best = INFINITY;

    for (int r = 0; r < ROUNDS; r++) {
        const double start = now();
        if (set)
            set->function[k](&x, &y, &out, N);
        else
            libm_over(k, f32);
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
        printf("%16s", names[k]);
    printf("\n");
    for (int f32 = 0; f32 < 2; f32++) {
        double libm[LANES_FUNCTIONS] = {0};
        fill(f32);
        printf("%-18s", f32 ? "libm, float" : "libm, double");
        for (int k = 0; k <= LANES_POW; k++) {
            libm[k] = cost(NULL, k, f32);
            printf("%16.2f", libm[k]);
        }
        printf("\n");
        for (size_t s = 0; (set = lanes_set(s)); s++) {
            if (set->f32 != f32)
                continue;
            printf("%-18s", set->name);
            for (int k = 0; k < LANES_FUNCTIONS; k++) {
                const double ns = cost(set, k, f32);
                if (k <= LANES_POW)
                    printf("%8.2f (%4.1fx)", ns, libm[k] / ns);
                else
                    printf("%16.2f", ns);
            }
            printf("\n");
        }
    }
    return EXIT_SUCCESS;
}
