/* run/device_lists.c -- neighbour lists and ghosts of a run on a device: lists.c over again, with the particles
 * there. When something is wrong with places or smoothing lengths the host looks for it in its copies, and
 * says it in the words that it has for its own runs. */
#include "run/device.h"

#include "run/domain.h"
#include "run/frames.h"
#include "run/watch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct device_cloud cloud_of(const struct run *r, size_t array, size_t frame, bool ghosts)
{
    const struct arena *a = &r->device->arena[array];

    return (struct device_cloud){.dim = r->plan->dim,
                                 .wide = &a->wide,
                                 .plane = a->plane,
                                 .n = a->n + (ghosts ? a->n_ghost : 0),
                                 .x_slot = a->place[frame_place(r, frame, array)].slot,
                                 .h_slot = a->place[frame_reach(r, frame, array)].slot,
                                 .scale = frame_support(r->plan)};
}

/* Places and h of all arrays are on the device. */
static int places_here(struct run *r, size_t frame, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (arena_put(&r->device->arena[a], frame_place(r, frame, a), e) ||
            arena_put(&r->device->arena[a], frame_reach(r, frame, a), e))
            return -1;
    return 0;
}

/* Places and h of all arrays are on the host. */
static int places_there(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        if (run_device_get(r, a, pa->position, e) || run_device_get(r, a, pa->smoothing, e) ||
            run_device_get(r, a, pa->id, e))
            return -1;
    }
    return 0;
}

/* The host makes its own lists of what is there, to say what is wrong; where nothing is after all, `why` stays
 * what the device had against it. */
static int host_says(struct run *r, struct error *e)
{
    struct run_device *device = r->device;
    struct run_domain *domain = r->domain;
    struct error why = {0};
    bool lost;
    int status = run_device_failed(r, &lost) ? -1 : run_device_fetch(r, &why);

    if (status)
        return -1;
    r->device = NULL;
    r->domain = NULL; /* the other ranks do not take part */
    r->lists_made = false;
    status = run_lists(r, true, &why);
    r->device = device;
    r->domain = domain;
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (particles_resize(&r->plan->array[a].p, r->plan->array[a].p.n, 0, &why))
            status = -1;
    if (status)
        *e = why;
    return -1;
}

/* -- Where everything is -------- */

struct extent {
    double low[3], high[3], h_low, h_high;
};

/* Numbers that were left on the device behind the reductions that are on their way: one wait for all. */
static int take_results(struct run *r, double *out, size_t n, struct error *e)
{
    double all[OPS_RESULTS];
    const size_t first = r->device->n_slot;

    if (ops_results(r->device->ops, all, first + n, NULL, e))
        return -1;
    memcpy(out, all + first, n * sizeof(*out));
    return 0;
}

/* Places and h of an array that is not empty. */
static int extent_of(struct run *r, size_t array, struct extent *x, struct error *e)
{
    const struct plan_array *a = &r->plan->array[array];
    const struct arena *arena = &r->device->arena[array];
    struct ops *o = r->device->ops;
    const uint32_t dim = (uint32_t)r->plan->dim;
    const size_t first = r->device->n_slot;
    double end[8];

    for (uint32_t c = 0; c <= dim; c++) {
        const int column = c < dim ? a->position : a->smoothing;
        const uint32_t component = c < dim ? c : 0;
        if (ops_reduce_begin(o, arena, column, component, -1, SPH_REDUCE_MIN, first + 2 * c, e) ||
            ops_reduce_begin(o, arena, column, component, -1, SPH_REDUCE_MAX, first + 2 * c + 1, e))
            return -1;
    }
    if (take_results(r, end, 2 * dim + 2, e))
        return -1;
    for (uint32_t c = 0; c < dim; c++) {
        x->low[c] = end[2 * c];
        x->high[c] = end[2 * c + 1];
    }
    x->h_low = end[2 * dim];
    x->h_high = end[2 * dim + 1];
    return 0;
}

/* Has anybody gone where nobody should be? Those that are looked at particle by particle are the host's. */
static int look_for_escaped(struct run *r, struct error *e)
{
    const struct scene_watch *rule = &r->watch->scene[WATCH_ESCAPED];
    bool wrong = rule->where || rule->action == WATCH_COUNT || !r->watch->bounded;

    for (size_t a = 0; !wrong && a < r->plan->n_array; a++) {
        struct extent x;
        if (r->device->arena[a].n == 0)
            continue;
        if (extent_of(r, a, &x, e))
            return -1;
        for (int c = 0; c < r->plan->dim; c++)
            wrong = wrong || !(x.low[c] >= r->watch->low[c] && x.high[c] <= r->watch->high[c]);
    }
    uint64_t any = wrong; /* all ranks look then: what they count they share */
    if (run_share_count(r, &any, e))
        return -1;
    if (!any)
        return 0;
    return places_there(r, e) || watch_places(r, true, e) || watch_places(r, false, e) ? -1 : 0;
}

/* -- Are the lists still right? -------- */

/* Whether what was made when the places of a frame were kept is right now. */
static int holds(struct run *r, const struct ops_skin *kept, size_t frame, bool *answer,
                 struct error *e)
{
    struct skin_change all = {0.0, INFINITY};
    const size_t first = r->device->n_slot, most = (OPS_RESULTS - 2 - first) / 2;
    double change[OPS_RESULTS];
    size_t n = 0;

    for (size_t a = 0; a < r->plan->n_array; a++) {
        if (!frame_has(r, frame, a) || r->device->arena[a].n == 0)
            continue;
        if (n == most) { /* more arrays than results: lists are made anew */
            all.moved = NAN;
            break;
        }
        if (ops_skin_begin(r->device->ops, &kept[frame * r->plan->n_array + a],
                           &r->device->arena[a], frame_place(r, frame, a), frame_reach(r, frame, a),
                           frame_support(r->plan), r->skin, first + 2 * n++, e))
            return -1;
    }
    if (n && take_results(r, change, 2 * n, e))
        return -1;
    for (size_t k = 0; k < n; k++)
        all = skin_both(all, (struct skin_change){change[2 * k], change[2 * k + 1]});
    if (run_share_change(r, &all, e))
        return -1;
    *answer = skin_holds(all);
    return 0;
}

static int keep_places(struct run *r, struct ops_skin *kept, size_t frame, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (frame_has(r, frame, a) &&
            ops_skin_keep(r->device->ops, &kept[frame * r->plan->n_array + a], &r->device->arena[a],
                          frame_place(r, frame, a), frame_reach(r, frame, a), e))
            return -1;
    return 0;
}

/* -- Order, ghosts -------- */

static int wrap(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct arena *arena = &r->device->arena[a];
        if (arena->n == 0 && !run_shared(r))
            continue;
        for (size_t c = 0; c < arena->p->n_column; c++)
            if (arena->p->column[c].state && arena_put(arena, (int)c, e))
                return -1;
        if (ops_wrap(r->device->ops, arena, &r->plan->scene->box, NULL, e))
            return -1;
        for (size_t c = 0; c < arena->p->n_column; c++)
            if (arena->p->column[c].state)
                run_device_changed(r, a, (int)c);
    }
    return 0;
}

static int sort(struct run *r, struct error *e)
{
    int status = run_device_move(r, e);

    for (size_t a = 0; !status && a < r->plan->n_array; a++) {
        struct arena *arena = &r->device->arena[a];
        const struct device_cloud cloud = cloud_of(r, a, 0, false);
        struct device_buffer order = {0};
        if (arena->n < 2)
            continue;
        for (size_t c = 0; !status && c < arena->p->n_column; c++)
            if (arena->p->column[c].state)
                status = arena_put(arena, (int)c, e);
        if (!status)
            status = device_order(r->device->search, &cloud,
                                  arena->place[r->plan->array[a].id].slot, &order, e) ||
                             ops_permute(r->device->ops, arena, &order, e)
                         ? -1
                         : 0;
        device_release(r->device->d, &order);
        r->device->ghosts[a].n = 0;
        for (size_t c = 0; c < arena->p->n_column; c++) {
            r->stale[a][c] = false;
            r->mirror_old[a][c] = MIRROR_OLD;
        }
    }
    r->builds_since_sort = 0;
    r->cost.sorts++;
    r->watch->sorted = true;
    return status;
}

/* Those of all ranks. */
static int share_ranges(struct run *r, struct extent *all, double *overshoot, struct error *e)
{
    const size_t n = r->plan->n_array, most = 2 * n + 7;
    double *value = malloc(most * sizeof(*value));
    uint32_t *op = malloc(most * sizeof(*op));
    int status = value && op ? 0 : error_memory(e, "the ranges of places", most * sizeof(*value));

    for (size_t k = 0; !status && k < most; k++) {
        value[k] = k < n           ? r->h_low[k]
                   : k < 2 * n     ? r->h_high[k - n]
                   : k < 2 * n + 3 ? all->low[k - 2 * n]
                   : k < 2 * n + 6 ? all->high[k - 2 * n - 3]
                                   : *overshoot;
        op[k] = k < n || (k >= 2 * n && k < 2 * n + 3) ? SPH_REDUCE_MIN : SPH_REDUCE_MAX;
    }
    if (!status)
        status = run_share_numbers(r, value, op, most, e);
    for (size_t a = 0; !status && a < n; a++) {
        r->h_low[a] = value[a];
        r->h_high[a] = value[n + a];
    }
    for (int c = 0; !status && c < 3; c++) {
        all->low[c] = value[2 * n + (size_t)c];
        all->high[c] = value[2 * n + 3 + (size_t)c];
    }
    if (!status)
        *overshoot = value[most - 1];
    free(value);
    free(op);
    return status;
}

/* The ranges of places and of h, which ghosts and the frame of mirrors are made for. */
static int find_ranges(struct run *r, struct extent *all, double *overshoot, struct error *e)
{
    const struct box *box = &r->plan->scene->box;

    *all = (struct extent){.low = {INFINITY, INFINITY, INFINITY},
                           .high = {-INFINITY, -INFINITY, -INFINITY}};
    *overshoot = 0.0;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct extent x;
        r->h_low[a] = INFINITY;
        r->h_high[a] = 0.0;
        if (r->device->arena[a].n == 0)
            continue;
        if (extent_of(r, a, &x, e))
            return -1;
        r->h_low[a] = x.h_low;
        r->h_high[a] = fmax(x.h_high, 0.0);
        for (int c = 0; c < r->plan->dim; c++) {
            all->low[c] = fmin(all->low[c], x.low[c]);
            all->high[c] = fmax(all->high[c], x.high[c]);
            if (box->bounded && box->side[c][0] != SIDE_OPEN)
                *overshoot = fmax(*overshoot, box->min[c] - x.low[c]);
            if (box->bounded && box->side[c][1] != SIDE_OPEN)
                *overshoot = fmax(*overshoot, x.high[c] - box->max[c]);
        }
    }
    return run_shared(r) ? share_ranges(r, all, overshoot, e) : 0;
}

/* Whether so many ghosts would be made that somebody may have too many neighbours. */
static bool is_wide(const struct run *r, double margin)
{
    const struct box *box = &r->plan->scene->box;
    bool wide = false;

    for (int c = 0; c < r->plan->dim; c++)
        wide = wide || (box->bounded && box->side[c][0] != SIDE_OPEN &&
                        box->side[c][1] != SIDE_OPEN && 2.0 * margin > box->max[c] - box->min[c]);
    return wide;
}

/* The host says what is wrong with the particles that ghosts cannot be made of. */
static int no_ghosts(struct run *r, struct error *e)
{
    struct error why = {0};
    bool lost;

    if (e->text[0] && !run_device_failed(r, &lost) && places_there(r, &why) == 0)
        watch_no_ghosts(r, e);
    return -1;
}

/* On one rank. */
static int make_images(struct run *r, double margin, struct error *e)
{
    struct run_device *d = r->device;

    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        if (ops_ghosts_make(d->ops, &d->arena[a], &d->ghosts[a], &r->plan->scene->box, margin, e))
            return no_ghosts(r, e);
        for (size_t c = 0; c < pa->p.n_column; c++) {
            r->stale[a][c] = d->ghosts[a].n > 0;
            r->mirror_old[a][c] = MIRROR_OLD;
        }
        r->stale[a][pa->position] = r->stale[a][pa->smoothing] = false;
    }
    return 0;
}

static int make_halo(struct run *r, double margin, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++)
        for (int c = 0; c < r->plan->dim; c++)
            if (sides_check_width(&r->plan->scene->box, c, margin, r->plan->array[a].p.name, e)) {
                struct error why = {0};
                return places_there(r, &why) ? -1 : watch_too_wide(r, e);
            }
    if (run_device_halo(r, e))
        return no_ghosts(r, e);
    for (size_t f = 1; f < r->plan->n_frame; f++)
        if (places_here(r, f, e) || keep_places(r, r->device->met, f, e))
            return -1;
    return 0;
}

/* Whether there may be images beyond a side of an axis. */
static bool has_images(const struct run *r, int axis, unsigned image)
{
    bool any = false;

    if (run_shared(r))
        return sides_has_image(&r->plan->scene->box, axis, image);
    for (size_t a = 0; a < r->plan->n_array; a++)
        any = any || r->device->ghosts[a].n > 0;
    return any;
}

static int make_ghosts(struct run *r, struct error *e)
{
    struct extent all;
    double overshoot, margin = 0.0;

    if (find_ranges(r, &all, &overshoot, e))
        return -1;
    for (size_t a = 0; a < r->plan->n_array; a++)
        margin = fmax(margin, r->h_high[a]);
    margin = margin * frame_support(r->plan) * (1.0 + r->skin) + overshoot;
    if (is_wide(r, margin) && (places_there(r, e) || watch_reach(r, margin, e)))
        return -1;
    if (run_shared(r) ? make_halo(r, margin, e) : make_images(r, margin, e))
        return -1;
    /* They stand beyond the real ones, no further than the margin. */
    for (int c = 0; c < r->plan->dim; c++) {
        all.low[c] -= has_images(r, c, IMAGE_LOW) ? margin : 0.0;
        all.high[c] += has_images(r, c, IMAGE_HIGH) ? margin : 0.0;
    }
    return run_mirror_frame_of(r, all.low, all.high, e);
}

/* -- Lists -------- */

static int make_list(struct run *r, size_t k, bool counted, struct error *e)
{
    const struct plan_list *l = &r->plan->list[k];
    const struct device_cloud dst = cloud_of(r, l->dst, l->frame, false);
    const struct device_cloud src = cloud_of(r, l->src, l->frame, true);
    const struct scene_watch *rule = &r->watch->scene[WATCH_NEIGHBOURS];
    struct device_list *list = &r->device->list[k];
    const uint64_t most = rule->action == WATCH_OFF ? 0 : (uint64_t)rule->limit;

    if (device_list_make(r->device->search, list, &dst, &src, l->reach == SPH_SYMMETRIC, r->skin,
                         counted, most, e)) {
        error_prefix(e, "neighbours of \"%s\"", r->plan->array[l->dst].p.name);
        return host_says(r, e);
    }
    if (list->crowded && rule->action == WATCH_STOP) {
        error_set(e, EXIT_RUN, "%llu particles of \"%s\" have more than %llu neighbours",
                  (unsigned long long)list->crowded, r->plan->array[l->dst].p.name,
                  (unsigned long long)most);
        return host_says(r, e);
    }
    /* Counted: who they are is nobody's question. */
    const struct sign s = {.cause = WATCH_NEIGHBOURS, .array = &r->plan->array[l->dst]};
    if ((list->crowded || r->domain) && watch_counts(r, WATCH_NEIGHBOURS) &&
        watch_count(r, &s, list->crowded, e))
        return -1;
    if (counted && list->n_entry)
        r->device->share[k] = (double)list->n_pair / (double)list->n_entry;
    return 0;
}

static int make_frame(struct run *r, size_t frame, bool counted, struct error *e)
{
    for (size_t k = 0; k < r->plan->n_list; k++)
        if (r->plan->list[k].frame == frame && make_list(r, k, counted, e))
            return -1;
    return r->plan->frame[frame].frozen ? 0 : keep_places(r, r->device->skin, frame, e);
}

static int freeze(struct run *r, size_t frame, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct arena *arena = &r->device->arena[a];
        const struct particles *p = &r->plan->array[a].p;
        const int from[2] = {particles_find(p, r->plan->frame[frame].name),
                             r->plan->array[a].smoothing};
        const int to[2] = {frame_place(r, frame, a), frame_reach(r, frame, a)};
        if (!frame_has(r, frame, a))
            continue;
        for (int k = 0; k < 2; k++) {
            if (ops_copy(r->device->ops, arena, from[k], to[k], e))
                return -1;
            run_device_changed(r, a, to[k]);
        }
    }
    r->frozen[frame] = true;
    return 0;
}

static int build(struct run *r, bool within, bool sorts, struct error *e)
{
    if (look_for_escaped(r, e) || (!within && wrap(r, e)) || (sorts && sort(r, e)) ||
        make_ghosts(r, e))
        return -1;
    /* Ghosts of others stand in another order now. */
    if (sorts || !r->lists_made || run_shared(r))
        memset(r->frame_made, false, r->plan->n_frame);
    return make_frame(r, 0, sorts || !r->lists_made, e);
}

/* Others' particles that a frame's lists need are among the ghosts, and stand where they do there. */
static int meet_again(struct run *r, size_t frame, struct error *e)
{
    bool right = false;

    if (!run_shared(r))
        return 0;
    if (holds(r, r->device->met, frame, &right, e) || (!right && build(r, true, false, e)))
        return -1;
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (frame_has(r, frame, a) && (run_device_refresh(r, a, frame_place(r, frame, a), e) ||
                                       run_device_refresh(r, a, frame_reach(r, frame, a), e)))
            return -1;
    return run_device_trade(r, e);
}

static int frame_lists(struct run *r, size_t frame, struct error *e)
{
    const bool frozen = r->plan->frame[frame].frozen;
    bool right = false;
    int status;

    if (places_here(r, frame, e))
        return -1;
    if (r->frame_made[frame] && !frozen && holds(r, r->device->skin, frame, &right, e))
        return -1;
    if (r->frame_made[frame] && (frozen || right))
        return 0;
    if ((frozen && !r->frozen[frame] && freeze(r, frame, e)) || meet_again(r, frame, e))
        return -1;
    status = make_frame(r, frame, true, e);
    r->frame_made[frame] = !status;
    r->cost.list_builds++;
    return status;
}

int run_device_frame(struct run *r, size_t frame, struct error *e)
{
    if (frame == 0)
        return 0;
    const size_t before = device_span(r->device->d, SPAN_LISTS);
    const int status = frame_lists(r, frame, e);
    device_span(r->device->d, before);
    return status;
}

static int renew(struct run *r, bool within, bool sorts, struct error *e)
{
    const int status = build(r, within, sorts, e);

    r->lists_made = !status;
    r->cost.list_builds++;
    return status;
}

static int lists(struct run *r, bool within, struct error *e)
{
    bool right = false;
    int status = places_here(r, 0, e);

    if (!status && r->plan->n_list == 0)
        return within ? 0 : wrap(r, e);
    if (!status && r->lists_made)
        status = holds(r, r->device->skin, 0, &right, e);
    if (!status && !right) {
        const bool first = !within && !r->lists_made && r->cost.list_builds == 0;
        const bool sorts = !within && (!r->lists_made || ++r->builds_since_sort >= BUILDS_PER_SORT);
        bool uneven = false;
        status = renew(r, within, sorts, e);
        if (!status && first)
            status = run_domain_uneven(r, &uneven, e);
        if (!status && uneven)
            status = renew(r, within, sorts, e);
    }
    r->lists_suspect = false;
    return status;
}

int run_device_lists(struct run *r, bool within, struct error *e)
{
    const size_t before = device_span(r->device->d, SPAN_LISTS);
    const int status = lists(r, within, e);
    device_span(r->device->d, before);
    return status;
}

int run_device_refresh(struct run *r, size_t array, int column, struct error *e)
{
    if (!r->stale[array][column])
        return 0;
    r->stale[array][column] = false;
    if (column == r->plan->array[array].position) /* whose mirror does not go along */
        r->mirror_old[array][column] = MIRROR_OLD;
    const size_t before = device_span(r->device->d, SPAN_LISTS);
    const int status =
        ops_ghosts_refresh(r->device->ops, &r->device->arena[array], &r->device->ghosts[array],
                           &r->plan->scene->box, column, e);
    device_span(r->device->d, before);
    return status || run_domain_ask(r, array, column, e) ? -1 : 0;
}
