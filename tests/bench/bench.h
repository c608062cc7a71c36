/* bench.h -- what benchmarks share: memory or the end, the median. */
#ifndef BENCH_H
#define BENCH_H

#include <stdio.h>
#include <stdlib.h>

static inline void *bench_need(void *memory)
{
    if (!memory) {
        fputs("no memory\n", stderr);
        exit(1);
    }
    return memory;
}

static inline int bench_by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts them. */
static inline double bench_median(double *value, size_t n)
{
    qsort(value, n, sizeof(*value), bench_by_size);
    return value[n / 2];
}

#endif
