/* run/watch_neighbours.c -- the watch over neighbours: particles that have too many, smoothing lengths for which
 * no lists or ghosts can be made. Asked by lists.c while lists are made. */
#include "run/domain.h"
#include "run/foremost.h"
#include "run/watch.h"
#include <float.h>
#include <string.h>

/* Who made the smoothing length as it is: the last that writes it, if it has had its turn yet. */
static const char *writer_of_h(const struct run *r, size_t array)
{
    const struct plan_array *a = &r->plan->array[array];
    const bool later = r->watch->evaluated, begun = r->watch->begun;
    const char *by = later && watch_has_rate(a, a->smoothing) ? WATCH_INTEGRATOR : WATCH_SCENE;
    for (size_t i = 0; i < r->plan->n_pass; i++)
        if ((later || (begun && i <= r->watch->done)) &&
            pass_writes(&r->plan->pass[i], array, a->smoothing))
            by = r->plan->pass[i].name;
    return by;
}

int watch_crowd(struct run *r, size_t k, struct error *e)
{
    const struct overflow *crowd = &r->list[k].crowd;
    const size_t array = r->plan->list[k].dst;
    const struct plan_array *a = &r->plan->array[array];
    const struct sign s = {.cause = WATCH_NEIGHBOURS,
                           .array = a,
                           .particle = crowd->first,
                           .by = writer_of_h(r, array)};
    char who[160];
    if (!crowd->n && !watch_counts_together(r, WATCH_NEIGHBOURS))
        return 0;
    if (watch_counts(r, WATCH_NEIGHBOURS))
        return watch_count(r, &s, crowd->n, e);
    return watch_fail(
        r, &s, e,
        "particle %lld of \"%s\" has %llu neighbours among \"%s\", more than %g, its h set %s,",
        watch_id(a, crowd->first), a->p.name, (unsigned long long)crowd->neighbours,
        r->plan->array[r->plan->list[k].src].p.name, r->watch->scene[WATCH_NEIGHBOURS].limit,
        watch_made_by(who, sizeof who, s.by));
}

/* This rank's particle with the largest smoothing length, or the first whose is no length. */
static struct sign widest(const struct run *r)
{
    struct sign s = {.cause = WATCH_NEIGHBOURS};
    double most = -1.0;
    for (size_t k = 0; k < r->plan->n_array; k++) {
        const struct plan_array *a = &r->plan->array[k];
        for (size_t i = 0; i < a->p.n; i++) {
            const double h = column_get(&a->p.column[a->smoothing], 0, i);
            const bool none = !(h >= 0.0 && h <= DBL_MAX);
            if (!none && !(h > most))
                continue;
            s.array = a;
            s.particle = i;
            s.by = writer_of_h(r, k);
            s.cause = none ? WATCH_NOT_FINITE : WATCH_NEIGHBOURS;
            s.weight = none ? INFINITY : h;
            if (none)
                return s;
            most = h;
        }
    }
    return s;
}

static int tell_h(struct run *r, struct sign s, const char *what, struct error *e)
{
    char who[320];
    const struct plan_array *a = s.array;
    s.column = "h";
    watch_column_made_by(who, sizeof who, r, (size_t)(a - r->plan->array), a->smoothing, s.by);
    return watch_fail(r, &s, e, "h of particle %lld of \"%s\" became %g %s%s,",
                      watch_id(a, s.particle), a->p.name,
                      column_get(&a->p.column[a->smoothing], 0, s.particle), who, what);
}

/* Whether this rank has failed itself: what ends it when another has is not to be explained. */
static bool has_failed(const struct run *r, const struct error *e)
{
    return !r->domain || e->text[0];
}

int watch_no_lists(struct run *r, struct error *e)
{
    const struct sign s = widest(r);
    return s.array && s.cause == WATCH_NOT_FINITE && has_failed(r, e) ? tell_h(r, s, "", e) : -1;
}

static int no_ghosts_for(struct run *r, struct sign s, struct error *e)
{
    return tell_h(r, s, s.cause == WATCH_NEIGHBOURS ? ", as far as the domain is wide" : "", e);
}

int watch_no_ghosts(struct run *r, struct error *e)
{
    const struct sign s = widest(r);
    return s.array && r->watch->evaluated && has_failed(r, e) ? no_ghosts_for(r, s, e) : -1;
}

int watch_too_wide(struct run *r, struct error *e)
{
    const struct sign s = widest(r);
    enum watch_blame blame;
    if (!r->watch->evaluated)
        return -1;
    if (watch_blame(r, &s, &blame, e))
        return -1;
    if (blame == WATCH_THEIRS)
        *e = (struct error){EXIT_RUN, ""};
    return blame == WATCH_OURS ? no_ghosts_for(r, s, e) : -1;
}

/* Who may have too many neighbours, as other ranks must know it. */
struct suspect {
    double x[3], reach;
    uint64_t array;
    bool is_length;
};

/* Of its neighbours those of this rank that are no ghosts. */
static uint64_t real_neighbours(const struct run *r, const struct suspect *q, int64_t id)
{
    uint64_t n = 0;
    for (size_t k = 0; k < r->plan->n_array; k++) {
        const struct plan_array *b = &r->plan->array[k];
        if (!plan_pair(r->plan, (size_t)q->array, k))
            continue;
        for (size_t i = 0; i < b->p.n; i++) {
            double r2 = 0.0;
            for (uint32_t c = 0; c < b->p.column[b->position].ncomp; c++)
                r2 += pow(column_get(&b->p.column[b->position], c, i) - q->x[c], 2);
            n += r2 < q->reach * q->reach && !(q->array == k && watch_id(b, i) == id);
        }
    }
    return n;
}

static struct suspect suspect_of(const struct run *r, const struct sign *s)
{
    struct suspect q = {.is_length = s->cause == WATCH_NEIGHBOURS};
    const struct plan_array *a = s->array;
    if (!a)
        return q;
    q.array = (uint64_t)(a - r->plan->array);
    q.reach = column_get(&a->p.column[a->smoothing], 0, s->particle) * r->plan->kernel.support *
              r->plan->reach_scale;
    for (uint32_t c = 0; c < a->p.column[a->position].ncomp; c++)
        q.x[c] = column_get(&a->p.column[a->position], c, s->particle);
    return q;
}

int watch_reach(struct run *r, double margin, struct error *e)
{
    const struct scene_watch *rule = &r->watch->scene[WATCH_NEIGHBOURS];
    const struct box *box = &r->plan->scene->box;
    bool wide = false;
    for (int c = 0; c < r->plan->dim; c++)
        wide = wide || (box->bounded && box->side[c][0] != SIDE_OPEN &&
                        box->side[c][1] != SIDE_OPEN && 2.0 * margin > box->max[c] - box->min[c]);
    if (!wide || rule->action != WATCH_STOP)
        return 0;
    const struct sign s = widest(r);
    struct suspect q = suspect_of(r, &s);
    struct foremost f = {.key = NAN};
    if (s.array) {
        f.key = s.weight;
        f.id = watch_id(s.array, s.particle);
    }
    if (foremost_find(r, &f, &q, sizeof q, e))
        return -1;
    uint64_t n = f.any && q.is_length ? real_neighbours(r, &q, f.id) : 0;
    if (run_share_count(r, &n, e))
        return -1;
    if (!((double)n > rule->limit))
        return 0;
    char what[96];
    snprintf(what, sizeof what, ", which makes %llu neighbours and more, over %g,",
             (unsigned long long)n, rule->limit);
    return f.mine ? tell_h(r, s, what, e) : -1;
}
