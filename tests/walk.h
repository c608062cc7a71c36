/* walk.h -- goes through a group's sources one by one, for plugins under test that write their
 * loop by hand:
 *   for (struct walk w = walk_begin(b, i); walk_next(&w);)
 *       ... w.j, a source of destination i's group ... */
#ifndef TESTS_WALK_H
#define TESTS_WALK_H

#include <sph/batch.h>

struct walk {
    const sph_batch *b;
    uint64_t span, end;
    uint32_t k, j;
};

static inline struct walk walk_begin(const sph_batch *b, uint64_t i)
{
    const uint64_t *begin = b->begin + i / SPH_LANES;
    struct walk w = {b, begin[0], begin[1], 0, 0};

    return w;
}

static inline int walk_next(struct walk *w)
{
    const sph_span *s = w->b->span + w->span;

    if (w->span == w->end)
        return 0;
    w->j = s->base + w->b->list[s->first + w->k++];
    if (w->k == s->count) {
        w->k = 0;
        w->span++;
    }
    return 1;
}

#endif
