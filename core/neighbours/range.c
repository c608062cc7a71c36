/* neighbours/range.c -- the least and the largest of many numbers. Pure. */
#include "neighbours/range.h"

#include <math.h>

#define LANES 8 /* numbers that are compared side by side, so that none waits for the one before */
#define SHARE 4096

static struct range range_share(const double *x, size_t n)
{
    struct range all = {INFINITY, -INFINITY};
    double low[LANES], high[LANES];
    size_t i = 0;

    for (size_t k = 0; k < LANES; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (; i + LANES <= n; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            low[k] = x[i + k] < low[k] ? x[i + k] : low[k];
            high[k] = x[i + k] > high[k] ? x[i + k] : high[k];
        }
    }
    for (size_t k = 0; i + k < n; k++) {
        low[k] = x[i + k] < low[k] ? x[i + k] : low[k];
        high[k] = x[i + k] > high[k] ? x[i + k] : high[k];
    }
    for (size_t k = 0; k < LANES; k++) {
        all.least = low[k] < all.least ? low[k] : all.least;
        all.most = high[k] > all.most ? high[k] : all.most;
    }
    return all;
}

struct range range_of(const double *x, size_t n, int threads)
{
    double least = INFINITY, most = -INFINITY;

    (void)threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && n > 4 * SHARE)   \
    reduction(min                                                                                  \
              : least) reduction(max                                                               \
                                 : most)
    for (size_t first = 0; first < n; first += SHARE) {
        struct range r = range_share(x + first, n - first < SHARE ? n - first : SHARE);

        least = r.least < least ? r.least : least;
        most = r.most > most ? r.most : most;
    }
    return (struct range){least, most};
}
