/* neighbours/count.c -- how many of a list's pairs are true: the measure by which speeds are told.
 * Reads lists and points only. */
#include "neighbours/neighbours.h"

#include <math.h>

#define LANES SPH_LANES

/* A group's destinations; where they are fewer, at infinity. */
struct targets {
    double x[3][LANES], r2[LANES]; /* r2: square of the reach */
};

static void targets_fill(struct targets *t, const struct cloud *c, size_t first)
{
    for (size_t i = 0; i < LANES; i++) {
        bool real = first + i < c->n;
        double reach = real ? c->scale * c->h[first + i] : 0;

        for (int a = 0; a < c->dim; a++) {
            t->x[a][i] = real ? c->x[a][first + i] : INFINITY;
        }
        t->r2[i] = reach * reach;
    }
}

/* Pairs of a group with one span of its sources. */
typedef uint64_t count_fn(const struct targets *t, const struct cloud *src, const sph_span *span,
                          const uint16_t *step, bool symmetric);

static uint64_t count_plain(const struct targets *t, const struct cloud *src, const sph_span *span,
                            const uint16_t *step, bool symmetric)
{
    uint64_t pairs = 0;

    for (uint32_t k = 0; k < span->count; k++) {
        size_t j = span->base + step[k];
        double reach = symmetric ? src->scale * src->h[j] : 0, own = reach * reach;

        for (size_t i = 0; i < LANES; i++) {
            double r2 = 0;

            for (int a = 0; a < src->dim; a++) {
                double d = t->x[a][i] - src->x[a][j];

                r2 += d * d;
            }
            pairs += r2 < (own > t->r2[i] ? own : t->r2[i]);
        }
    }
    return pairs;
}

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

/* Half of the lanes; -1 in each that is near source j. */
static inline __attribute__((always_inline, target("avx2,fma"))) __m256i
half_near(const struct targets *t, size_t half, const double *x, __m256d own, int dim)
{
    __m256d r2 = _mm256_setzero_pd(), most = _mm256_max_pd(own, _mm256_loadu_pd(t->r2 + half));

    for (int a = 0; a < dim; a++) {
        __m256d d = _mm256_sub_pd(_mm256_loadu_pd(t->x[a] + half), _mm256_set1_pd(x[a]));

        r2 = _mm256_fmadd_pd(d, d, r2);
    }
    return _mm256_castpd_si256(_mm256_cmp_pd(r2, most, _CMP_LT_OQ));
}

static inline __attribute__((always_inline, target("avx2,fma"))) uint64_t
count_dim(const struct targets *t, const struct cloud *src, const sph_span *span,
          const uint16_t *step, bool symmetric, int dim)
{
    __m256i hits = _mm256_setzero_si256();
    int64_t sum[4];

    for (uint32_t k = 0; k < span->count; k++) {
        size_t j = span->base + step[k];
        double reach = symmetric ? src->scale * src->h[j] : 0, x[3];
        __m256d own = _mm256_set1_pd(reach * reach);

        for (int a = 0; a < dim; a++) {
            x[a] = src->x[a][j];
        }
        hits = _mm256_sub_epi64(hits, half_near(t, 0, x, own, dim));
        hits = _mm256_sub_epi64(hits, half_near(t, 4, x, own, dim));
    }
    _mm256_storeu_si256((__m256i *)(void *)sum, hits);
    return (uint64_t)(sum[0] + sum[1] + sum[2] + sum[3]);
}

__attribute__((target("avx2,fma"))) static uint64_t count_avx2(const struct targets *t,
                                                               const struct cloud *src,
                                                               const sph_span *span,
                                                               const uint16_t *step, bool symmetric)
{
    if (src->dim == 3) {
        return count_dim(t, src, span, step, symmetric, 3);
    }
    return src->dim == 2 ? count_dim(t, src, span, step, symmetric, 2)
                         : count_dim(t, src, span, step, symmetric, 1);
}

static count_fn *count_best(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? count_avx2
                                                                           : count_plain;
}
#else
static count_fn *count_best(void)
{
    return count_plain;
}
#endif

uint64_t group_list_count(const struct group_list *list, const struct cloud *dst,
                          const struct cloud *src, int threads)
{
    count_fn *count = count_best();
    uint64_t pairs = 0;

    (void)threads;
#pragma omp parallel for schedule(static) reduction(+ : pairs) num_threads(threads) if (threads > 1)
    for (size_t g = 0; g < list->n_group; g++) {
        struct targets t;

        targets_fill(&t, dst, g * LANES);
        for (uint64_t s = list->begin[g]; s < list->begin[g + 1]; s++) {
            const sph_span *span = &list->span[s];

            pairs += count(&t, src, span, list->step + span->first, list->symmetric);
        }
    }
    return pairs;
}
