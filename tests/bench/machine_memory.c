/* machine_memory.c -- how fast memory is read, and read and written. */
#include "machine_parts.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { LARGE_PAGE = 2 << 20 };

/* Two doubles: what every processor has. Memory is slower anyway. */
typedef double pair __attribute__((vector_size(16)));

struct arrays {
    pair *a, *b, *c;
    long n; /* pairs in each */
};

static volatile double sink;

/* Sums up the three arrays from `first` to before `last`, in chains that do not wait for one another. */
static double read_range(const struct arrays *s, long first, long last)
{
    pair sum[6] = {{0}};

    for (long k = first; k + 1 < last; k += 2) {
        sum[0] += s->a[k];
        sum[1] += s->b[k];
        sum[2] += s->c[k];
        sum[3] += s->a[k + 1];
        sum[4] += s->b[k + 1];
        sum[5] += s->c[k + 1];
    }
    sum[0] += sum[1] + sum[2] + sum[3] + sum[4] + sum[5];
    return sum[0][0] + sum[0][1];
}

static double triad_range(const struct arrays *s, long first, long last)
{
    const pair factor = {0.5, 0.5};

    for (long k = first; k < last; k++)
        s->a[k] = s->b[k] + factor * s->c[k];
    return s->a[first][0];
}

typedef double (*range_fn)(const struct arrays *s, long first, long last);

/* [GB/s] of so many threads; 48 bytes for each index. */
static double bandwidth(range_fn run, const struct arrays *s, int threads)
{
    double best = 0.0;

    for (int k = 0; k < MACHINE_REPEATS; k++) {
        double sum = 0.0, t = machine_wall_time();
#pragma omp parallel for schedule(static) num_threads(threads) reduction(+ : sum)
        for (int part = 0; part < threads; part++)
            sum += run(s, s->n / threads * part, s->n / threads * (part + 1));
        t = machine_wall_time() - t;
        sink = sum;
        if (t > 0.0 && 48e-9 * (double)s->n / t > best)
            best = 48e-9 * (double)s->n / t;
    }
    return best;
}

/* [bytes] of an array: three of them are far larger than any cache. */
static size_t array_bytes(void)
{
    size_t bytes = (size_t)64 << 20;
#ifdef _SC_LEVEL3_CACHE_SIZE
    long cache = sysconf(_SC_LEVEL3_CACHE_SIZE);
    if (cache > 0 && (size_t)cache * 2 > bytes)
        bytes = (size_t)cache * 2;
#endif
    if (bytes > (size_t)512 << 20)
        bytes = (size_t)512 << 20;
    return bytes / LARGE_PAGE * LARGE_PAGE;
}

/* In large pages where the system gives them: what memory can do, not what its page tables cost. */
static pair *array(size_t bytes)
{
    pair *data = aligned_alloc(LARGE_PAGE, bytes);

#ifdef MADV_HUGEPAGE
    if (data)
        (void)madvise(data, bytes, MADV_HUGEPAGE);
#endif
    return data;
}

void machine_memory(struct machine *m)
{
    const size_t bytes = array_bytes();
    struct arrays s = {.n = (long)(bytes / sizeof(pair))};

    s.a = array(bytes);
    s.b = array(bytes);
    s.c = array(bytes);
    if (s.a && s.b && s.c) {
        /* Every thread touches its own part first: there the memory will be. */
#pragma omp parallel for schedule(static) num_threads(m->threads)
        for (int part = 0; part < m->threads; part++) {
            long first = s.n / m->threads * part;
            size_t part_bytes = (size_t)(s.n / m->threads) * sizeof(pair);
            memset(s.a + first, 0, part_bytes);
            memset(s.b + first, 0, part_bytes);
            memset(s.c + first, 0, part_bytes);
        }
        m->read_bw = bandwidth(read_range, &s, 1);
        m->triad_bw = bandwidth(triad_range, &s, 1);
        m->read_bw_all = bandwidth(read_range, &s, m->threads);
        m->triad_bw_all = bandwidth(triad_range, &s, m->threads);
    }
    free(s.a);
    free(s.b);
    free(s.c);
}
