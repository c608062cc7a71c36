/* run/lists.c -- neighbour lists and ghosts of a run: made when they are no longer right, reused until then.
 * Everything is decided by displacements and counters, never by time, so that a run repeats itself. */
#include "run/device.h"
#include "run/domain.h"
#include "run/frames.h"
#include "run/run_store.h"
#include "run/watch.h"

#include "neighbours/range.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static double *plane_of(const struct plan_array *a, int column, int c)
{
    const struct column *x = &a->p.column[column];
    return (double *)x->data + (size_t)c * x->plane;
}

/* -- Are they still right? ---------------------------------------------------------------------- */

static struct cloud cloud_of(const struct run *r, size_t array, size_t frame, bool ghosts)
{
    const struct plan_array *a = &r->plan->array[array];
    struct cloud cloud = {.dim = r->plan->dim, .scale = frame_support(r->plan)};
    cloud.n = a->p.n + (ghosts ? a->p.n_ghost : 0);
    cloud.visits = ghosts && r->plan->strict ? &r->visits[array] : NULL;
    const struct column *h = &a->p.column[frame_reach(r, frame, array)];
    cloud.h = h->size == sizeof(double) ? h->data : r->wide_h[array];
    for (int c = 0; c < r->plan->dim; c++)
        cloud.x[c] = plane_of(a, frame_place(r, frame, array), c);
    return cloud;
}

struct cloud run_cloud(const struct run *r, size_t array, size_t frame)
{
    return cloud_of(r, array, frame, false);
}

/* Whoever makes lists and ghosts wants h in doubles. Where it is held in floats, which is where nothing
 * changes it, they are there while it does; in between clouds have no h, and it counts as unchanged. */
static int widen_h(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct particles *p = &r->plan->array[a].p;
        const struct column *h = &p->column[r->plan->array[a].smoothing];
        const size_t n = p->n + p->n_ghost;
        if (h->size == sizeof(double))
            continue;
        double *wide = realloc(r->wide_h[a], (n + PARTICLES_PAD) * sizeof *wide);
        if (!wide)
            return error_memory(e, "smoothing lengths", n * sizeof *wide);
        column_load(h, 0, 0, n, wide);
        memset(wide + n, 0, PARTICLES_PAD * sizeof *wide);
        r->wide_h[a] = wide;
    }
    return 0;
}

/* Places, likewise: the column itself goes into doubles, and into quanta when there are lists. */
static int widen_places(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct plan_array *pa = &r->plan->array[a];
        if (pa->in_quanta && particles_hold(&pa->p, pa->position, sizeof(double), false, e))
            return -1;
    }
    return 0;
}

static int narrow_places(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct plan_array *pa = &r->plan->array[a];
        if (!pa->in_quanta)
            continue;
        if (particles_hold_quanta(&pa->p, pa->position, r->centre, r->quantum, e))
            return -1;
        for (uint32_t k = 0; k < pa->p.column[pa->position].ncomp; k++)
            if (any_not_finite4(pa->p.column[pa->position].low +
                                    k * pa->p.column[pa->position].plane,
                                pa->p.n + pa->p.n_ghost))
                return error_set(e, EXIT_RUN, "a particle of array \"%s\" is nowhere", pa->p.name);
    }
    return 0;
}

static void forget_h(struct run *r)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        free(r->wide_h[a]);
        r->wide_h[a] = NULL;
    }
}

/* The arrays that take part in a frame: their clouds; how many. */
static size_t clouds_of(const struct run *r, size_t frame, struct cloud *cloud)
{
    size_t n = 0;
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (frame_has(r, frame, a))
            cloud[n++] = cloud_of(r, a, frame, false);
    return n;
}

struct skin_change run_change(const struct run *r, size_t array, size_t first, size_t n,
                              const double *const *x)
{
    struct cloud cloud = cloud_of(r, array, 0, false);
    const struct skin *kept = r->kept;
    for (size_t a = 0; a < array; a++)
        kept += frame_has(r, 0, a);
    if (!frame_has(r, 0, array))
        return (struct skin_change){0.0, INFINITY};
    if (kept->n != cloud.n)
        return (struct skin_change){NAN, NAN};
    cloud.n = n;
    for (int c = 0; c < cloud.dim; c++)
        cloud.x[c] = x[c];
    cloud.h = cloud.h ? cloud.h + first : NULL;
    const struct skin part = skin_part(kept, first, n);
    return skin_change(&part, &cloud, r->skin, 1);
}

/* Of an array whose places are held in quanta, all: a piece of them in doubles at a time. */
static struct skin_change change_in_quanta(const struct run *r, size_t array)
{
    const struct plan_array *a = &r->plan->array[array];
    const long n = (long)a->p.n;
    double moved = 0.0, room = INFINITY, none = 0.0;
    if (r->has_change[array])
        return r->change[array];
#pragma omp parallel for schedule(static) num_threads(r->threads) if (n > 20000)                   \
    reduction(max : moved) reduction(min : room) reduction(+ : none)
    for (long first = 0; first < n; first += SKIN_PIECE) {
        double x[3][SKIN_PIECE];
        const double *at[3] = {x[0], x[1], x[2]};
        const size_t some = n - first < SKIN_PIECE ? (size_t)(n - first) : SKIN_PIECE;
        for (uint32_t c = 0; c < a->p.column[a->position].ncomp; c++)
            column_load(&a->p.column[a->position], c, (size_t)first, some, x[c]);
        const struct skin_change here = run_change(r, array, (size_t)first, some, at);
        moved = here.moved > moved ? here.moved : moved;
        room = here.room < room ? here.room : room;
        none += here.moved * 0.0;
    }
    return (struct skin_change){moved + none, room};
}

/* kept_all: places of a frame when its lists were made, or when something else was. */
static int holds(const struct run *r, const struct skin *kept_all, size_t frame, bool *yes,
                 struct error *e)
{
    const struct skin *kept = kept_all + frame * r->plan->n_array;
    struct skin_change all = {0.0, INFINITY};
    for (size_t a = 0; a < r->plan->n_array; a++) {
        if (!frame_has(r, frame, a))
            continue;
        const struct plan_array *pa = &r->plan->array[a];
        const struct cloud cloud = cloud_of(r, a, frame, false);
        const struct skin_change here = frame == 0 && pa->p.column[pa->position].quantum > 0.0
                                            ? change_in_quanta(r, a)
                                            : skin_change(kept, &cloud, r->skin, r->threads);
        kept++;
        all = skin_both(all, here);
    }
    if (run_share_change(r, &all, e))
        return -1;
    *yes = skin_holds(all);
    return 0;
}

static int keep_places(struct run *r, size_t frame, struct error *e)
{
    const size_t n = clouds_of(r, frame, r->cloud);
    /* On several ranks a checkpoint holds the places and no lists: these are made from them again. */
    for (size_t k = 0; k < n; k++)
        r->kept[frame * r->plan->n_array + k].form = r->plan->strict ? SKIN_EXACT
                                                     : r->domain     ? SKIN_PLACES
                                                                     : SKIN_SHORT;
    for (size_t k = 0; !r->plan->frame[frame].frozen && k < n; k++)
        if (skin_keep(&r->kept[frame * r->plan->n_array + k], &r->cloud[k], r->threads, e))
            return -1;
    return 0;
}

/* -- Order, ghosts ------------------------------------------------------------------------------ */

static int sort_array(struct run *r, size_t array, struct error *e)
{
    struct plan_array *a = &r->plan->array[array];
    const size_t n = a->p.n;
    if (n < 2)
        return 0;
    const struct cloud cloud = cloud_of(r, array, 0, false);
    uint32_t *order = malloc(n * sizeof *order);
    if (!order)
        return error_memory(e, "the order of particles", n * sizeof *order);
    int status =
        cell_order(&cloud, a->p.column[a->id].data, cell_best(&cloud), r->threads, order, e);
    if (!status)
        status = particles_permute(&a->p, order, e);
    free(order);
    for (size_t c = 0; c < a->p.n_column; c++)
        r->mirror_old[array][c] = MIRROR_OLD;
    return status;
}

/* How far a particle stands outside the box. Nothing is wrapped in the midst of an evaluation, so it may have
 * left by what it moved since its start. */
static double largest_overshoot(const struct run *r)
{
    const struct box *box = &r->plan->scene->box;
    double most = 0.0;
    for (size_t a = 0; box->bounded && a < r->plan->n_array; a++)
        for (int c = 0; c < r->plan->dim; c++) {
            const struct plan_array *pa = &r->plan->array[a];
            if (box->side[c][0] == SIDE_OPEN && box->side[c][1] == SIDE_OPEN)
                continue;
            const struct range x = range_of(plane_of(pa, pa->position, c), pa->p.n, r->threads);
            if (box->side[c][0] != SIDE_OPEN)
                most = fmax(most, box->min[c] - x.least);
            if (box->side[c][1] != SIDE_OPEN)
                most = fmax(most, x.most - box->max[c]);
        }
    return most;
}

static int find_range_of_h(struct run *r, struct error *e)
{
    static const uint32_t op[2] = {SPH_REDUCE_MIN, SPH_REDUCE_MAX};
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        const struct range h = range_of(cloud_of(r, a, 0, false).h, pa->p.n, r->threads);
        double of_all[2] = {h.least, fmax(h.most, 0.0)};
        if (run_share_numbers(r, of_all, op, 2, e))
            return -1;
        r->h_low[a] = of_all[0];
        r->h_high[a] = of_all[1];
    }
    return 0;
}

/* How far beyond a side ghosts are looked for. */
static int find_margin(struct run *r, double *margin, struct error *e)
{
    static const uint32_t op = SPH_REDUCE_MAX;
    double h = 0.0, out = largest_overshoot(r);
    for (size_t a = 0; a < r->plan->n_array; a++)
        h = fmax(h, r->h_high[a]);
    if (run_share_numbers(r, &out, &op, 1, e))
        return -1;
    *margin = h * frame_support(r->plan) * (1.0 + r->skin) + out;
    return watch_reach(r, *margin, e);
}

/* On one rank. */
static int make_images(struct run *r, double margin, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct particles *p = &r->plan->array[a].p;
        if (particles_resize(p, p->n, 0, e) ||
            ghosts_make(&r->ghosts[a], &r->plan->scene->box, p, margin, e))
            return -1;
    }
    return 0;
}

static int make_ghosts(struct run *r, bool sorts, struct error *e)
{
    double margin;
    if (find_margin(r, &margin, e))
        return -1;
    /* What else fails does not tell of h. */
    for (size_t a = 0; a < r->plan->n_array; a++)
        for (int c = 0; c < r->plan->dim; c++)
            if (sides_check_width(&r->plan->scene->box, c, margin, r->plan->array[a].p.name, e))
                return watch_too_wide(r, e);
    if (r->domain ? run_domain_ghosts(r, sorts, e) || widen_h(r, e) : make_images(r, margin, e))
        return -1;
    if (run_domain_keep(r, e))
        return -1;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        for (size_t c = 0; c < r->plan->array[a].p.n_column; c++)
            run_changed(r, a, (int)c);
        r->stale[a][r->plan->array[a].position] = false;
        r->stale[a][r->plan->array[a].smoothing] = false;
    }
    return run_mirror_frame(r, margin, e);
}

/* -- Lists -------------------------------------------------------------------------------------- */

/* True pairs are counted when the particles are sorted; in between their share of the lists is taken to last. */
static int make_list(struct run *r, size_t k, bool counted, struct error *e)
{
    const struct plan_list *l = &r->plan->list[k];
    const struct cloud dst = cloud_of(r, l->dst, l->frame, false);
    const struct cloud src = cloud_of(r, l->src, l->frame, true);
    struct group_list *list = &r->list[k];
    const struct scene_watch *rule = &r->watch->scene[WATCH_NEIGHBOURS];
    list->crowd.most = rule->action == WATCH_OFF ? 0 : (uint64_t)rule->limit;
    list->crowd.stops = rule->action == WATCH_STOP;
    if (group_list_make(list, &dst, &src, l->reach == SPH_SYMMETRIC, r->skin, r->plan->manager,
                        r->threads, e) &&
        !(list->crowd.n && list->crowd.stops)) {
        error_prefix(e, "neighbours of \"%s\"", r->plan->array[l->dst].p.name);
        return watch_no_lists(r, e);
    }
    if (watch_crowd(r, k, e))
        return -1;
    if (counted && list->n_entry)
        list->true_share = ((double)group_list_count(list, &dst, &src, r->threads) -
                            (l->dst == l->src ? (double)dst.n : 0.0)) /
                           (double)list->n_entry; /* a particle is no pair with itself */
    return run_domain_list(r, k, e);
}

static int make_visits(struct run *r, struct error *e)
{
    for (size_t a = 0; r->plan->strict && a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        const uint8_t *image = r->domain ? r->domain->halo.image[a] : r->ghosts[a].image;
        if (run_refresh(r, a, pa->id, e) ||
            visits_make(&r->visits[a], pa->p.column[pa->id].data, image, pa->p.n, pa->p.n_ghost,
                        r->threads, e))
            return -1;
    }
    return 0;
}

/* All lists of a frame. */
static int make_frame(struct run *r, size_t frame, bool counted, struct error *e)
{
    for (size_t k = 0; k < r->plan->n_list; k++)
        if (r->plan->list[k].frame == frame && make_list(r, k, counted, e))
            return -1;
    return keep_places(r, frame, e);
}

/* Those of positions. The others are made when a pass asks for them: at the start their places may be
 * yet to be set. They stay right while the particles stand as they stood. sorts: the particles' order is being made;
 * counted: true pairs are counted. */
static int make_lists(struct run *r, bool sorts, bool counted, struct error *e)
{
    if (widen_h(r, e)) /* they stand in another order now */
        return -1;
    if (find_range_of_h(r, e) || make_ghosts(r, sorts, e) || widen_h(r, e) || make_visits(r, e))
        return -1;
    if (counted || !r->lists_made || r->domain) /* ghosts of others stand elsewhere now */
        memset(r->frame_made, false, r->plan->n_frame);
    return make_frame(r, 0, counted, e);
}

/* Copies of what neighbours will be looked for in from now on. */
static void freeze(struct run *r, size_t frame)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct particles *p = &r->plan->array[a].p;
        if (!frame_has(r, frame, a))
            continue;
        const struct column *from = &p->column[particles_find(p, r->plan->frame[frame].name)];
        const struct column *to = &p->column[frame_place(r, frame, a)];
        for (uint32_t c = 0; c < from->ncomp; c++)
            for (size_t i = 0; i < p->n; i++)
                column_set(to, c, i, column_get(from, c, i));
        memcpy(p->column[frame_reach(r, frame, a)].data,
               p->column[r->plan->array[a].smoothing].data, p->n * sizeof(double));
    }
    r->frozen[frame] = true;
}

/* Lists and ghosts anew; sort: particles are put in order before, and go to their ranks. */
static int renew(struct run *r, bool within, bool sort, struct error *e);

/* Others' particles that a frame's lists need are among the ghosts, and stand where they do there. */
static int meet_again(struct run *r, size_t frame, struct error *e)
{
    bool right = false;
    if (!r->domain)
        return 0;
    if (holds(r, r->domain->met, frame, &right, e) ||
        (!right && (renew(r, true, false, e) || narrow_places(r, e))))
        return -1;
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (frame_has(r, frame, a) && (run_refresh(r, a, frame_place(r, frame, a), e) ||
                                       run_refresh(r, a, frame_reach(r, frame, a), e)))
            return -1;
    return 0;
}

int run_frame(struct run *r, size_t frame, struct error *e)
{
    const bool frozen = r->plan->frame[frame].frozen;
    const double begin = omp_get_wtime();
    bool made = frame == 0 || (r->frame_made[frame] && frozen);
    if (!made && r->frame_made[frame] && holds(r, r->kept, frame, &made, e))
        return -1;
    if (made)
        return 0;
    if (frozen && !r->frozen[frame])
        freeze(r, frame);
    if (meet_again(r, frame, e))
        return -1;
    const int status = make_frame(r, frame, true, e);
    r->frame_made[frame] = !status;
    r->cost.list_builds++;
    r->cost.neighbour += omp_get_wtime() - begin;
    return status;
}

static int renew(struct run *r, bool within, bool sort, struct error *e)
{
    int status = watch_places(r, true, e);
    if (!status)
        status = widen_places(r, e);
    for (size_t a = 0; !within && !status && a < r->plan->n_array; a++)
        sides_wrap(&r->plan->scene->box, &r->plan->array[a].p);
    if (!status && sort)
        status = run_domain_move(r, e) || widen_h(r, e) ? -1 : 0;
    for (size_t a = 0; !status && sort && a < r->plan->n_array; a++)
        status = sort_array(r, a, e);
    if (!status && sort) {
        r->builds_since_sort = 0;
        r->cost.sorts++;
        r->watch->sorted = true;
    }
    if (!status)
        status = make_lists(r, sort, sort, e);
    forget_h(r);
    r->lists_made = !status;
    r->cost.list_builds++;
    return status;
}

int run_lists(struct run *r, bool within, struct error *e)
{
    if (r->plan->n_list == 0) {
        for (size_t a = 0; !within && a < r->plan->n_array; a++)
            sides_wrap(&r->plan->scene->box, &r->plan->array[a].p);
        return 0;
    }
    double begin = omp_get_wtime();
    bool made = false;
    int status = r->lists_made ? holds(r, r->kept, 0, &made, e) : 0;
    if (!status && !made) {
        const bool first = !within && !r->lists_made && r->cost.list_builds == 0;
        const bool sort = !within && (!r->lists_made || ++r->builds_since_sort >= BUILDS_PER_SORT);
        bool uneven = false;
        status = renew(r, within, sort, e);
        if (!status && first)
            status = run_domain_uneven(r, &uneven, e);
        if (!status && uneven)
            status = renew(r, within, sort, e);
        if (!status)
            status = narrow_places(r, e); /* once: it rounds */
        r->lists_made = !status;
    }
    r->lists_suspect = false;
    r->cost.neighbour += omp_get_wtime() - begin;
    return status;
}

/* -- As they were ------------------------------------------------------------------------------- */

/* A column's real particles as they are held. */
struct held {
    char *data;
    float *low;
    struct column form;
};

static int hold(struct held *k, const struct particles *p, int column, struct error *e)
{
    const struct column *c = &p->column[column];
    *k = (struct held){malloc(c->ncomp * p->n * c->size + 1),
                       malloc(c->ncomp * p->n * sizeof(float) + 1), *c};
    if (!k->data || !k->low)
        return error_memory(e, "particles", c->ncomp * p->n * c->size);
    for (uint32_t q = 0; q < c->ncomp; q++) {
        memcpy(k->data + q * p->n * c->size, (const char *)c->data + q * c->plane * c->size,
               p->n * c->size);
        if (c->low)
            memcpy(k->low + q * p->n, c->low + q * c->plane, p->n * sizeof(float));
    }
    return 0;
}

/* The column is held as it was. */
static void give_back(struct held *k, struct particles *p, int column)
{
    struct column *c = &p->column[column];
    c->quantum = k->form.quantum;
    memcpy(c->centre, k->form.centre, sizeof c->centre);
    for (uint32_t q = 0; k->data && k->low && q < c->ncomp; q++) {
        memcpy((char *)c->data + q * c->plane * c->size, k->data + q * p->n * c->size,
               p->n * c->size);
        if (c->low)
            memcpy(c->low + q * c->plane, k->low + q * p->n, p->n * sizeof(float));
    }
}

static void stand(struct plan_array *a, const struct particles *was)
{
    const struct column *x = &a->p.column[a->position], *h = &a->p.column[a->smoothing];
    for (size_t i = 0; i < a->p.n; i++) {
        for (uint32_t c = 0; c < x->ncomp; c++)
            column_set(x, c, i, column_get(&was->column[0], c, i));
        column_set(h, 0, i, column_get(&was->column[1], 0, i));
    }
}

int run_lists_again(struct run *r, const struct particles *was, bool counted, struct error *e)
{
    const size_t n = r->plan->n_array;
    const double quantum = r->quantum, centre[3] = {r->centre[0], r->centre[1], r->centre[2]};
    struct held *held = calloc(2 * n + 1, sizeof *held);
    int status = held ? 0 : error_memory(e, "particles", n * sizeof *held);
    for (size_t a = 0; !status && a < n; a++) {
        struct plan_array *pa = &r->plan->array[a];
        if (hold(&held[2 * a], &pa->p, pa->position, e) ||
            hold(&held[2 * a + 1], &pa->p, pa->smoothing, e))
            status = -1;
    }
    if (!status)
        status = widen_places(r, e);
    for (size_t a = 0; !status && a < n; a++)
        if (frame_has(r, 0, a))
            stand(&r->plan->array[a], &was[a]);
    if (!status)
        status = make_lists(r, false, counted, e) || narrow_places(r, e) ? -1 : 0;
    forget_h(r);
    for (size_t a = 0; !status && a < n; a++) {
        struct plan_array *pa = &r->plan->array[a];
        give_back(&held[2 * a], &pa->p, pa->position);
        give_back(&held[2 * a + 1], &pa->p, pa->smoothing);
        run_changed(r, a, pa->position);
        run_changed(r, a, pa->smoothing);
    }
    r->quantum = quantum; /* the same again */
    memcpy(r->centre, centre, sizeof centre);
    r->lists_made = !status;
    for (size_t k = 0; held && k < 2 * n; k++) {
        free(held[k].data);
        free(held[k].low);
    }
    free(held);
    return status;
}

int run_refresh_ask(struct run *r, size_t array, int column, struct error *e)
{
    if (!r->stale[array][column])
        return 0;
    r->stale[array][column] = false;
    if (r->domain)
        return run_domain_ask(r, array, column, e);
    const double begin = omp_get_wtime();
    ghosts_refresh(&r->ghosts[array], &r->plan->scene->box, &r->plan->array[array].p, column);
    r->cost.neighbour += omp_get_wtime() - begin;
    return 0;
}

int run_refresh(struct run *r, size_t array, int column, struct error *e)
{
    return run_refresh_ask(r, array, column, e) || run_domain_begin(r, e) || run_domain_finish(r, e)
               ? -1
               : 0;
}

struct run_memory run_memory(const struct run *r)
{
    if (r->device)
        return run_device_memory(r);
    struct run_memory m = {0};
    const size_t n = r->plan->n_array;
    for (size_t k = 0; k < r->plan->n_list; k++) {
        m.lists += group_list_bytes(&r->list[k]);
        m.search = r->list[k].search_bytes > m.search ? r->list[k].search_bytes : m.search;
    }
    for (size_t k = 0; k < n * r->plan->n_frame; k++)
        m.places += skin_bytes(&r->kept[k]);
    for (size_t a = 0; a < n; a++)
        m.ghosts += r->ghosts[a].capacity * (sizeof(uint32_t) + sizeof(uint8_t));
    m.ghosts += run_domain_bytes(r, &m.lists, &m.places);
    return m;
}
