/* machine_core.c -- rates of the arithmetic, for each vector width that the processor has. */
#include "machine_parts.h"

struct constants {
    double start, a, b;
};

typedef double (*loop_fn)(long n, const struct constants *c);

struct loop {
    loop_fn run;
    int lanes; /* 0: not for this machine */
};

enum { OP_FMA, OP_SQRT, OP_DIV, OPS };
enum { F64, F32, TYPES };

#ifdef __x86_64__
#include <immintrin.h>

#define LOOP_NAME(op) op##_f64_128
#define LOOP_TARGET __attribute__((target("avx2,fma")))
#define LOOP_REAL double
#define LOOP_VECTOR __m128d
#define LOOP_SET _mm_set1_pd
#define LOOP_FMA _mm_fmadd_pd
#define LOOP_SQRT _mm_sqrt_pd
#include "machine_loops.h"

#define LOOP_NAME(op) op##_f32_128
#define LOOP_TARGET __attribute__((target("avx2,fma")))
#define LOOP_REAL float
#define LOOP_VECTOR __m128
#define LOOP_SET _mm_set1_ps
#define LOOP_FMA _mm_fmadd_ps
#define LOOP_SQRT _mm_sqrt_ps
#include "machine_loops.h"

#define LOOP_NAME(op) op##_f64_256
#define LOOP_TARGET __attribute__((target("avx2,fma")))
#define LOOP_REAL double
#define LOOP_VECTOR __m256d
#define LOOP_SET _mm256_set1_pd
#define LOOP_FMA _mm256_fmadd_pd
#define LOOP_SQRT _mm256_sqrt_pd
#include "machine_loops.h"

#define LOOP_NAME(op) op##_f32_256
#define LOOP_TARGET __attribute__((target("avx2,fma")))
#define LOOP_REAL float
#define LOOP_VECTOR __m256
#define LOOP_SET _mm256_set1_ps
#define LOOP_FMA _mm256_fmadd_ps
#define LOOP_SQRT _mm256_sqrt_ps
#include "machine_loops.h"

#define LOOP_NAME(op) op##_f64_512
#define LOOP_TARGET __attribute__((target("avx512f")))
#define LOOP_REAL double
#define LOOP_VECTOR __m512d
#define LOOP_SET _mm512_set1_pd
#define LOOP_FMA _mm512_fmadd_pd
#define LOOP_SQRT _mm512_sqrt_pd
#include "machine_loops.h"

#define LOOP_NAME(op) op##_f32_512
#define LOOP_TARGET __attribute__((target("avx512f")))
#define LOOP_REAL float
#define LOOP_VECTOR __m512
#define LOOP_SET _mm512_set1_ps
#define LOOP_FMA _mm512_fmadd_ps
#define LOOP_SQRT _mm512_sqrt_ps
#include "machine_loops.h"

#define LOOPS(bits)                                                                                \
    {                                                                                              \
        {{fma_f64_##bits, bits / 64}, {fma_f32_##bits, bits / 32}},                                \
            {{sqrt_f64_##bits, bits / 64}, {sqrt_f32_##bits, bits / 32}},                          \
            {{div_f64_##bits, bits / 64}, {div_f32_##bits, bits / 32}},                            \
    }

static struct loop find(int width, int op, int type)
{
    static const struct loop loops[MACHINE_WIDTHS][OPS][TYPES] = {LOOPS(128), LOOPS(256),
                                                                  LOOPS(512)};

    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") ||
        (width == MACHINE_512 && !__builtin_cpu_supports("avx512f")))
        return (struct loop){0};
    return loops[width][op][type];
}
#else
enum { CHAINS = 1 };

/* Another architecture: nothing is known of its vectors here. */
static struct loop find(int width, int op, int type)
{
    (void)width, (void)op, (void)type;
    return (struct loop){0};
}
#endif

static volatile double sink; /* of results nobody wants */
static volatile struct constants outside = {1.25, 0.99951, 0.73};

static struct constants constants(void)
{
    return (struct constants){outside.start, outside.a, outside.b};
}

/* Steps so many that they take about the wanted time [s]. */
static long steps(loop_fn run, double wanted)
{
    const struct constants c = constants();
    long n = 1000;

    for (;; n *= 2) {
        double t = machine_cpu_time();
        sink = run(n, &c);
        t = machine_cpu_time() - t;
        if (t > 0.1 * wanted)
            return (long)((double)n * wanted / t);
    }
}

/* Vectors a second of one thread. */
static double rate(struct loop l)
{
    const struct constants c = constants();
    double best = 0.0;

    if (!l.lanes)
        return 0.0;
    long n = steps(l.run, 0.003);
    for (int k = 0; k < MACHINE_REPEATS; k++) {
        double t = machine_cpu_time();
        sink = l.run(n, &c);
        t = machine_cpu_time() - t;
        if (t > 0.0 && (double)n * CHAINS / t > best)
            best = (double)n * CHAINS / t;
    }
    return best;
}

/* Vectors a second of all threads together, from the first one's start to the last one's end. Short
 * and often: on a machine that has other work, now and then all of them run at once. */
static double rate_all(struct loop l, int threads)
{
    const struct constants c = constants();
    double best = 0.0;

    if (!l.lanes)
        return 0.0;
    long n = steps(l.run, 0.002);
    for (int k = 0; k < 4 * MACHINE_REPEATS; k++) {
        double t = 0.0, sum = 0.0;
#pragma omp parallel num_threads(threads) reduction(+ : sum)
        {
#pragma omp barrier
#pragma omp master
            t = machine_wall_time();
            sum += l.run(n, &c);
        }
        t = machine_wall_time() - t;
        sink = sum;
        if (t > 0.0 && (double)n * CHAINS * threads / t > best)
            best = (double)n * CHAINS * threads / t;
    }
    return best;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static double nanoseconds(struct loop l)
{
    return l.lanes ? 1e9 / rate(l) : 0.0;
}

static void measure_width(struct machine *m, int width)
{
    struct machine_width *w = &m->width[width];
    const struct loop f64 = find(width, OP_FMA, F64), f32 = find(width, OP_FMA, F32);

    w->fma_f64 = 2e-9 * f64.lanes * rate(f64);
    w->fma_f32 = 2e-9 * f32.lanes * rate(f32);
    w->fma_f64_all = 2e-9 * f64.lanes * rate_all(f64, m->threads);
    w->fma_f32_all = 2e-9 * f32.lanes * rate_all(f32, m->threads);
    w->sqrt_f64 = nanoseconds(find(width, OP_SQRT, F64));
    w->sqrt_f32 = nanoseconds(find(width, OP_SQRT, F32));
    w->div_f64 = nanoseconds(find(width, OP_DIV, F64));
    w->div_f32 = nanoseconds(find(width, OP_DIV, F32));
    m->fma_f64 = larger(m->fma_f64, w->fma_f64);
    m->fma_f32 = larger(m->fma_f32, w->fma_f32);
    m->fma_f64_all = larger(m->fma_f64_all, w->fma_f64_all);
    m->fma_f32_all = larger(m->fma_f32_all, w->fma_f32_all);
}

/* An addition that waits for the one before takes a cycle. The compiler may not fold them: each goes
 * through a register of which it knows nothing. Not of a constant: some processors add these while
 * they rename registers, for nothing. */
#define ADD                                                                                        \
    x += y;                                                                                        \
    __asm__ volatile("" : "+r"(x));

static double additions(long n, const struct constants *c)
{
    unsigned long x = (unsigned long)c->start, y = x + 2;

    for (long k = 0; k < n; k++) {
        ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD ADD
    }
    return (double)x;
}

void machine_core(struct machine *m)
{
    m->clock = 1e-9 * 16.0 / CHAINS * rate((struct loop){additions, 1});
    for (int width = 0; width < MACHINE_WIDTHS; width++)
        measure_width(m, width);
}
