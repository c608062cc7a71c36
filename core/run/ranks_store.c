/* run/ranks_store.c -- a run's state on several ranks, into a checkpoint and out of it: see run_store.h. Each rank
 * writes its real particles and where they stood when the lists were made; ghosts and lists are made again, as they
 * were. Who reads takes what its rank has written if there are as many ranks as then; else about as many particles
 * as the others, from wherever they are, which then go to where the domain is cut anew. */
#include "domain/migrate.h"
#include "run/device.h"
#include "run/domain.h"
#include "run/frames.h"
#include "run/run_store.h"
#include "run/watch.h"
#include <stdlib.h>
#include <string.h>

/* The group of a rank. */
static void enter_rank(struct store *s, size_t rank)
{
    if (rank)
        store_enter(s, "rank", rank);
}

static void leave_rank(struct store *s, size_t rank)
{
    if (rank)
        store_leave(s);
}

/* The number of an array among those of positions' lists. */
static size_t kept_of(const struct run *r, size_t array)
{
    size_t k = 0;
    for (size_t a = 0; a < array; a++)
        k += frame_has(r, 0, a);
    return k;
}

/* -- Writing -------- */

static int shares_store(struct run *r, struct store *s, struct error *e)
{
    const size_t n = r->plan->n_list;
    double *share = calloc(n + 1, sizeof *share);
    if (!share)
        return error_memory(e, "a checkpoint", n * sizeof *share);
    for (size_t k = 0; k < n; k++)
        share[k] = r->list[k].true_share;
    const int status = store_block(s, "true_share", STORE_F64, share, n, e);
    for (size_t k = 0; !status && k < n; k++)
        r->list[k].true_share = share[k];
    free(share);
    return status;
}

static int particles_put(struct run *r, size_t array, bool failed, struct store *s, struct error *e)
{
    struct particles *p = &r->plan->array[array].p;
    const size_t ghosts = p->n_ghost;
    p->n_ghost = 0; /* they are others', and made again */
    store_enter(s, "array", array);
    int status = particles_store(p, s, e);
    store_leave(s);
    p->n_ghost = ghosts;
    if (!status && !failed && !r->device && frame_has(r, 0, array)) {
        const size_t k = kept_of(r, array);
        store_enter(s, "kept", k);
        status = skin_store(&r->kept[k], s, e);
        store_leave(s);
    }
    return status;
}

int ranks_store(struct run *r, struct store *s, bool failed, struct error *e)
{
    int status = run_store_numbers(r, s, e);
    for (size_t a = 0; !status && a < r->plan->n_array; a++)
        status = particles_put(r, a, failed, s, e);
    if (!status && !failed)
        status = shares_store(r, s, e);
    if (!status && run_speaks(r) && r->watch)
        status = watch_store(r, s, e);
    if (!status && run_speaks(r) && !failed)
        status = run_store_states(r, s, e) || partition_store(r->domain->partition, s, e) ? -1 : 0;
    return status;
}

/* -- Numbers -------- */

/* Those who read, and those who have written. */
struct reading {
    struct run *r;
    struct store *s;
    size_t was, ranks, me;  /* ranks then and now */
    struct particles *kept; /* [array]: where they stood when lists were made */
    bool exact;             /* that is known of all */
};

/* What each rank has counted for itself: all of it is told by rank 0 from now on. */
static int sum_costs(struct run *r, struct store *s, size_t was, struct error *e)
{
    const size_t n = r->plan->n_pass;
    struct run_cost all = {0};
    uint64_t *pairs = calloc(n + 1, sizeof *pairs);
    int status = pairs ? 0 : error_memory(e, "a checkpoint", n * sizeof *pairs);
    for (size_t k = 0; !status && run_speaks(r) && k < was; k++) {
        const struct {
            const char *name;
            uint64_t *sum;
        } of[] = {{"particle_updates", &all.particle_updates},
                  {"pairs", &all.pairs},
                  {"unfinished", &all.unfinished},
                  {"created", &all.created}};
        uint64_t here = 0;
        enter_rank(s, k);
        for (size_t q = 0; !status && q < sizeof of / sizeof of[0]; q++) {
            status = store_u64(s, of[q].name, &here, e);
            *of[q].sum += here;
        }
        for (size_t i = 0; !status && i < n; i++) {
            store_enter(s, "pass", i);
            status = store_u64(s, "pairs", &here, e);
            store_leave(s);
            pairs[i] += here;
        }
        leave_rank(s, k);
    }
    r->cost.particle_updates = all.particle_updates;
    r->cost.pairs = all.pairs;
    r->cost.unfinished = all.unfinished;
    r->cost.created = all.created;
    for (size_t i = 0; !status && i < n; i++)
        r->plan->pass[i].pairs = pairs[i];
    free(pairs);
    return status;
}

/* What has been seen in passing of how far particles have moved: of all ranks' together. */
static int merge_changes(struct run *r, struct store *s, size_t was, struct error *e)
{
    const size_t n = r->plan->n_array;
    double *change = calloc(2 * n + 1, sizeof *change);
    bool *has = calloc(n + 1, sizeof *has);
    int status = change && has ? 0 : error_memory(e, "a checkpoint", n * sizeof *change);
    for (size_t k = 0; !status && k < was; k++) {
        enter_rank(s, k);
        status = store_block(s, "change", STORE_F64, change, 2 * n, e) ||
                         store_flags(s, "has_change", has, n, e)
                     ? -1
                     : 0;
        leave_rank(s, k);
        for (size_t a = 0; !status && a < n; a++) {
            const struct skin_change here = {change[2 * a], change[2 * a + 1]};
            r->has_change[a] = has[a] && (k == 0 || r->has_change[a]);
            r->change[a] = k == 0 ? here : skin_both(r->change[a], here);
        }
    }
    free(change);
    free(has);
    return status;
}

static int numbers_restore(const struct reading *q, struct error *e)
{
    struct run *r = q->r;
    const size_t from = q->was == q->ranks ? q->me : 0;
    enter_rank(q->s, from);
    int status = run_store_numbers(r, q->s, e);
    leave_rank(q->s, from);
    if (!status && q->was != q->ranks)
        status = sum_costs(r, q->s, q->was, e);
    return status || watch_store(r, q->s, e) || run_store_states(r, q->s, e) ? -1 : 0;
}

/* -- Particles -------- */

static int kept_open(struct particles *kept, const struct particles *p, struct error *e)
{
    if (particles_init(kept, p->name, p->dim, e) ||
        particles_add(kept, "x", "m", "", SPH_VECTOR, e) < 0 ||
        particles_add(kept, "h", "m", "", SPH_SCALAR, e) < 0)
        return -1;
    for (size_t k = 0; k < kept->n_column; k++)
        kept->column[k].state = true; /* comes along */
    return 0;
}

/* Where particles [first, first + n) of the group's rank stood: those from `at` on. */
static int kept_restore(struct reading *q, size_t array, size_t at, size_t first, size_t n,
                        struct error *e)
{
    struct skin skin = {0};
    const struct particles *kept = &q->kept[array];
    const struct column *x = &kept->column[0], *h = &kept->column[1];
    double *place[3] = {NULL, NULL, NULL};
    store_enter(q->s, "kept", kept_of(q->r, array));
    const int status = skin_store(&skin, q->s, e);
    store_leave(q->s);
    for (uint32_t c = 0; c < x->ncomp; c++)
        place[c] = (double *)x->data + c * x->plane + at;
    if (!status && n)
        q->exact = skin.dim == kept->dim &&
                   skin_places(&skin, first, n, place, (double *)h->data + at) && q->exact;
    skin_fini(&skin);
    return status;
}

/* Particles [begin, end) of an array, counted over all ranks of then one after the other. */
static int rows_restore(struct reading *q, size_t array, const uint64_t *count, uint64_t begin,
                        uint64_t end, struct error *e)
{
    struct run *r = q->r;
    uint64_t low = 0;
    size_t at = 0;
    int status = 0;
    for (size_t k = 0; !status && k < q->was; k++) {
        const uint64_t high = low + count[k];
        const uint64_t from = begin > low ? begin : low, to = end < high ? end : high;
        const size_t n = from < to ? (size_t)(to - from) : 0;
        enter_rank(q->s, k);
        if (n || k == 0) {
            const size_t first = n ? (size_t)(from - low) : 0;
            store_enter(q->s, "array", array);
            status = particles_restore(&r->plan->array[array].p, q->s, at, first, n, e);
            store_leave(q->s);
            if (!status && r->lists_made && !r->device && frame_has(r, 0, array))
                status = kept_restore(q, array, at, first, n, e);
        }
        leave_rank(q->s, k);
        at += n;
        low = high;
    }
    return status;
}

static int array_restore(struct reading *q, size_t array, struct error *e)
{
    struct particles *p = &q->r->plan->array[array].p;
    uint64_t total = 0, *count = calloc(q->was + 1, sizeof *count);
    int status = count ? 0 : error_memory(e, "a checkpoint", q->was * sizeof *count);
    uint64_t begin = 0, end = 0;
    for (size_t k = 0; !status && k < q->was; k++) {
        enter_rank(q->s, k);
        store_enter(q->s, "array", array);
        status = store_u64(q->s, "n", &count[k], e);
        store_leave(q->s);
        leave_rank(q->s, k);
        if (!status && count[k] > UINT32_MAX)
            status = store_broken(q->s, e, "%llu particles", (unsigned long long)count[k]);
        begin = k == q->me ? total : begin;
        total += count[k];
        end = k == q->me ? total : end;
    }
    if (q->was != q->ranks) {
        begin = total / q->ranks * q->me + total % q->ranks * q->me / q->ranks;
        end = total / q->ranks * (q->me + 1) + total % q->ranks * (q->me + 1) / q->ranks;
    }
    if (!status)
        status = particles_resize(p, (size_t)(end - begin), 0, e) ||
                         particles_resize(&q->kept[array], (size_t)(end - begin), 0, e) ||
                         rows_restore(q, array, count, begin, end, e)
                     ? -1
                     : 0;
    free(count);
    return status;
}

/* -- Who has which -------- */

/* With every column, and where they stood. */
static int send_home(struct reading *q, size_t array, const int *owner, struct error *e)
{
    struct particles *p = &q->r->plan->array[array].p;
    size_t sent;
    bool *state = calloc(p->n_column + 1, sizeof *state);
    if (!state)
        return error_memory(e, "particles that move", p->n_column);
    for (size_t k = 0; k < p->n_column; k++) {
        state[k] = p->column[k].state;
        p->column[k].state = true;
    }
    const int status = migrate(q->r->domain->wire, p, owner, &sent, e) ||
                               migrate(q->r->domain->wire, &q->kept[array], owner, &sent, e)
                           ? -1
                           : 0;
    for (size_t k = 0; k < p->n_column; k++)
        p->column[k].state = state[k];
    free(state);
    return status;
}

/* The domain is cut for the particles as they stand; then they go to where they belong. */
static int settle(struct reading *q, struct error *e)
{
    const struct plan *plan = q->r->plan;
    size_t n = 0, at = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += plan->array[a].p.n;
    double *x = malloc(3 * (n + 1) * sizeof *x);
    float *weight = malloc((n + 1) * sizeof *weight);
    int *owner = malloc((n + 1) * sizeof *owner);
    double *const place[3] = {x, x + n + 1, x + 2 * (n + 1)};
    int status = x && weight && owner ? 0 : error_memory(e, "the domain", 3 * n * sizeof *x);
    for (size_t a = 0; !status && a < plan->n_array; a++)
        for (size_t i = 0; i < plan->array[a].p.n; i++, at++) {
            const struct plan_array *pa = &plan->array[a];
            for (int c = 0; c < plan->dim; c++)
                place[c][at] = column_get(&pa->p.column[pa->position], (uint32_t)c, i);
            weight[at] = 1.0f;
        }
    /* What cuts the domain does not hear an alarm. */
    status = run_domain_agree(q->r, status, e);
    if (!status)
        status = partition_cut(q->r->domain->partition, (const double *const *)place, weight, n, e);
    for (size_t i = 0; !status && i < n; i++) {
        double here[3] = {0.0, 0.0, 0.0};
        for (int c = 0; c < plan->dim; c++)
            here[c] = place[c][i];
        owner[i] = partition_owner(q->r->domain->partition, here);
    }
    size_t first = 0;
    for (size_t a = 0; !status && q->was != q->ranks && a < plan->n_array; a++) {
        const size_t mine = plan->array[a].p.n; /* before others' come */
        status = send_home(q, a, owner + first, e);
        first += mine;
    }
    free(x);
    free(weight);
    free(owner);
    return status;
}

/* -- All -------- */

/* What the watch counts in lists it has counted when they were made. */
static int lists_again(struct reading *q, bool counted, struct error *e)
{
    struct watch *w = q->r->watch;
    struct watch_count count[WATCH_CAUSES];
    const size_t bytes = WATCH_CAUSES * q->r->plan->n_array * sizeof *w->here;
    uint64_t *here = malloc(bytes + 1);
    if (!here)
        return error_memory(e, "the watch", bytes);
    memcpy(here, w->here, bytes);
    memcpy(count, w->count, sizeof count);
    const int status = run_lists_again(q->r, q->kept, counted, e);
    memcpy(w->here, here, bytes);
    memcpy(w->count, count, sizeof count);
    free(here);
    return status;
}

static int lists_restore(struct reading *q, struct error *e)
{
    static const uint32_t op = SPH_REDUCE_MIN;
    struct run *r = q->r;
    const bool same = q->was == q->ranks && r->domain;
    double exact = q->exact && !r->device ? 1.0 : 0.0;
    memset(r->frame_made, false, r->plan->n_frame);
    if (run_share_numbers(r, &exact, &op, 1, e))
        return -1;
    if (!r->lists_made)
        return 0;
    r->lists_made = false;
    if (!(exact > 0.0)) {
        r->lists_suspect = true;
        return 0;
    }
    if (lists_again(q, !same, e))
        return -1;
    if (!same)
        return 0;
    enter_rank(q->s, q->me); /* as they were counted then: by this the domain is cut */
    const int status = shares_store(r, q->s, e);
    leave_rank(q->s, q->me);
    return status;
}

static int restore(struct reading *q, struct error *e)
{
    struct run *r = q->r;
    bool cut = false;
    int status = q->kept ? numbers_restore(q, e) : error_memory(e, "a checkpoint", 1);
    for (size_t a = 0; !status && a < r->plan->n_array; a++)
        status = kept_open(&q->kept[a], &r->plan->array[a].p, e) || array_restore(q, a, e) ? -1 : 0;
    if (!status && r->domain && q->was == q->ranks)
        status = partition_restore(r->domain->partition, q->s, &cut, e);
    if (run_domain_agree(r, status, e) || (r->domain && !cut && settle(q, e)) ||
        lists_restore(q, e) || merge_changes(r, q->s, q->was, e))
        return -1;
    return r->device ? run_device_put(r, e) : 0;
}

int ranks_restore(struct run *r, struct store *s, size_t ranks, struct error *e)
{
    struct reading q = {.r = r, .s = s, .was = ranks, .ranks = 1, .exact = true};
    if (r->domain) {
        q.ranks = (size_t)wire_size(r->domain->wire);
        q.me = (size_t)wire_rank(r->domain->wire);
    }
    q.kept = calloc(r->plan->n_array + 1, sizeof *q.kept);
    const int status = restore(&q, e);
    for (size_t a = 0; q.kept && a < r->plan->n_array; a++)
        particles_fini(&q.kept[a]);
    free(q.kept);
    return status;
}
