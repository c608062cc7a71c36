/* run/passes.c -- executes passes: ghosts and mirrors refreshed, what chunks.c does with the destinations,
 * sweeps repeated where a pass iterates, reductions taken. */
#include "run/chunks.h"
#include "run/closing.h"
#include "run/device.h"
#include "run/domain.h"
#include "run/watch.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static int ranges_add(struct ranges *a, uint64_t first, uint64_t count, struct error *e)
{
    if (a->n == a->capacity) {
        size_t capacity = a->capacity ? 2 * a->capacity : 64;
        uint64_t *f = realloc(a->first, capacity * sizeof *f);
        if (f)
            a->first = f;
        uint64_t *c = realloc(a->count, capacity * sizeof *c);
        if (c)
            a->count = c;
        if (!f || !c)
            return error_memory(e, "ranges", capacity * sizeof *f);
        a->capacity = capacity;
    }
    a->first[a->n] = first;
    a->count[a->n++] = count;
    return 0;
}

static void ranges_free(struct ranges *a)
{
    free(a->first);
    free(a->count);
    *a = (struct ranges){0};
}

static int ranges_all(struct ranges *a, uint64_t n, struct error *e)
{
    a->n = 0;
    for (uint64_t first = 0; first < n; first += CHUNK)
        if (ranges_add(a, first, n - first < CHUNK ? n - first : CHUNK, e))
            return -1;
    a->near = a->n;
    return 0;
}

/* The groups with an unfinished destination, neighbours joined up to a chunk. */
static int ranges_unfinished(struct ranges *a, const int32_t *unfinished, uint64_t n,
                             struct error *e)
{
    a->n = 0;
    for (uint64_t g = 0; g < n; g += SPH_LANES) {
        uint64_t end = g + SPH_LANES < n ? g + SPH_LANES : n;
        bool any = false;
        for (uint64_t i = g; i < end; i++)
            any = any || unfinished[i];
        if (!any)
            continue;
        bool joins =
            a->n && a->first[a->n - 1] + a->count[a->n - 1] == g && a->count[a->n - 1] < CHUNK;
        if (joins)
            a->count[a->n - 1] += end - g;
        else if (ranges_add(a, g, end - g, e))
            return -1;
    }
    a->near = a->n;
    return 0;
}

sph_batch run_batch(const struct run *r, const struct use *u, const sph_column *dst,
                    uint32_t n_columns, uint64_t n)
{
    sph_batch b = use_batch(r->plan, u, dst, n_columns, n);
    b.time = r->time;
    b.dt = r->dt;
    b.step = r->step;
    b.run = &r->hooks;
    return b;
}

/* The k-th column of an array that the pass's sweeps read: its own, then places and h; -1: none. */
static int swept(const struct run *r, const struct pass *p, const struct binding *b, uint32_t k)
{
    const struct plan_array *a = &r->plan->array[b->array];
    const uint32_t n = p->use.item->props.count;
    return k == n ? a->position : k > n ? a->smoothing : b->column[k];
}

static int mirror(struct run *r, const struct pass *p, const struct binding *b, struct error *e)
{
    const uint32_t n = p->use.item->props.count + 2;
    for (uint32_t k = 0; p->real == SPH_F32 && k < n; k++)
        if (swept(r, p, b, k) >= 0 && run_mirror(r, b->array, swept(r, p, b, k), e))
            return -1;
    return 0;
}

static int mirrors(struct run *r, const struct pass *p, struct error *e)
{
    for (size_t s = 0; s < p->n_src; s++)
        if (mirror(r, p, &p->src[s], e))
            return -1;
    return mirror(r, p, &p->dst, e);
}

int pass_arrive(struct run *r, const struct pass *p, struct error *e)
{
    return run_domain_finish(r, e) || (p->shape == SPH_PAIR && mirrors(r, p, e)) ? -1 : 0;
}

/* Everything that the sweeps read becomes right: ghosts hold their parents' values, mirrors the columns'. What
 * comes from other ranks has been sent. */
static int refresh_all(struct run *r, const struct pass *p, struct error *e)
{
    const uint32_t n = p->use.item->props.count + 2;
    if (closing_ask(r, p, e))
        return -1;
    for (size_t s = 0; p->shape == SPH_PAIR && s < p->n_src; s++)
        for (uint32_t k = 0; k < n; k++) {
            const int column = swept(r, p, &p->src[s], k);
            if (column >= 0 && run_refresh_ask(r, p->src[s].array, column, e))
                return -1;
        }
    const double begin = omp_get_wtime();
    if (run_domain_begin(r, e))
        return -1;
    if (r->domain) /* as where there are only images */
        r->cost.neighbour += omp_get_wtime() - begin;
    return p->shape == SPH_PAIR ? mirrors(r, p, e) : 0;
}

/* Groups in between those that wait, if they are as few as this, wait as well: short ranges cost more than they
 * save. */
#define GAP 8

/* Which groups wait for what is on its way. */
static bool *find_late(const struct run *r, const struct pass *p, size_t n, struct error *e)
{
    bool *late = malloc((n + 1) * sizeof *late);
    size_t gap = GAP;
    if (!late) {
        error_memory(e, "ranges", n);
        return NULL;
    }
    for (size_t g = 0; g < n; g++) {
        late[g] = run_domain_far(r, p, g);
        for (size_t k = 1; late[g] && gap < GAP && k <= gap; k++)
            late[g - k] = true;
        gap = late[g] ? 0 : gap + 1;
    }
    return late;
}

/* Appends; what goes on from the range before joins it, up to a chunk. */
static int ranges_join(struct ranges *a, size_t begin, uint64_t first, uint64_t count,
                       struct error *e)
{
    const bool joins = a->n > begin && a->first[a->n - 1] + a->count[a->n - 1] == first &&
                       a->count[a->n - 1] + count <= CHUNK;
    if (!joins)
        return ranges_add(a, first, count, e);
    a->count[a->n - 1] += count;
    return 0;
}

/* Of the ranges those first that need nothing of what is on its way. */
static int ranges_part(const struct run *r, const struct pass *p, const struct ranges *all,
                       struct ranges *parted, struct error *e)
{
    const size_t n = (r->plan->array[p->dst.array].p.n + SPH_LANES - 1) / SPH_LANES;
    bool *late = find_late(r, p, n, e);
    int status = late ? 0 : -1;
    for (int far = 0; !status && far < 2; far++) {
        const size_t begin = parted->n;
        for (size_t k = 0; k < all->n; k++) {
            const uint64_t end = all->first[k] + all->count[k];
            for (uint64_t at = all->first[k], next = at; !status && at < end; at = next) {
                const bool is = late[at / SPH_LANES];
                do
                    next += SPH_LANES;
                while (next < end && late[next / SPH_LANES] == is);
                next = next < end ? next : end;
                if (is == far)
                    status = ranges_join(parted, begin, at, next - at, e);
            }
        }
        parted->near = far ? parted->near : parted->n;
    }
    free(late);
    return status;
}

/* While messages are on their way, if the pass can go on without. */
static int run_chunks(struct run *r, struct pass *p, const struct ranges *all, struct error *e)
{
    struct ranges parted = {0};
    const bool waits = run_domain_waits(r);
    if (!waits || !p->local || p->shape != SPH_PAIR)
        return (waits && pass_arrive(r, p, e)) || chunks_run(r, p, all, e) ? -1 : 0;
    int status = ranges_part(r, p, all, &parted, e);
    /* Many short ranges cost more than waiting does. */
    const bool short_ones = parted.n > 2 * all->n + 8;
    if (!status)
        status =
            (short_ones && pass_arrive(r, p, e)) || chunks_run(r, p, short_ones ? all : &parted, e)
                ? -1
                : 0;
    ranges_free(&parted);
    return !status && run_domain_waits(r) ? pass_arrive(r, p, e) : status;
}

/* What the pass has written is old in ghosts and mirrors; a changed h or place makes the lists suspect. */
static void mark_written(struct run *r, const struct pass *p)
{
    const struct plan_array *a = &r->plan->array[p->dst.array];
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        int c = p->dst.column[k];
        if (c < 0 || !pass_writes(p, p->dst.array, c))
            continue;
        run_changed(r, p->dst.array, c);
        if (c == a->smoothing || c == a->position)
            r->lists_suspect = true;
    }
}

static int sweep(struct run *r, struct pass *p, const struct ranges *ranges, struct error *e)
{
    if (p->shape == SPH_PAIR && r->lists_suspect && run_lists(r, true, e))
        return -1;
    if ((p->shape == SPH_PAIR && run_frame(r, p->frame, e)) || refresh_all(r, p, e))
        return -1;
    /* What arrives is no doing of the pass. */
    if (r->audit && run_domain_waits(r) && pass_arrive(r, p, e))
        return -1;
    audit_begin(r, p);
    int status = run_chunks(r, p, ranges, e);
    if (audit_end(r, p, status ? NULL : e))
        status = -1;
    mark_written(r, p);
    return status;
}

static void count_pairs(struct run *r, struct pass *p, const struct ranges *ranges)
{
    p->sweeps++;
    for (size_t s = 0; p->shape == SPH_PAIR && s < p->n_src; s++) {
        const struct group_list *list = &r->list[p->list[s]];
        uint64_t entries = 0;
        for (size_t k = 0; k < ranges->n; k++) {
            uint64_t g = ranges->first[k] / SPH_LANES;
            uint64_t end = (ranges->first[k] + ranges->count[k] + SPH_LANES - 1) / SPH_LANES;
            entries += group_list_entries(list, g, end);
        }
        uint64_t pairs = (uint64_t)(list->true_share * (double)entries);
        p->pairs += pairs;
        r->cost.pairs += pairs;
    }
}

static int run_pass(struct run *r, struct pass *p, struct error *e)
{
    const struct particles *particles = &r->plan->array[p->dst.array].p;
    double begin = omp_get_wtime(), other = r->cost.neighbour;
    struct ranges ranges = {0};
    int status = chunks_prepare(r, p, e);
    if (!status)
        status = ranges_all(&ranges, particles->n, e);
    uint64_t wanted = particles->n > 0 || r->domain;
    for (uint32_t k = 0; !status && wanted; k++) {
        status = sweep(r, p, &ranges, e);
        if (status)
            break;
        count_pairs(r, p, &ranges);
        if (!p->max_sweeps)
            break;
        status = ranges_unfinished(&ranges, particles->column[p->unfinished].data, particles->n, e);
        wanted = ranges.n;
        if (status || run_share_count(r, &wanted, e)) {
            status = -1;
            break;
        }
        if (k + 1 >= p->max_sweeps) {
            r->cost.unfinished += ranges.n;
            break;
        }
    }
    ranges_free(&ranges);
    r->watch->done = (size_t)(p - r->plan->pass) + 1;
    if (!status && (r->look || r->audit))
        status = finite_pass(r, p, e);
    if (!status)
        status = watch_pass(r, p, e);
    p->seconds += omp_get_wtime() - begin - (r->cost.neighbour - other);
    return status;
}

/* Right after its pass, but for what that has reduced itself. */
static int reduce_pass(struct run *r, size_t pass, struct error *e)
{
    const struct pass *p = &r->plan->pass[pass];
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        if (d->pass != pass)
            continue;
        const bool done = closing_reduces(p, d) && r->plan->array[d->array].p.n > 0;
        if (!done && run_reduce(r, d, &r->reduced[i], e))
            return -1;
        if (r->plan->strict)
            r->reduced[i] += 0.0; /* a zero has no sign: it would be that of whoever came first */
    }
    return 0;
}

/* Whether all ranks have it as soon as its pass is done, or when those of passes [first, end) of a moment are
 * shared. */
static bool waits_to_be_shared(const struct run *r, const struct reduction *d, enum moment moment,
                               size_t first, size_t end)
{
    return d->pass != NO_PASS && d->pass >= first && d->pass < end &&
           r->plan->pass[d->pass].moment == moment && !reduced_exactly(r->plan, d);
}

/* A step that stands later in the recipe may ask for what earlier ones came to (reductions.h). */
static bool may_ask(const struct run *r, enum moment moment, size_t first, size_t pass)
{
    const struct pass *p = &r->plan->pass[pass];
    for (size_t i = 0; r->domain && p->function && i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        if (waits_to_be_shared(r, d, moment, first, pass) &&
            r->plan->pass[d->pass].function != p->function)
            return true;
    }
    return false;
}

/* Those of passes [first, end) of a moment, of all ranks; behind the last of an evaluation also whether any rate may
 * be none. */
static int share_reduced(struct run *r, enum moment moment, size_t first, size_t end,
                         struct error *e)
{
    const size_t n = r->plan->n_reduction;
    const bool last = end == r->plan->n_pass && moment == MOMENT_EVALUATE;
    double *value = malloc((n + 1) * sizeof *value);
    uint32_t *op = malloc((n + 1) * sizeof *op);
    int status = value && op ? 0 : error_memory(e, "reductions", n * sizeof *value);
    size_t used = 0, k = 0;
    for (size_t i = 0; !status && i < n; i++)
        if (waits_to_be_shared(r, &r->plan->reduction[i], moment, first, end)) {
            value[used] = r->reduced[i];
            op[used++] = r->plan->reduction[i].declared->op;
        }
    if (!status && last) {
        value[used] = r->suspect ? 1.0 : 0.0;
        op[used] = SPH_REDUCE_MAX;
    }
    if (!status)
        status = run_share_numbers(r, value, op, used + last, e);
    for (size_t i = 0; !status && i < n; i++)
        if (waits_to_be_shared(r, &r->plan->reduction[i], moment, first, end))
            r->reduced[i] = value[k++];
    if (!status && last)
        r->suspect = value[used] > 0.0;
    free(op);
    free(value);
    return status;
}

void run_bound_dt(struct run *r)
{
    r->dt_bound = INFINITY;
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        if (d->declared->use == SPH_USE_TIME_STEP && !isnan(r->dt_bound) &&
            !(r->reduced[i] >= r->dt_bound))
            r->dt_bound = r->reduced[i]; /* a NaN stays */
    }
}

int run_passes(struct run *r, enum moment moment, struct error *e)
{
    if (r->device)
        return run_device_passes(r, moment, e);
    r->watch->done = 0;
    if (moment == MOMENT_EVALUATE && watch_state(r, e))
        return -1;
    if (moment != MOMENT_FINISH && run_lists(r, false, e))
        return -1;
    size_t shared = 0;
    for (size_t i = 0; i < r->plan->n_pass; i++) {
        if (r->plan->pass[i].moment != moment)
            continue;
        if (may_ask(r, moment, shared, i)) {
            if (share_reduced(r, moment, shared, i, e))
                return -1;
            shared = i;
        }
        if (run_pass(r, &r->plan->pass[i], e))
            return -1;
        if (reduce_pass(r, i, e))
            return -1;
    }
    if (r->domain && share_reduced(r, moment, shared, r->plan->n_pass, e))
        return -1;
    if (moment != MOMENT_EVALUATE)
        return 0;
    run_bound_dt(r);
    if (finite_rates(r, e))
        return -1;
    r->watch->sorted = false;
    r->watch->evaluated = true;
    return 0;
}
