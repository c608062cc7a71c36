/* run/watch_ranks.c -- what the watch counts, and whose particle is to blame, over all ranks. Every rank makes the
 * same calls; one that finds itself alone at fault fails alone, and the others hear of it where they next wait. */
#include "run/domain.h"
#include "run/foremost.h"
#include "run/watch.h"
#include <stdlib.h>
#include <string.h>

bool watch_counts(const struct run *r, enum watch_cause cause)
{
    return r->watch->scene[cause].action == WATCH_COUNT;
}

bool watch_counts_together(const struct run *r, enum watch_cause cause)
{
    return r->domain && watch_counts(r, cause);
}

/* A failure as ranks can share it. */
struct record {
    double x[3], time;
    int64_t particle;
    uint64_t step, cause, array; /* array: + 1; 0: none */
    char pass[sizeof((struct failure *)NULL)->pass];
};

static struct record record_of(const struct run *r, const struct failure *f)
{
    struct record q = {.time = f->time,
                       .particle = f->particle,
                       .step = f->step,
                       .cause = f->cause,
                       .array = f->array ? (uint64_t)(f->array - r->plan->array) + 1 : 0};
    memcpy(q.x, f->x, sizeof q.x);
    memcpy(q.pass, f->pass, sizeof q.pass);
    return q;
}

static struct failure failure_of(const struct run *r, const struct record *q)
{
    struct failure f = {.happened = true,
                        .time = q->time,
                        .particle = q->particle,
                        .step = q->step,
                        .cause = (enum watch_cause)q->cause,
                        .array = q->array ? &r->plan->array[q->array - 1] : NULL};
    memcpy(f.x, q->x, sizeof f.x);
    memcpy(f.pass, q->pass, sizeof f.pass);
    return f;
}

static int record_first(struct run *r, const struct sign *s, bool any, struct error *e)
{
    struct foremost f = {.key = any ? s->weight : NAN};
    struct record q = {.time = 0.0};
    if (any) {
        const struct failure own = watch_record(r, s);
        q = record_of(r, &own);
        f.id = own.particle;
    }
    if (foremost_find(r, &f, &q, sizeof q, e))
        return -1;
    if (f.any)
        r->watch->count[s->cause].first = failure_of(r, &q);
    return 0;
}

int watch_count(struct run *r, const struct sign *s, uint64_t n, struct error *e)
{
    struct watch *w = r->watch;
    const size_t array = s->array ? (size_t)(s->array - r->plan->array) : 0;
    uint64_t *here = &w->here[(size_t)s->cause * r->plan->n_array + array], all = n;
    if (run_share_count(r, &all, e))
        return -1;
    *here = all > *here ? all : *here;
    return all && !w->count[s->cause].first.happened ? record_first(r, s, n > 0, e) : 0;
}

int watch_blame(const struct run *r, const struct sign *s, enum watch_blame *out, struct error *e)
{
    struct foremost f = {.key = NAN};
    if (s->array) {
        f.key = s->weight;
        f.id = watch_id(s->array, s->particle);
    }
    if (foremost_find(r, &f, NULL, 0, e))
        return -1;
    *out = !f.any ? WATCH_NOBODY : f.mine ? WATCH_OURS : WATCH_THEIRS;
    return 0;
}

int watch_count_event(struct run *r, const struct sign *s, enum watch_blame blame, struct error *e)
{
    return watch_count(r, s, blame == WATCH_OURS || (blame == WATCH_NOBODY && run_speaks(r)), e);
}

/* Of several that failed at once the first rank's, as of their sentences (ranks_agree). */
int watch_share_failure(struct run *r, struct error *e)
{
    struct watch *w = r->watch;
    if (!r->domain)
        return 0;
    const int rank = wire_rank(r->domain->wire);
    struct foremost f = {.key = w->failure.happened ? 0.0 : NAN, .id = rank};
    struct record q = record_of(r, &w->failure);
    if (foremost_find(r, &f, &q, sizeof q, e))
        return -1;
    if (f.any && !w->failure.happened)
        watch_forget(r);
    if (f.any)
        w->failure = failure_of(r, &q);
    return 0;
}
