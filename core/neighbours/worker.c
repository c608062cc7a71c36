/* neighbours/worker.c -- finds the sources of a run of groups. Reads the job, writes its worker
 * and the counts of its groups.
 *
 * Groups that stand side by side share one search and one copy of the leaves found, in single
 * precision relative to their common centre (a bundle). Each group then takes from that first the
 * leaves, then the points that it sees. A group whose lanes are far apart is taken in pieces.
 * Leaves come ascending, so sources do; only those of pieces, and sources that stand in an order of
 * the search's own, are sorted. */
#include "neighbours/worker.h"

#include "neighbours/visit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BUNDLE_MOST 12    /* groups in a bundle */
#define BUNDLE_SPREAD 2.0 /* half the diagonal of a bundle's box, in units of its smallest reach */

#define NO_LEAF UINT32_MAX

/* Destinations [first, last) that are looked after together. */
struct stretch {
    size_t first, last;
    struct query q;
    double least; /* reach */
};

/* -- Memory of a worker ------------------------------------------------------------------------ */

/* Room for n elements in an array; what is in it is kept. */
static bool reserve(struct worker *w, void *array, size_t *capacity, size_t n, size_t size)
{
    void *old, *more;

    if (n <= *capacity) {
        return true;
    }
    memcpy(&old, array, sizeof old);
    n += n / 4 + 64;
    more = realloc(old, n * size);
    if (!more) {
        w->no_memory = true;
        return false;
    }
    memcpy(array, &more, sizeof more);
    *capacity = n;
    return true;
}

static bool leaf_reserve(struct worker *w, size_t n)
{
    size_t capacity = (n + n / 2 + 127) / 64 * 64;
    uint32_t *leaf;

    if (n <= w->leaf_capacity) {
        return true;
    }
    leaf = realloc(w->leaf, capacity * sizeof *leaf);
    w->leaf = leaf ? leaf : w->leaf;
    free(w->chosen);
    free(w->pack);
    free(w->box);
    w->chosen = malloc((capacity + LEAF) * sizeof *w->chosen);
    w->pack = aligned_alloc(64, capacity * sizeof *w->pack);
    w->box = aligned_alloc(64, capacity / LEAF * sizeof *w->box);
    w->leaf_capacity = capacity;
    if (!leaf || !w->chosen || !w->pack || !w->box) {
        w->leaf_capacity = 0;
        w->no_memory = true;
        return false;
    }
    return true;
}

void worker_fini(struct worker *w)
{
    free(w->span);
    free(w->step);
    for (int by = 0; by < BY_SIDES; by++) {
        free(w->found.source[by]);
    }
    free(w->leaf);
    free(w->chosen);
    free(w->pack);
    free(w->box);
    bitset_fini(&w->near);
    bitset_fini(&w->unsorted);
}

size_t worker_bytes(const struct worker *w)
{
    size_t found = w->found.capacity[0] + w->found.capacity[1] + w->found.capacity[2];

    return w->span_capacity * sizeof *w->span + w->step_capacity * sizeof *w->step +
           found * sizeof(uint32_t) + bitset_bytes(&w->near) + bitset_bytes(&w->unsorted) +
           w->leaf_capacity * (2 * sizeof *w->leaf + sizeof *w->pack + sizeof *w->box / LEAF);
}

/* -- What is found of a group ------------------------------------------------------------------ */

static bool found_reserve(struct worker *w, int by, size_t n)
{
    return reserve(w, &w->found.source[by], &w->found.capacity[by], n + STEPS_MORE,
                   sizeof **w->found.source);
}

static void unsorted_add(struct worker *w, int by)
{
    for (size_t k = 0; k < w->found.n[by]; k++) {
        bitset_add(&w->unsorted, w->found.source[by][k]);
    }
}

static bool unsorted_begin(const struct job *j, struct worker *w)
{
    w->no_memory = w->no_memory || (!w->unsorted.bits && !bitset_init(&w->unsorted, j->src->n));
    return !w->no_memory;
}

/* Sources of the group's own places are for both halves: moves them there. There is room, for they are
 * fewer than STEPS_MORE. */
static void found_own(struct found *f, size_t group)
{
    for (int by = BY_LOWER; by <= BY_UPPER; by++) {
        size_t kept = 0;

        for (size_t k = 0; k < f->n[by]; k++) {
            uint32_t source = f->source[by][k];

            if (source / LANES == group) {
                f->source[BY_BOTH][f->n[BY_BOTH]++] = source;
            } else {
                f->source[by][kept++] = source;
            }
        }
        f->n[by] = kept;
    }
}

/* Sorts what was found, ascending. */
static void found_sort(const struct job *j, struct worker *w, size_t group)
{
    found_own(&w->found, group);
    for (int by = 0; by < BY_SIDES && unsorted_begin(j, w); by++) {
        unsorted_add(w, by);
        w->found.n[by] = bitset_take(&w->unsorted, w->found.source[by]);
    }
}

/* Likewise and without repeats, for lanes of pieces are no halves of a group: as seen by both. */
static void found_sort_as_one(const struct job *j, struct worker *w)
{
    size_t *n = w->found.n;

    if (unsorted_begin(j, w) && found_reserve(w, BY_BOTH, n[0] + n[1] + n[2])) {
        for (int by = 0; by < BY_SIDES; by++) {
            unsorted_add(w, by);
            n[by] = 0;
        }
        n[BY_BOTH] = bitset_take(&w->unsorted, w->found.source[BY_BOTH]);
    }
}

/* What was found, for both halves, in the order in which it is to be visited. */
static void found_by_visits(const struct job *j, struct worker *w)
{
    const struct visits *v = j->all->visits;
    size_t *n = w->found.n;

    if (!unsorted_begin(j, w) || !found_reserve(w, BY_BOTH, n[0] + n[1] + n[2])) {
        return;
    }
    for (int by = 0; by < BY_SIDES; by++) {
        for (size_t k = 0; k < n[by]; k++) {
            bitset_add(&w->unsorted, v->place[w->found.source[by][k]]);
        }
        n[by] = 0;
    }
    n[BY_BOTH] = bitset_take(&w->unsorted, w->found.source[BY_BOTH]);
    for (size_t k = 0; k < n[BY_BOTH]; k++) {
        w->found.source[BY_BOTH][k] = v->source[w->found.source[BY_BOTH][k]];
    }
}

/* -- Stretches
 * ------------------------------------------------------------------------------------- */

static void stretch_init(struct stretch *s, const struct job *j, size_t first, size_t last)
{
    const struct cloud *c = j->dst;

    s->first = first;
    s->last = last;
    s->least = INFINITY;
    s->q.reach = 0;
    for (int a = 0; a < 3; a++) {
        s->q.lo[a] = a < c->dim ? INFINITY : 0;
        s->q.hi[a] = a < c->dim ? -INFINITY : 0;
    }
    for (size_t i = first; i < last; i++) {
        double reach = j->scale * c->h[i];

        s->least = reach < s->least ? reach : s->least;
        s->q.reach = reach > s->q.reach ? reach : s->q.reach;
        for (int a = 0; a < c->dim; a++) {
            double x = c->x[a][i];

            s->q.lo[a] = x < s->q.lo[a] ? x : s->q.lo[a];
            s->q.hi[a] = x > s->q.hi[a] ? x : s->q.hi[a];
        }
    }
}

/* Whether half the diagonal of the box is at most so many times the smallest reach. */
static bool stretch_within(const struct stretch *s, double reaches)
{
    double sum = 0, most = 2 * reaches * s->least;

    for (int a = 0; a < 3; a++) {
        double d = s->q.hi[a] - s->q.lo[a];

        sum += d * d;
    }
    return sum <= most * most;
}

/* Makes `both` of two spans that stand side by side. */
static void stretch_join(struct stretch *both, const struct stretch *s, const struct stretch *t)
{
    *both = *s;
    both->last = t->last;
    both->least = t->least < s->least ? t->least : s->least;
    both->q.reach = t->q.reach > s->q.reach ? t->q.reach : s->q.reach;
    for (int a = 0; a < 3; a++) {
        both->q.lo[a] = t->q.lo[a] < s->q.lo[a] ? t->q.lo[a] : s->q.lo[a];
        both->q.hi[a] = t->q.hi[a] > s->q.hi[a] ? t->q.hi[a] : s->q.hi[a];
    }
}

/* -- A stretch's sources ----------------------------------------------------------------------- */

static void frame_init(struct frame *f, const struct job *j, const struct stretch *s)
{
    double unit = s->q.reach > 0 ? s->q.reach : j->src->largest;

    f->inverse = unit > 0 ? 1 / unit : 1;
    for (int a = 0; a < 3; a++) {
        f->centre[a] = s->q.lo[a] + (s->q.hi[a] - s->q.lo[a]) / 2;
    }
}

/* The leaves near a stretch, ascending. */
static bool find(const struct job *j, struct worker *w, const struct stretch *s)
{
    size_t seen;

    w->n_leaf = 0;
    if (!w->near.bits && !bitset_init(&w->near, j->src->n_leaf)) {
        w->no_memory = true;
        return false;
    }
    seen = j->manager->find(j->search, &s->q, &w->near);
    w->visited += seen * (s->last - s->first);
    if (!leaf_reserve(w, seen < j->src->n_leaf ? seen : j->src->n_leaf)) {
        return false;
    }
    w->n_leaf = bitset_take(&w->near, w->leaf);
    return true;
}

/* Leaves lie in many rows, which no processor foresees. */
static void fetch_ahead(const struct sources *s, const uint32_t *leaf, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        for (int a = 0; a < s->dim; a++) {
            __builtin_prefetch(s->x[a] + (size_t)leaf[k] * LEAF);
        }
        if (s->scale > 0) {
            __builtin_prefetch(s->h + (size_t)leaf[k] * LEAF);
        }
    }
}

/* Finds and packs the leaves near a stretch. */
static void look(const struct job *j, struct worker *w, const struct stretch *s, struct frame *f)
{
    if (!find(j, w, s)) {
        return;
    }
    frame_init(f, j, s);
    for (size_t k = 0; k < w->n_leaf; k += LEAF) {
        size_t left = w->n_leaf - k, n = left < LEAF ? left : LEAF;

        fetch_ahead(j->src, w->leaf + k + n, left < 2 * LEAF ? left - n : LEAF);
        j->filter->pack(&w->pack[k], &w->box[k / LEAF], j->src, f, w->leaf + k, n);
    }
}

/* Appends the sources that destinations [first, last), at most a group, see of the packed leaves. The
 * group's own places are leaf `own`: where both are one array, sources that are in it for all lanes. */
static void take(const struct job *j, struct worker *w, const struct frame *f, size_t first,
                 size_t last, uint32_t own)
{
    struct found *found = &w->found;
    size_t n, before[BY_SIDES];
    struct lanes t;

    if (w->n_leaf == 0) {
        return;
    }
    j->filter->lanes(&t, j->dst, j->scale, f, first, last);
    n = j->filter->near_leaves(w->box, w->n_leaf, &t, j->src->dim, w->chosen);
    for (int by = 0; by < BY_SIDES; by++) {
        before[by] = found->n[by];
        if (!found_reserve(w, by, before[by] + LEAF * n)) {
            return;
        }
    }
    j->filter->near_points(w->pack, w->leaf, w->chosen, n, &t, j->src->dim,
                           j->src->order ? NO_LEAF : own, found);
    for (int by = 0; j->src->order && by < BY_SIDES; by++) {
        for (size_t k = before[by]; k < found->n[by]; k++) {
            found->source[by][k] = j->src->order[found->source[by][k]];
        }
    }
    w->candidates += n * LEAF * LANES;
}

/* Whose turn it is to be put: from `at` on, those of a group that are not yet in its lists. */
struct rest {
    size_t at[BY_SIDES], end[BY_SIDES];
};

/* The lowest of what is left; false if that is nothing. */
static bool rest_base(const struct found *f, struct rest *r, uint32_t *base)
{
    bool some = false;

    for (int by = 0; by < BY_SIDES; by++) {
        if (r->at[by] < f->n[by]) {
            uint32_t first = f->source[by][r->at[by]];

            *base = some && *base < first ? *base : first;
            some = true;
        }
    }
    return some;
}

/* Sets the ends of what fits into one span. */
static void rest_cut(const struct found *f, struct rest *r, uint32_t base)
{
    for (int by = 0; by < BY_SIDES; by++) {
        size_t end = f->n[by];

        while (end > r->at[by] && f->source[by][end - 1] - base >= UINT16_MAX) {
            end--;
        }
        r->end[by] = end;
    }
}

/* A span: what both halves of the lanes see, what is left over of one of them, their turns. */
static void put_span(const struct job *j, struct worker *w, const struct rest *r, uint32_t base)
{
    const struct found *f = &w->found;
    const uint32_t *side[BY_SIDES];
    size_t n[BY_SIDES], turns, more;
    uint16_t *out = w->step + w->n_step;
    int longer;

    for (int by = 0; by < BY_SIDES; by++) {
        side[by] = f->source[by] + r->at[by];
        n[by] = r->end[by] - r->at[by];
    }
    longer = n[BY_LOWER] > n[BY_UPPER] ? BY_LOWER : BY_UPPER;
    turns = n[BY_LOWER] + n[BY_UPPER] - n[longer];
    more = n[longer] - turns;
    j->filter->steps(out, side[BY_BOTH], n[BY_BOTH], base);
    j->filter->steps(out + n[BY_BOTH], side[longer] + turns, more, base);
    j->filter->turns(out + n[BY_BOTH] + more, side[BY_LOWER], side[BY_UPPER], turns, base);
    w->span[w->n_span++] = (sph_span){w->n_step, base, (uint16_t)(n[BY_BOTH] + more + 2 * turns),
                                      (uint16_t)(n[BY_BOTH] + more)};
    w->n_step += n[BY_BOTH] + more + 2 * turns;
}

/* Of what does not ascend: as many as lie within a span's reach of each other. */
static bool rest_cut_visits(const struct found *f, struct rest *r, uint32_t *base)
{
    const uint32_t *source = f->source[BY_BOTH];
    size_t k = r->at[BY_BOTH];
    uint32_t least = UINT32_MAX, most = 0;

    for (; k < f->n[BY_BOTH] && k - r->at[BY_BOTH] < UINT16_MAX; k++) {
        uint32_t low = source[k] < least ? source[k] : least;
        uint32_t high = source[k] > most ? source[k] : most;

        if (high - low >= UINT16_MAX) {
            break;
        }
        least = low;
        most = high;
    }
    *base = least;
    r->end[BY_BOTH] = k;
    return k > r->at[BY_BOTH];
}

/* -- Crowds ------------------------------------------------------------------------------------ */

/* Of what was found of a group those that lie within reach of destination i, but for itself. */
static uint64_t neighbours_of(const struct job *j, const struct found *f, size_t i)
{
    const bool same = j->dst->x[0] == j->all->x[0];
    uint64_t n = 0;

    for (int by = 0; by < BY_SIDES; by++) {
        for (size_t k = 0; k < f->n[by]; k++) {
            size_t source = f->source[by][k];
            double reach = j->dst->scale * j->dst->h[i], r2 = 0;

            if (j->symmetric) {
                reach = fmax(reach, j->all->scale * j->all->h[source]);
            }
            for (int a = 0; a < j->dst->dim; a++) {
                double d = j->dst->x[a][i] - j->all->x[a][source];

                r2 += d * d;
            }
            n += r2 < reach * reach && !(same && source == i);
        }
    }
    return n;
}

/* Looked at only where a group together has more than one of it may: false if the list is to stop here. */
static bool crowd_look(const struct job *j, struct worker *w, size_t group)
{
    const struct found *f = &w->found;
    size_t end = (group + 1) * LANES < j->dst->n ? (group + 1) * LANES : j->dst->n;

    if (j->crowd.most == 0 || f->n[BY_BOTH] + f->n[BY_LOWER] + f->n[BY_UPPER] <= j->crowd.most) {
        return true;
    }
    for (size_t i = group * LANES; i < end; i++) {
        uint64_t n = neighbours_of(j, f, i);

        if (n > j->crowd.most && w->crowd.n++ == 0) {
            w->crowd.first = i;
            w->crowd.neighbours = n;
        }
    }
    return !(j->crowd.stops && w->crowd.n > 0);
}

/* -- Lists ------------------------------------------------------------------------------------- */

/* Appends the sources found, which ascend, to the lists: those of a group. */
static void put(const struct job *j, struct worker *w, size_t group)
{
    struct found *f = &w->found;
    size_t n = f->n[BY_BOTH] + f->n[BY_LOWER] + f->n[BY_UPPER], spans = 0;
    struct rest r = {.at = {0}};
    uint32_t base;

    if (!w->no_memory && crowd_look(j, w, group) &&
        reserve(w, &w->step, &w->step_capacity, w->n_step + n + STEPS_MORE, sizeof *w->step)) {
        for (; j->all->visits ? rest_cut_visits(f, &r, &base) : rest_base(f, &r, &base); spans++) {
            if (!reserve(w, &w->span, &w->span_capacity, w->n_span + 1, sizeof *w->span)) {
                break;
            }
            if (!j->all->visits) {
                rest_cut(f, &r, base);
            }
            put_span(j, w, &r, base);
            memcpy(r.at, r.end, sizeof r.at);
        }
        j->count[group] = spans;
    }
    memset(f->n, 0, sizeof f->n);
}

/* -- Groups ------------------------------------------------------------------------------------ */

/* Eight groups are measured at a time. */
static void group_stretch(struct stretch *s, const struct job *j, struct worker *w, size_t group)
{
    const struct cloud *c = j->dst;
    size_t k = group % LEAF, first = group * LANES;

    if (group / LEAF != w->eight_at) {
        struct points p = {.x = c->x, .h = c->h, .scale = j->scale, .n = c->n, .dim = c->dim};

        j->filter->eight(&w->eight, w->least, &p, group - k);
        w->eight_at = group / LEAF;
    }
    s->first = first;
    s->last = first + LANES < c->n ? first + LANES : c->n;
    s->least = w->least[k];
    s->q.reach = w->eight.reach[k];
    for (int a = 0; a < 3; a++) {
        s->q.lo[a] = w->eight.lo[a][k];
        s->q.hi[a] = w->eight.hi[a][k];
    }
}

/* A group whose lanes are far apart, piece by piece. */
static void group_in_pieces(const struct job *j, struct worker *w, size_t group)
{
    size_t first = group * LANES;
    size_t last = first + LANES < j->dst->n ? first + LANES : j->dst->n;

    while (first < last) {
        struct stretch piece, more, both;
        struct frame f;

        stretch_init(&piece, j, first, first + 1);
        for (size_t i = first + 1; i < last; i++) {
            stretch_init(&more, j, i, i + 1);
            stretch_join(&both, &piece, &more);
            if (!stretch_within(&both, 1)) {
                break;
            }
            piece = both;
        }
        look(j, w, &piece, &f);
        take(j, w, &f, piece.first, piece.last, NO_LEAF);
        first = piece.last;
    }
    if (j->all->visits) {
        found_by_visits(j, w);
    } else {
        found_sort_as_one(j, w);
    }
    put(j, w, group);
}

/* Groups [first, last), which stand close together. */
static void bundle(const struct job *j, struct worker *w, const struct stretch *s, size_t first,
                   size_t last)
{
    struct frame f;

    look(j, w, s, &f);
    for (size_t group = first; group < last; group++) {
        size_t begin = group * LANES, end = begin + LANES;

        take(j, w, &f, begin, end < j->dst->n ? end : j->dst->n, (uint32_t)group);
        if (j->all->visits) {
            found_by_visits(j, w);
        } else if (j->src->order) {
            found_sort(j, w, group);
        }
        put(j, w, group);
    }
}

void worker_make(const struct job *j, struct worker *w, size_t first, size_t last)
{
    struct stretch s, next, both;

    w->eight_at = SIZE_MAX;
    group_stretch(&next, j, w, first);
    for (size_t group = first;
         group < last && !w->no_memory && !(j->crowd.stops && w->crowd.n > 0);) {
        size_t end = group + 1;
        bool whole = stretch_within(&next, SPREAD_MOST);

        s = next;
        for (; end < last; end++) {
            group_stretch(&next, j, w, end);
            stretch_join(&both, &s, &next);
            if (!whole || end - group == BUNDLE_MOST || !stretch_within(&both, BUNDLE_SPREAD)) {
                break;
            }
            s = both;
        }
        if (whole) {
            bundle(j, w, &s, group, end);
        } else {
            group_in_pieces(j, w, group);
        }
        group = end;
    }
}
