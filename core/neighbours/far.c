/* neighbours/far.c -- see far.h. Reads a list, changes nothing of it. */
#include "neighbours/far.h"
#include "base/clones.h"

/* Whether one of n steps is `least` or more. */
CLONES static bool any_step(const uint16_t *step, size_t n, uint16_t least)
{
    int any = 0;
#pragma omp simd reduction(| : any)
    for (size_t k = 0; k < n; k++)
        any |= step[k] >= least;
    return any;
}

static bool span_far(const struct group_list *list, const sph_span *s, size_t from)
{
    if (s->base >= from)
        return s->count > 0;
    return from - s->base <= UINT16_MAX &&
           any_step(list->step + s->first, s->count, (uint16_t)(from - s->base));
}

void group_list_far(const struct group_list *list, size_t from, bool *far, int threads)
{
#pragma omp parallel for schedule(static) num_threads(threads) if (list->n_entry > 100000)
    for (size_t g = 0; g < list->n_group; g++) {
        far[g] = false;
        for (uint64_t s = list->begin[g]; s < list->begin[g + 1] && !far[g]; s++)
            far[g] = span_far(list, &list->span[s], from);
    }
}
