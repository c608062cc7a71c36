/* neighbours/count.c -- how many of a list's pairs are true: the measure by which speeds are told. Reads lists and
 * points only. */
#include "neighbours/neighbours.h"
#include <sph/batch.h>

uint64_t group_list_count(const struct group_list *list, const struct cloud *dst,
                          const struct cloud *src)
{
    uint64_t pairs = 0;
    for (size_t g = 0; g < list->n_group; g++) {
        size_t first = g * SPH_LANES, end = first + SPH_LANES < dst->n ? first + SPH_LANES : dst->n;
        for (struct source_walk w = source_walk_begin(list, g); source_walk_next(list, &w);) {
            const uint32_t j = w.source;
            for (size_t i = first; i < end; i++) {
                double r2 = 0.0, reach = dst->scale * dst->h[i];
                for (int c = 0; c < dst->dim; c++)
                    r2 += (dst->x[c][i] - src->x[c][j]) * (dst->x[c][i] - src->x[c][j]);
                if (list->symmetric && src->scale * src->h[j] > reach)
                    reach = src->scale * src->h[j];
                pairs += r2 < reach * reach;
            }
        }
    }
    return pairs;
}
