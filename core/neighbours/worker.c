/* neighbours/worker.c -- finds the sources of a run of groups. Reads the job, writes its worker
 * and the counts of its groups.
 *
 * Groups that stand side by side share one walk through the tree of boxes and one copy of the
 * leaves found, in single precision relative to their common centre (a bundle). Each group then
 * takes from that first the leaves, then the points that it sees. A group whose lanes are far
 * apart is taken in pieces. Lists come out ascending, for the tree is walked in order; only
 * pieces, and sources that stand in an order of the tree's own, are sorted, by setting bits. */
#include "neighbours/worker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BUNDLE_MOST 16    /* groups in a bundle */
#define BUNDLE_SPREAD 5.0 /* half the diagonal of a bundle's box, in units of its smallest reach */
#define UNIFORM 1.004f    /* reaches of a group that differ less are taken as one */

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
    w->chosen = malloc((capacity + BOXES_FAN) * sizeof *w->chosen);
    w->pack = aligned_alloc(64, capacity * sizeof *w->pack);
    w->box = aligned_alloc(64, capacity / BOXES_FAN * sizeof *w->box);
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
    free(w->found);
    free(w->leaf);
    free(w->chosen);
    free(w->pack);
    free(w->box);
    free(w->bits);
    free(w->summary);
}

/* -- Sorting a list by setting bits ------------------------------------------------------------ */

/* Sorts list[0..n) ascending, without repeats; the number that is left. All bits are zero before
 * and after. */
static size_t sort_unique(struct worker *w, size_t n_source, uint32_t *list, size_t n)
{
    size_t words = n_source / 64 + 1, first = SIZE_MAX, last = 0, left = 0;

    if (!w->bits) {
        w->bits = calloc(words, sizeof *w->bits);
        w->summary = calloc(words / 64 + 1, sizeof *w->summary);
        if (!w->bits || !w->summary) {
            w->no_memory = true;
            return 0;
        }
    }
    for (size_t k = 0; k < n; k++) {
        size_t word = list[k] / 64, block = word / 64;

        w->bits[word] |= 1ull << list[k] % 64;
        w->summary[block] |= 1ull << word % 64;
        first = block < first ? block : first;
        last = block > last ? block : last;
    }
    for (size_t block = first; block <= last && n > 0; block++) {
        for (uint64_t blocks = w->summary[block]; blocks; blocks &= blocks - 1) {
            size_t word = block * 64 + (size_t)__builtin_ctzll(blocks);

            for (uint64_t bits = w->bits[word]; bits; bits &= bits - 1) {
                list[left++] = (uint32_t)(word * 64) + (uint32_t)__builtin_ctzll(bits);
            }
            w->bits[word] = 0;
        }
        w->summary[block] = 0;
    }
    return left;
}

/* -- Stretches ------------------------------------------------------------------------------------- */

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

/* Half the diagonal of the box. */
static double stretch_radius(const struct stretch *s)
{
    double sum = 0;

    for (int a = 0; a < 3; a++) {
        double d = s->q.hi[a] - s->q.lo[a];

        sum += d * d;
    }
    return sqrt(sum) / 2;
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

/* -- The walk ---------------------------------------------------------------------------------- */

/* Appends the leaves below a block of sisters that are near the query, in order. */
static void walk(const struct job *j, struct worker *w, const struct query *q, int level,
                 size_t block)
{
    unsigned mask = j->filter->near_boxes(&j->tree.level[level][block], q, j->tree.dim);

    if (level == 0 && !leaf_reserve(w, w->n_leaf + BOXES_FAN)) {
        return;
    }
    for (; mask; mask &= mask - 1) {
        size_t node = block * BOXES_FAN + (size_t)__builtin_ctz(mask);

        if (node >= j->tree.n_node[level]) {
            return; /* a box without points: a reach beyond measure */
        }
        if (level > 0) {
            walk(j, w, q, level - 1, node);
        } else {
            w->leaf[w->n_leaf++] = (uint32_t)node;
        }
    }
}

/* -- Single precision -------------------------------------------------------------------------- */

static void frame_init(struct frame *f, const struct job *j, const struct stretch *s)
{
    double unit = s->q.reach;

    if (!(unit > 0)) {
        unit = j->tree.level[j->tree.n_level - 1][0].reach[0];
    }
    f->inverse = unit > 0 ? 1 / unit : 1;
    for (int a = 0; a < 3; a++) {
        f->centre[a] = s->q.lo[a] + (s->q.hi[a] - s->q.lo[a]) / 2;
    }
}

/* Leaf k of the bundle's pack. */
static void pack_box(const struct job *j, const struct frame *f, uint32_t leaf,
                     struct packed_box8 *pack, size_t k)
{
    const struct box8 *from = &j->tree.level[0][leaf / BOXES_FAN];
    struct packed_box8 *to = &pack[k / BOXES_FAN];
    size_t q = leaf % BOXES_FAN, p = k % BOXES_FAN;

    for (int a = 0; a < j->tree.dim; a++) {
        to->lo[a][p] = (float)((from->lo[a][q] - f->centre[a]) * f->inverse);
        to->hi[a][p] = (float)((from->hi[a][q] - f->centre[a]) * f->inverse);
    }
    to->reach[p] = (float)(from->reach[q] * f->inverse);
}

/* Finds and packs the leaves near a span. */
static void look(const struct job *j, struct worker *w, const struct stretch *s, struct frame *f)
{
    w->n_leaf = 0;
    walk(j, w, &s->q, j->tree.n_level - 1, 0);
    if (w->no_memory) {
        w->n_leaf = 0;
        return;
    }
    frame_init(f, j, s);
    for (size_t k = 0; k < w->n_leaf; k++) {
        j->filter->pack(&w->pack[k], &j->tree, f, w->leaf[k]);
        pack_box(j, f, w->leaf[k], w->box, k);
    }
    for (size_t k = w->n_leaf; k % BOXES_FAN; k++) {
        struct packed_box8 *none = &w->box[k / BOXES_FAN];

        for (int a = 0; a < 3; a++) {
            none->lo[a][k % BOXES_FAN] = INFINITY;
            none->hi[a][k % BOXES_FAN] = -INFINITY;
        }
        none->reach[k % BOXES_FAN] = 0;
    }
}

static void lanes_init(struct lanes *t, const struct job *j, const struct frame *f, size_t first,
                       size_t last)
{
    const struct cloud *c = j->dst;
    float least = INFINITY;

    memset(t, 0, sizeof *t);
    for (size_t i = 0; i < LANES; i++) {
        size_t k = first + i < last ? first + i : last - 1;
        double a2 = 0;

        for (int a = 0; a < c->dim; a++) {
            double x = (c->x[a][k] - f->centre[a]) * f->inverse;
            float near = (float)x;

            t->m2a[a][i] = -2 * near;
            a2 += x * x;
            t->lo[a] = i == 0 || near < t->lo[a] ? near : t->lo[a];
            t->hi[a] = i == 0 || near > t->hi[a] ? near : t->hi[a];
        }
        t->a2[i] = (float)a2;
        float reach = (float)(j->scale * c->h[k] * f->inverse);

        t->r2[i] = reach * reach;
        t->reach = reach > t->reach ? reach : t->reach;
        least = reach < least ? reach : least;
    }
    /* The filter is a third faster with one reach for all, so that a little more is worth it. */
    t->uniform = t->reach <= UNIFORM * least;
}

/* Appends the sources that destinations [first, last), at most a group, see of the packed
 * leaves. */
static void take(const struct job *j, struct worker *w, const struct frame *f, size_t first,
                 size_t last)
{
    struct lanes t;
    size_t n, found;

    if (w->n_leaf == 0) {
        return;
    }
    lanes_init(&t, j, f, first, last);
    n = j->filter->near_leaves(w->box, w->n_leaf, &t, j->tree.dim, w->chosen);
    if (!reserve(w, &w->found, &w->found_capacity, w->n_found + BOXES_FAN * n + STEPS_MORE,
                 sizeof *w->found)) {
        return;
    }
    found = j->filter->near_points(w->pack, w->leaf, w->chosen, n, &t, j->tree.dim,
                                   w->found + w->n_found);
    for (size_t k = w->n_found; j->tree.order && k < w->n_found + found; k++) {
        w->found[k] = j->tree.order[w->found[k]];
    }
    w->n_found += found;
    w->candidates += n * BOXES_FAN * LANES;
}

/* Appends the sources found, which ascend, to the lists: those of a group. */
static void put(const struct job *j, struct worker *w, size_t group)
{
    const uint32_t *found = w->found;
    size_t n = w->n_found, spans = 0;

    w->n_found = 0;
    if (w->no_memory ||
        !reserve(w, &w->step, &w->step_capacity, w->n_step + n + STEPS_MORE, sizeof *w->step)) {
        return;
    }
    for (size_t k = 0, end; k < n; k = end, spans++) {
        uint32_t base = found[k];

        end = n;
        if (found[n - 1] - base > UINT16_MAX) {
            for (end = k + 1; found[end] - base <= UINT16_MAX; end++) {
            }
        }
        if (!reserve(w, &w->span, &w->span_capacity, w->n_span + 1, sizeof *w->span)) {
            return;
        }
        w->span[w->n_span++] = (sph_span){w->n_step, base, (uint32_t)(end - k)};
        j->filter->steps(w->step + w->n_step, found + k, end - k, base);
        w->n_step += end - k;
    }
    j->count[group] = spans;
}

/* -- Groups ------------------------------------------------------------------------------------ */

static void group_stretch(struct stretch *s, const struct job *j, size_t group)
{
    size_t first = group * LANES, n = j->dst->n;

    stretch_init(s, j, first, first + LANES < n ? first + LANES : n);
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
            if (stretch_radius(&both) > both.least) {
                break;
            }
            piece = both;
        }
        look(j, w, &piece, &f);
        take(j, w, &f, piece.first, piece.last);
        first = piece.last;
    }
    w->n_found = sort_unique(w, j->tree.n, w->found, w->n_found);
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

        take(j, w, &f, begin, end < j->dst->n ? end : j->dst->n);
        if (j->tree.order) {
            w->n_found = sort_unique(w, j->tree.n, w->found, w->n_found);
        }
        put(j, w, group);
    }
}

void worker_make(const struct job *j, struct worker *w, size_t first, size_t last)
{
    struct stretch s, next, both;

    group_stretch(&next, j, first);
    for (size_t group = first; group < last && !w->no_memory;) {
        size_t end = group + 1;
        bool whole = stretch_radius(&next) <= SPREAD_MOST * next.least;

        s = next;
        for (; end < last; end++) {
            group_stretch(&next, j, end);
            stretch_join(&both, &s, &next);
            if (!whole || end - group == BUNDLE_MOST ||
                stretch_radius(&both) > BUNDLE_SPREAD * both.least) {
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
