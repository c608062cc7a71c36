/* run/device.c -- the device of a run: opened and closed, columns carried to it and back, passes and the
 * integrator's operations launched. Data stay there; what comes back at every evaluation is a handful of
 * numbers. */
#include "run/device.h"
#include "run/domain.h"

#include "plan/device_memory.h"
#include "run/chunks.h"
#include "run/domain.h"
#include "run/watch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- Open, close -------- */

static int make_stages(struct run *r, struct error *e)
{
    struct run_device *d = r->device;

    for (int m = 0; m < MOMENT_COUNT; m++) {
        struct stage *stage, *all;
        size_t n;
        if (stages_plan(r->plan, (enum moment)m, r->plan->scene->scheme.fuse, &stage, &n, e))
            return -1;
        all = realloc(d->stage, (d->first[m] + n + 1) * sizeof(*all));
        if (!all) {
            stages_free(stage, n);
            return error_memory(e, "the stages", n * sizeof(*all));
        }
        d->stage = all;
        memcpy(all + d->first[m], stage, n * sizeof(*stage));
        free(stage);
        d->first[m + 1] = d->first[m] + n;
    }
    return 0;
}

static int make_tables(struct run *r, struct error *e)
{
    struct run_device *d = r->device;
    const struct plan *plan = r->plan;
    const size_t n = plan->n_array;

    d->arena = calloc(n + 1, sizeof(*d->arena));
    d->ghosts = calloc(n + 1, sizeof(*d->ghosts));
    d->skin = calloc(n * plan->n_frame + 1, sizeof(*d->skin));
    d->list = calloc(plan->n_list + 1, sizeof(*d->list));
    d->share = calloc(plan->n_list + 1, sizeof(*d->share));
    d->slot = malloc((plan->n_reduction + 1) * sizeof(*d->slot));
    if (!d->arena || !d->ghosts || !d->skin || !d->list || !d->share || !d->slot)
        return error_memory(e, "the run on a device", n * sizeof(*d->arena));
    for (size_t i = 0; i < plan->n_reduction; i++)
        d->slot[i] = NO_SLOT;
    return 0;
}

int run_device_open(struct run *r, struct error *e)
{
    const struct plan *plan = r->plan;
    struct run_device *d = r->device = calloc(1, sizeof(*d));

    if (!d)
        return error_memory(e, "the run on a device", sizeof(*d));
    if (run_device_choose(r, e) || device_open_part(&d->d, d->number, (unsigned)r->threads, e) ||
        make_tables(r, e) || make_stages(r, e) || ops_open(&d->ops, d->d, plan->dim, e) ||
        ops_need_sides(d->ops, &plan->scene->box, e) || look_open(&d->look, d->d, plan->dim, e) ||
        device_search_open(&d->search, d->d, plan->dim, plan->manager, e) ||
        run_device_domain_open(r, e))
        return -1;
    for (size_t a = 0; a < plan->n_array; a++)
        if (arena_init(&d->arena[a], d->d, &plan->array[a].p, e) ||
            (plan->array[a].p.n && arena_room(&d->arena[a], plan_ghosts(plan, a), e)))
            return -1;
    return run_device_cost_open(r, e) || kernels_make(&d->kernels, d->d, plan, d->arena, d->stage,
                                                      d->first[MOMENT_COUNT], e)
               ? -1
               : 0;
}

void run_device_close(struct run *r)
{
    struct run_device *d = r->device;
    const size_t n = r->plan ? r->plan->n_array : 0;

    if (!d)
        return;
    kernels_free(d->kernels);
    run_device_cost_close(r);
    run_device_domain_close(r);
    for (size_t k = 0; d->list && k < r->plan->n_list; k++)
        device_list_release(d->d, &d->list[k]);
    for (size_t k = 0; d->skin && d->ops && k < n * r->plan->n_frame; k++)
        ops_skin_release(d->ops, &d->skin[k]);
    for (size_t a = 0; a < n; a++) {
        if (d->ghosts && d->ops)
            ops_ghosts_release(d->ops, &d->ghosts[a]);
        if (d->arena)
            arena_fini(&d->arena[a]);
    }
    device_search_close(d->search);
    look_close(d->look);
    ops_close(d->ops);
    device_close(d->d);
    stages_free(d->stage, d->first[MOMENT_COUNT]);
    free(d->arena);
    free(d->ghosts);
    free(d->skin);
    free(d->list);
    free(d->share);
    free(d->slot);
    free(d);
    r->device = NULL;
}

/* -- Columns -------- */

int run_device_get(struct run *r, size_t array, int column, struct error *e)
{
    return arena_get(&r->device->arena[array], column, e);
}

int run_device_fetch(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++)
        for (size_t c = 0; c < r->plan->array[a].p.n_column; c++)
            if (run_device_get(r, a, (int)c, e))
                return -1;
    return 0;
}

int run_device_put(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct arena *arena = &r->device->arena[a];
        r->device->ghosts[a].n = 0;
        if (arena_resize(arena, r->plan->array[a].p.n, 0, e))
            return -1;
        for (size_t c = 0; c < r->plan->array[a].p.n_column; c++) {
            arena_written_there(arena, (int)c);
            r->stale[a][c] = false;
            r->mirror_old[a][c] = MIRROR_OLD;
        }
    }
    return 0;
}

/* The mirror of a column, where sweeps read one. */
static int mirror(struct run *r, size_t array, int column, struct error *e)
{
    struct arena *arena = &r->device->arena[array];
    int status;

    if (arena->place[column].mirror < 0 || r->mirror_old[array][column] == MIRROR_FRESH)
        return 0;
    status = column == r->plan->array[array].position
                 ? ops_mirror_places(r->device->ops, arena, column, r->centre, r->quantum, e)
                 : ops_mirror(r->device->ops, arena, column, e);
    r->mirror_old[array][column] = MIRROR_FRESH;
    return status;
}

/* In two rounds: what other ranks have to send comes in between. */
enum round { COLUMNS, MIRRORS };

static int column_here(struct run *r, size_t array, int column, bool source, bool mirrored,
                       enum round round, struct error *e)
{
    if (column < 0)
        return 0;
    if (round == MIRRORS)
        return mirrored ? mirror(r, array, column, e) : 0;
    return arena_put(&r->device->arena[array], column, e) ||
                   (source && run_device_refresh(r, array, column, e))
               ? -1
               : 0;
}

/* -- A stage -------- */

/* All that the columns of a binding must hold before its pass runs. Of destinations sweeps read the position alone
 * in a mirror, of sources all that they read (kernels_sweep.c). */
static int binding_here(struct run *r, const struct pass *p, const struct binding *b, bool source,
                        enum round round, struct error *e)
{
    const struct plan_array *a = &r->plan->array[b->array];
    const bool mirrored = p->real == SPH_F32;

    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        const bool read = source && (prop->access & SPH_SRC_READ);
        if (column_here(r, b->array, b->column[k], source, mirrored && read, round, e))
            return -1;
    }
    if (p->shape == SPH_POINT)
        return 0;
    if (p->frame && column_here(r, b->array, particles_find(&a->p, r->plan->frame[p->frame].name),
                                source, false, round, e))
        return -1;
    return column_here(r, b->array, a->position, source, mirrored, round, e) ||
                   column_here(r, b->array, a->smoothing, source, mirrored && source, round, e)
               ? -1
               : 0;
}

static int bindings_here(struct run *r, const struct stage *s, enum round round, struct error *e)
{
    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = &r->plan->pass[s->pass[k]];
        for (size_t q = 0; q < p->n_src; q++)
            if (binding_here(r, p, &p->src[q], true, round, e))
                return -1;
        if (binding_here(r, p, &p->dst, false, round, e))
            return -1;
    }
    return 0;
}

static int make_ready(struct run *r, const struct stage *s, struct error *e)
{
    return bindings_here(r, s, COLUMNS, e) || run_device_trade(r, e) ||
                   bindings_here(r, s, MIRRORS, e)
               ? -1
               : 0;
}

/* A changed h or place makes the lists suspect. */
static void mark_written(struct run *r, const struct stage *s)
{
    const struct plan_array *a = &r->plan->array[s->array];

    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = &r->plan->pass[s->pass[k]];
        for (uint32_t i = 0; i < p->use.item->props.count; i++) {
            const int c = p->dst.column[i];
            if (c < 0 || !pass_writes(p, s->array, c))
                continue;
            run_device_changed(r, s->array, c);
            if (c == a->smoothing || c == a->position)
                r->lists_suspect = true;
        }
    }
}

static bool has_pairs(const struct run *r, const struct stage *s)
{
    return s->n_head < s->n && r->plan->pass[s->pass[s->n_head]].shape == SPH_PAIR;
}

static bool is_uniform(const struct run *r)
{
    double low = INFINITY, high = 0.0;

    for (size_t a = 0; a < r->plan->n_array; a++) {
        low = fmin(low, r->h_low[a]);
        high = fmax(high, r->h_high[a]);
    }
    return r->h_fixed && !(low < high);
}

static int sweep(struct run *r, size_t k, uint32_t number, struct error *e)
{
    const struct stage *s = &r->device->stage[k];

    if (has_pairs(r, s) &&
        ((r->lists_suspect && run_device_lists(r, true, e)) || run_device_frame(r, s->frame, e)))
        return -1;
    /* New lists may have brought another quantum. */
    const struct kernel_now now = {.time = r->time,
                                   .dt = r->dt,
                                   .step = r->step,
                                   .quantum = r->quantum,
                                   .uniform_h = is_uniform(r),
                                   .sweep = number};
    if (make_ready(r, s, e))
        return -1;
    const size_t before = device_span(r->device->d, SPAN_STAGES + 2 * k);
    const int status =
        kernels_launch(r->device->kernels, k, r->device->arena, r->device->list, &now, e);
    device_span(r->device->d, before);
    r->device->work[k].sweeps++;
    mark_written(r, s);
    return status;
}

/* Sweeps until none of its destinations asks for another, on any rank. */
static int iterate(struct run *r, size_t k, struct error *e)
{
    const struct stage *s = &r->device->stage[k];
    const struct pass *p = &r->plan->pass[s->pass[0]];
    const struct arena *arena = &r->device->arena[s->array];
    const uint64_t all = (arena->n + SPH_LANES - 1) / SPH_LANES;
    uint64_t busy = all, wanted = all > 0 || run_shared(r);

    for (uint32_t number = 0; wanted > 0; number++) {
        if (sweep(r, k, number, e))
            return -1;
        run_device_count(r, k, all ? (double)busy / (double)all : 0.0);
        if (look_groups(r->device->look, arena, p->unfinished, &busy, e))
            return -1;
        wanted = busy;
        if (run_share_count(r, &wanted, e))
            return -1;
        if (number + 1 >= p->max_sweeps) {
            r->cost.unfinished += busy;
            break;
        }
    }
    return 0;
}

/* They are taken while later stages run. */
static int begin_reductions(struct run *r, const struct stage *s, struct error *e)
{
    struct run_device *d = r->device;

    for (size_t k = 0; k < s->n; k++)
        for (size_t i = 0; i < r->plan->n_reduction; i++) {
            const struct reduction *q = &r->plan->reduction[i];
            const struct plan_array *a = &r->plan->array[q->array];
            const uint32_t use = q->declared->use;
            const bool weighted = use == SPH_USE_INTERNAL || use == SPH_USE_POTENTIAL;
            if (q->pass != s->pass[k] || d->slot[i] != NO_SLOT)
                continue;
            if (d->n_slot == OPS_RESULTS / 2 && run_device_collect(r, e))
                return -1;
            if (weighted && arena_put(&d->arena[q->array], a->mass, e))
                return -1;
            if (ops_reduce_begin(d->ops, &d->arena[q->array], q->column, 0, weighted ? a->mass : -1,
                                 q->declared->op, d->n_slot, e))
                return -1;
            d->slot[i] = d->n_slot++;
        }
    return 0;
}

/* What this rank's reductions have come to becomes that of all. */
static int share_reductions(const struct run *r, double *value, struct error *e)
{
    const struct run_device *d = r->device;
    uint32_t op[OPS_RESULTS];

    for (size_t i = 0; i < r->plan->n_reduction; i++)
        if (d->slot[i] != NO_SLOT)
            op[d->slot[i]] = r->plan->reduction[i].declared->op;
    return d->n_slot ? run_share_numbers(r, value, op, d->n_slot, e) : 0;
}

int run_device_collect(struct run *r, struct error *e)
{
    struct run_device *d = r->device;
    double *value;
    int status;

    uint32_t flags = 0;
    value = malloc((d->n_slot + 1) * sizeof(*value));
    if (!value)
        return error_memory(e, "reductions", d->n_slot * sizeof(*value));
    status = ops_results(d->ops, value, d->n_slot, &flags, e);
    if (!status && (flags & OPS_NOWHERE))
        status = error_set(e, EXIT_RUN, "a particle is nowhere, or left the domain");
    if (!status)
        status = share_reductions(r, value, e);
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        if (!status && d->slot[i] != NO_SLOT)
            r->reduced[i] = value[d->slot[i]];
        d->slot[i] = NO_SLOT;
    }
    d->n_slot = 0;
    free(value);
    return status;
}

static int prepare(struct run *r, const struct stage *s, struct error *e)
{
    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = &r->plan->pass[s->pass[k]];
        if (p->function && p->function->prepare &&
            (run_device_collect(r, e) || chunks_prepare(r, p, e)))
            return -1;
    }
    return kernels_update(r->device->kernels, e);
}

static int run_stage(struct run *r, size_t k, struct error *e)
{
    const struct stage *s = &r->device->stage[k];
    const size_t before = device_span(r->device->d, SPAN_STAGES + 2 * k + 1);
    int status = prepare(r, s, e);

    if (!status && (r->device->arena[s->array].n > 0 || run_shared(r))) {
        status = s->iterates ? iterate(r, k, e) : sweep(r, k, 0, e);
        if (!status && !s->iterates)
            run_device_count(r, k, 1.0);
    }
    device_span(r->device->d, before);
    return status ? status : begin_reductions(r, s, e);
}

/* -- What went wrong -------- */

/* Every column of an array that is looked at after the passes of a moment; how many. */
static size_t looked_at(const struct run *r, enum moment moment, size_t array,
                        struct look_column *c)
{
    const struct plan_array *a = &r->plan->array[array];
    size_t n = 0;

    for (size_t q = 0; moment == MOMENT_EVALUATE && q < a->n_rate; q++)
        c[n++] = (struct look_column){a->rate[q].rate, true, -INFINITY};
    for (size_t k = 0; k < r->watch->n_column; k++) {
        const struct watched *w = &r->watch->column[k];
        if (w->array == array && !w->may_be)
            c[n++] = (struct look_column){w->column, false, w->least};
    }
    for (size_t i = 0; r->look && i < r->plan->n_pass; i++) {
        const struct pass *p = &r->plan->pass[i];
        for (uint32_t k = 0;
             p->moment == moment && p->dst.array == array && k < p->use.item->props.count; k++) {
            const sph_prop *prop = list_at(&p->use.item->props, k);
            const int column = p->dst.column[k];
            if (column >= 0 && !(prop->access & SPH_WORK) && pass_writes(p, array, column) &&
                column_is_real(&a->p.column[column]))
                c[n++] = (struct look_column){column, false, -INFINITY};
        }
    }
    return n;
}

static int look_at_all(struct run *r, enum moment moment, bool *wrong, struct error *e)
{
    size_t most = r->watch->n_column + 1;
    struct look_column *c;
    int status = 0;

    for (size_t i = 0; i < r->plan->n_pass; i++)
        most += r->plan->pass[i].use.item->props.count;
    for (size_t a = 0; a < r->plan->n_array; a++)
        most += r->plan->array[a].n_rate;
    c = malloc(most * sizeof(*c));
    if (!c)
        return error_memory(e, "the watch", most * sizeof(*c));
    for (size_t a = 0; !status && a < r->plan->n_array; a++) {
        const size_t n = looked_at(r, moment, a, c);
        for (size_t k = 0; !status && k < n; k++)
            status = arena_put(&r->device->arena[a], c[k].column, e);
        if (!status)
            status = look_at_columns(r->device->look, &r->device->arena[a], c, n, e);
    }
    free(c);
    return status ? -1 : look_wrong(r->device->look, wrong, e);
}

/* Something is no number, or below what it may be: the host, with all in its hands, says what. */
static int find_wrong(struct run *r, enum moment moment, struct error *e)
{
    bool wrong;

    if (look_at_all(r, moment, &wrong, e))
        return -1;
    uint64_t any = wrong; /* all ranks look then: what they count they share */
    if (run_share_count(r, &any, e))
        return -1;
    if (!any)
        return 0;
    if (run_device_fetch(r, e) || (moment == MOMENT_EVALUATE && watch_state(r, e)))
        return -1;
    for (size_t i = 0; i < r->plan->n_pass; i++) {
        const struct pass *p = &r->plan->pass[i];
        r->watch->done = i + 1;
        if (p->moment == moment && ((r->look && finite_pass_late(r, p, e)) || watch_pass(r, p, e)))
            return -1;
    }
    r->suspect = true;
    return moment == MOMENT_EVALUATE ? finite_rates(r, e) : 0;
}

static int failed_bodies(struct run *r, struct error *e)
{
    bool failed = false;

    return kernels_failed(r->device->kernels, &failed, e) || failed ? -1 : 0;
}

int run_device_passes(struct run *r, enum moment moment, struct error *e)
{
    struct run_device *d = r->device;

    r->watch->done = 0;
    /* What a run begins with the host looks at. */
    if (moment == MOMENT_EVALUATE && !r->watch->begun &&
        (run_device_fetch(r, e) || watch_state(r, e)))
        return -1;
    if (moment != MOMENT_FINISH && run_device_lists(r, false, e))
        return -1;
    for (size_t k = d->first[moment]; k < d->first[moment + 1]; k++)
        if (run_stage(r, k, e))
            return -1;
    if (run_device_collect(r, e) || failed_bodies(r, e) || find_wrong(r, moment, e))
        return -1;
    if (moment != MOMENT_EVALUATE)
        return 0;
    run_bound_dt(r);
    r->watch->sorted = false;
    r->watch->evaluated = true;
    return 0;
}

/* -- The integrator -------- */

static int advance_array(struct run *r, size_t array, size_t from, size_t to, struct error *e)
{
    const struct plan_array *a = &r->plan->array[array];
    const size_t n_op = r->plan->integrator->n_op;
    struct arena *arena = &r->device->arena[array];

    for (size_t q = 0; q < a->n_rate; q++) {
        const struct rate *rate = &a->rate[q];
        if (arena_put(arena, rate->property, e) || arena_put(arena, rate->rate, e) ||
            (rate->saved >= 0 && arena_put(arena, rate->saved, e)))
            return -1;
        for (int s = 0; s < SLOT_COUNT; s++)
            if (rate->kept[s] >= 0 && arena_put(arena, rate->kept[s], e))
                return -1;
    }
    if (arena->n > 0 &&
        ((r->left && ops_advance(r->device->ops, arena, a, r->op, n_op - r->left, n_op, r->left_dt,
                                 NULL, e)) ||
         (to > from && ops_advance(r->device->ops, arena, a, r->op, from, to, r->dt, NULL, e))))
        return -1;
    for (size_t q = 0; q < a->n_rate; q++) {
        const struct rate *rate = &a->rate[q];
        for (int s = 0; s < SLOT_COUNT; s++)
            if (rate->kept[s] >= 0)
                run_device_changed(r, array, rate->kept[s]);
        run_device_changed(r, array, rate->property);
        if (rate->saved >= 0)
            run_device_changed(r, array, rate->saved);
    }
    return 0;
}

int run_device_advance(struct run *r, size_t from, size_t to, struct error *e)
{
    const size_t before = device_span(r->device->d, SPAN_INTEGRATE);
    int status = 0;

    for (size_t a = 0; !status && a < r->plan->n_array; a++)
        if (r->plan->array[a].n_rate && (r->device->arena[a].n > 0 || run_shared(r)))
            status = advance_array(r, a, from, to, e);
    device_span(r->device->d, before);
    r->left = 0;
    r->lists_suspect = true;
    return status;
}
