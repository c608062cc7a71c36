/* opencl/lists.c -- neighbour lists on a device (see lists.h; the kernels are lists.cl and
 * bundles.cl).
 *
 * A processor makes them a slab of groups at a time: found into slots, counted, moved to where
 * the running sums say, all of it within the cache. A GPU counts all groups, then finds their
 * sources again and writes them. Where the list turns out to have too little room it is made anew
 * with more: only ever the first time, or as lists grow. */
#include "config.h"

#include "opencl/search.h"

#include "neighbours/sources.h"

#include <math.h>
#include <stdlib.h>

#define LANES SPH_LANES
#define RUN 48         /* groups of a work item of bundles.cl */
#define MANY 32        /* ... of lists.cl, on a processor */
#define SLAB (1 << 19) /* places in the slots of a slab, of one side */
#define PLANES 5

/* What a list is made of. */
struct job {
    struct device_search *s;
    struct device_list *list;
    const struct device_cloud *dst, *src;
    const struct device_buffer *wide; /* of the sources in the search's order */
    struct search_points to, from;
    struct search_index ix;
    double factor;
    uint32_t mapped;
};

struct stretch {
    uint32_t from, n, stride, pad;
};

/* What finds a row of cells; a tree has none and looks at nothing there. */
static const struct device_buffer *rows_of(const struct device_search *s)
{
    return s->kind == SEARCH_TREE ? &s->counts : s->kind == SEARCH_CELLS ? &s->begin : &s->key;
}

static const struct device_buffer *order_of(const struct job *j)
{
    return j->mapped ? &j->s->order : &j->s->counts;
}

#define COMMON_ARGS                                                                                \
    DEVICE_BUFFER(j->dst->wide), DEVICE_VALUE(j->to), DEVICE_VALUE(j->factor),                     \
        DEVICE_BUFFER(j->wide), DEVICE_VALUE(j->from), DEVICE_VALUE(j->ix),                        \
        DEVICE_BUFFER(rows_of(s)), DEVICE_BUFFER(&s->box), DEVICE_BUFFER(order_of(j)),             \
        DEVICE_VALUE(j->mapped), DEVICE_VALUE(*t)

/* Groups one by one, counted or, by those counts, written. */
static int groups(const struct job *j, const struct stretch *t, bool fill, uint32_t slot,
                  struct error *e)
{
    struct device_search *s = j->s;
    struct device_list *list = j->list;
    const uint64_t room = list->step.bytes / sizeof(uint32_t);
    const uint32_t fill4 = fill, all = !s->cpu;

    return SEARCH_LAUNCH(s, K_LIST, search_items(t->n, s->cpu ? MANY : 1), COMMON_ARGS,
                         DEVICE_VALUE(fill4), DEVICE_VALUE(all), DEVICE_BUFFER(&s->counts),
                         DEVICE_BUFFER(&list->begin), DEVICE_BUFFER(&list->common),
                         DEVICE_BUFFER(&list->step), DEVICE_BUFFER(&s->total), DEVICE_VALUE(slot),
                         DEVICE_VALUE(room));
}

/* Makes the lists of a stretch of groups, the slot-th. */
static int slab(const struct job *j, const struct stretch *t, uint32_t slot, struct error *e)
{
    struct device_search *s = j->s;
    struct device_list *list = j->list;
    const uint64_t room = list->step.bytes / sizeof(uint32_t);
    const size_t runs = search_items(t->n, RUN);

    if (s->cpu && SEARCH_LAUNCH(s, K_LOOK, runs, COMMON_ARGS, DEVICE_BUFFER(&s->counts),
                                DEVICE_BUFFER(&s->slot), DEVICE_VALUE(s->room),
                                DEVICE_BUFFER(&s->need), DEVICE_BUFFER(&s->tables)) != 0) {
        return -1;
    }
    if (groups(j, t, false, slot, e) != 0 ||
        device_scan(s->sort, &s->counts, 0, t->n, &list->begin, t->from, &s->total, slot, e) != 0) {
        return -1;
    }
    if (s->cpu &&
        SEARCH_LAUNCH(s, K_PUT, runs, DEVICE_VALUE(*t), DEVICE_BUFFER(&s->counts),
                      DEVICE_BUFFER(&s->slot), DEVICE_VALUE(s->room), DEVICE_BUFFER(&list->begin),
                      DEVICE_BUFFER(&list->step), DEVICE_BUFFER(&s->total), DEVICE_VALUE(slot),
                      DEVICE_VALUE(room), DEVICE_BUFFER(&s->need)) != 0) {
        return -1;
    }
    return groups(j, t, true, slot, e);
}

/* All slabs; *entries: of the list; *need: places that a side of a slot must have. */
static int slabs(const struct job *j, uint64_t *entries, uint32_t *need, struct error *e)
{
    struct device_search *s = j->s;
    const size_t groups = j->list->n_group;
    const size_t each = s->cpu ? SLAB / s->room + 1 : groups;
    const size_t stride = s->cpu ? search_items(each, RUN) * RUN : groups;
    uint32_t slot = 0;

    if (device_reserve(s->d, &s->counts, PLANES * stride * sizeof(uint32_t), "neighbour lists",
                       e) != 0 ||
        device_reserve(s->d, &s->total, (search_items(groups, stride) + 1) * sizeof(uint64_t),
                       "neighbour lists", e) != 0 ||
        device_fill(s->d, &s->need, 0, 0, sizeof(uint32_t), e) != 0) {
        return -1;
    }
    if (s->cpu && device_reserve(s->d, &s->slot, stride * 3 * s->room * sizeof(uint32_t),
                                 "neighbour lists", e) != 0) {
        return -1;
    }
    for (size_t from = 0; from < groups; from += stride, slot++) {
        const size_t n = groups - from < stride ? groups - from : stride;
        const struct stretch t = {(uint32_t)from, (uint32_t)n, (uint32_t)stride, 0};

        if (slab(j, &t, slot, e) != 0) {
            return -1;
        }
    }
    return device_read(s->d, &s->total, slot * sizeof(uint64_t), entries, sizeof *entries, e) ||
                   device_read(s->d, &s->need, 0, need, sizeof *need, e)
               ? -1
               : 0;
}

static int fill(const struct job *j, struct error *e)
{
    struct device_search *s = j->s;
    struct device_list *list = j->list;
    const size_t first = list->n_group * LANES * (s->dim == 3 ? 5 : s->dim == 2 ? 2 : 1);
    uint32_t need;

    if (list->step.bytes == 0 && s->cpu &&
        device_reserve(s->d, &list->step, first * LANES * sizeof(uint32_t), "neighbour lists", e) !=
            0) {
        return -1;
    }
    if (device_reserve(s->d, &list->step, sizeof(uint32_t), "neighbour lists", e) != 0) {
        return -1;
    }
    for (;;) {
        uint64_t entries;

        if (slabs(j, &entries, &need, e) != 0) {
            return -1;
        }
        if (need > s->room) {
            s->room = (need + need / 4 + 63) / 64 * 64;
            continue;
        }
        if (entries > UINT32_MAX) {
            return error_set(e, EXIT_RUN,
                             "neighbour lists with %llu entries: at most %u are possible on a "
                             "device",
                             (unsigned long long)entries, UINT32_MAX);
        }
        list->n_entry = entries;
        if (entries * sizeof(uint32_t) <= list->step.bytes) {
            return 0;
        }
        if (device_reserve(s->d, &list->step, (entries + entries / 32) * sizeof(uint32_t),
                           "neighbour lists", e) != 0) {
            return -1;
        }
    }
}

/* True pairs, if counted, and crowded destinations, if somebody asks. */
static int pairs(const struct job *j, bool same, bool counted, uint64_t most, struct error *e)
{
    struct device_search *s = j->s;
    struct device_list *list = j->list;
    const size_t items = search_items(list->n_group, s->cpu ? MANY : 1);
    const size_t groups = s->cpu ? items : search_items(items, 64);
    const struct search_points to = search_points_of(j->dst);
    struct search_points from = search_points_of(j->src);
    const uint32_t same4 = same, n = (uint32_t)list->n_group, counted4 = counted;
    const size_t bytes = 2 * groups * sizeof(uint64_t);
    const uint64_t *part = search_room(s, bytes, e);

    from.scale = j->from.scale > 0 ? from.scale : 0;
    if (!part || device_reserve(s->d, &s->pairs, bytes, "neighbour lists", e) != 0 ||
        SEARCH_LAUNCH(s, K_PAIRS, items, DEVICE_BUFFER(j->dst->wide), DEVICE_VALUE(to),
                      DEVICE_BUFFER(j->src->wide), DEVICE_VALUE(from), DEVICE_VALUE(same4),
                      DEVICE_VALUE(n), DEVICE_VALUE(counted4), DEVICE_VALUE(most),
                      DEVICE_BUFFER(&list->begin), DEVICE_BUFFER(&list->step),
                      DEVICE_BUFFER(&s->pairs)) != 0 ||
        device_read(s->d, &s->pairs, 0, s->host, bytes, e) != 0) {
        return -1;
    }
    for (size_t k = 0; k < groups; k++) {
        list->n_pair += part[2 * k];
        list->crowded += part[2 * k + 1];
    }
    return 0;
}

static int check(const struct device_search *s, const struct device_cloud *dst,
                 const struct device_cloud *src, double skin, struct error *e)
{
    const size_t most = UINT32_MAX - 4096;

    if (dst->dim != s->dim || src->dim != s->dim) {
        return error_set(e, EXIT_RUN, "neighbour lists between %d and %d dimensions", dst->dim,
                         src->dim);
    }
    if (!(skin >= 0 && skin < 1e6) || !(dst->scale >= 0) || !(src->scale >= 0)) {
        return error_set(e, EXIT_RUN, "neighbour lists with a skin of %g and a reach of %g h", skin,
                         dst->scale);
    }
    if (dst->n > most || src->n > most) {
        return error_set(e, EXIT_RUN, "%zu particles: at most %zu are possible on a device",
                         dst->n > src->n ? dst->n : src->n, most);
    }
    return 0;
}

static int reserve(struct device_search *s, struct device_list *list, size_t n, struct error *e)
{
    const size_t bytes = ((n + LANES - 1) / LANES + 1) * sizeof(uint32_t);

    list->n_group = 0;
    list->n_entry = list->n_pair = list->crowded = 0;
    if (device_reserve(s->d, &list->begin, bytes, "neighbour lists", e) != 0 ||
        device_reserve(s->d, &list->common, bytes, "neighbour lists", e) != 0 ||
        device_fill(s->d, &list->begin, 0, 0, bytes, e) != 0 ||
        device_fill(s->d, &list->common, 0, 0, bytes, e) != 0) {
        return -1;
    }
    list->n_group = (n + LANES - 1) / LANES;
    return 0;
}

int device_list_make(struct device_search *s, struct device_list *list,
                     const struct device_cloud *dst, const struct device_cloud *src, bool symmetric,
                     double skin, bool counted, uint64_t most, struct error *e)
{
    const double factor = (1 + skin) * (1 + SLACK);
    struct job j = {.s = s, .list = list, .dst = dst, .src = src, .factor = factor * dst->scale};
    const bool same = dst->wide->mem == src->wide->mem && dst->x_slot == src->x_slot &&
                      dst->plane == src->plane && dst->first == src->first;
    const bool within = same && dst->h_slot == src->h_slot && dst->n <= src->n;
    struct search_survey to, all;
    double typical, query;
    int status;

    if (check(s, dst, src, skin, e) != 0 || search_look(s, dst, 0, true, &to, e) != 0 ||
        search_look(s, src, within ? dst->n : 0, symmetric, &all, e) != 0 ||
        search_check(&to, "destination", e) != 0 || search_check(&all, "source", e) != 0 ||
        reserve(s, list, dst->n, e) != 0) {
        list->n_group = 0;
        return -1;
    }
    if (dst->n == 0 || src->n == 0) {
        return 0;
    }
    for (int a = 0; a < s->dim && within; a++) {
        all.least[a] = fmin(all.least[a], to.least[a]);
        all.most[a] = fmax(all.most[a], to.most[a]);
    }
    all.h_most = within ? fmax(all.h_most, to.h_most) : all.h_most;
    typical = j.factor * to.h_sum / (double)dst->n;
    query = fmax(j.factor * to.h_most, symmetric ? factor * src->scale * all.h_most : 0);
    j.to = search_points_of(dst);
    status = search_make(s, src, &all, symmetric, factor, typical, query, &j.ix, &j.from, e);
    j.mapped = s->own_order;
    j.wide = s->own_order ? &s->copy : src->wide;
    if (status == 0) {
        status = fill(&j, e);
    }
    if (status == 0 && (counted || most > 0)) {
        status = pairs(&j, same, counted, most, e);
    }
    if (status != 0) {
        list->n_group = 0; /* nobody shall read half a list */
        list->n_entry = 0;
    }
    return status;
}

void device_list_release(struct device *d, struct device_list *list)
{
    device_release(d, &list->begin);
    device_release(d, &list->common);
    device_release(d, &list->step);
    *list = (struct device_list){.n_group = 0};
}
