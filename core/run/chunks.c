/* run/chunks.c -- the stages of a pass on chunks of destinations (see chunks.h). Where a pass writes nothing
 * that its sweeps read of sources, a chunk goes through all stages while it is in the cache; else each
 * stage is finished for all before the next begins.
 *
 * Sweeps work on columns as they are held, or on their mirrors in floats. All other calls of a plugin see
 * doubles: of what is held in floats, a chunk's worth is laid out for the call and put back after it. */
#include "run/chunks.h"
#include "run/closing.h"
#include "run/domain.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define STRIDE (CHUNK + 2 * SPH_LANES) /* of a chunk that is laid out in doubles */

#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)
#define SUMS (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

enum stage { STAGE_RESET, STAGE_BEFORE, STAGE_POINT, STAGE_SWEEP, STAGE_AFTER };
#define STAGES_MOST 4

struct work {
    struct run *r;
    struct pass *p;
    const struct ranges *ranges;
    sph_batch alone;               /* what a destination does by itself; in doubles */
    sph_batch *pair;               /* [n_src] */
    enum stage stage[STAGES_MOST]; /* in order; STAGE_SWEEP over all sources */
    size_t n_stage;
    struct closing closing;
    size_t laid;   /* bytes that a thread needs to lay out a chunk; 0: nothing is */
    size_t room;   /* and for the chunk's closing, behind them */
    char *scratch; /* [threads] of them */
};

static const struct particles *destinations(const struct work *w)
{
    return &w->r->plan->array[w->p->dst.array].p;
}

static const sph_prop *prop_at(const struct work *w, uint32_t k)
{
    return list_at(&w->p->use.item->props, k);
}

static uint32_t n_prop(const struct work *w)
{
    return w->p->use.item->props.count;
}

/* Whether calls other than sweeps are given the property. */
static bool is_given(const struct work *w, uint32_t k)
{
    const uint32_t access = prop_at(w, k)->access;
    return (access & (SPH_DST_READ | WRITES)) && !(access & SPH_DST_SWEEP);
}

static bool in_floats(const struct work *w, uint32_t k)
{
    const int column = w->p->dst.column[k];
    const struct column *c = column < 0 ? NULL : &destinations(w)->column[column];
    return c && column_is_real(c) && c->size == sizeof(float);
}

/* The smoothing lengths, if the pass is given them and they are not held in doubles. */
static const struct column *smoothing_in_floats(const struct work *w)
{
    const struct column *h = &destinations(w)->column[w->r->plan->array[w->p->dst.array].smoothing];
    return w->p->shape == SPH_PAIR && h->size == sizeof(float) ? h : NULL;
}

/* -- Stages of one chunk ------------------------------------------------------------------------ */

static void fill(float *to, uint64_t n, float value)
{
    for (uint64_t i = 0; i < n; i++)
        to[i] = value;
}

static void reset(const struct work *w, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; k < n_prop(w); k++) {
        const sph_prop *prop = prop_at(w, k);
        const struct column *c = &destinations(w)->column[w->p->dst.column[k]];
        if (!(prop->access & SUMS) || w->p->continues[k])
            continue;
        const float high = (float)prop->start;
        for (uint32_t q = 0; q < c->ncomp; q++) {
            const uint64_t at = q * c->plane + first;
            if (c->size == sizeof(float))
                fill((float *)c->data + at, count, high);
            else
                for (uint64_t i = 0; i < count; i++)
                    ((double *)c->data)[at + i] = prop->start;
            if (c->low)
                fill(c->low + at, count, column_rest(prop->start, high));
            if (c->mirror && w->p->real == SPH_F32)
                fill((float *)c->mirror + at, count, high);
        }
    }
}

static int position(const struct work *w)
{
    return w->r->plan->array[w->p->dst.array].position;
}

/* What `before` has written into doubles, for sweeps that read and sum in their mirrors. */
static void reflect(const struct work *w, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; w->p->real == SPH_F32 && k < n_prop(w); k++) {
        const int column = w->p->dst.column[k];
        if (!(prop_at(w, k)->access & WRITES) || column == position(w))
            continue; /* the position's mirror is no float */
        const struct column *c = &destinations(w)->column[column];
        for (uint32_t q = 0; c->mirror && q < c->ncomp; q++) {
            const double *from = (const double *)c->data + q * c->plane + first;
            float *to = (float *)c->mirror + q * c->plane + first;
            for (uint64_t i = 0; i < count; i++)
                to[i] = (float)from[i];
        }
    }
}

/* What the sweeps have summed in mirrors, back into the columns. */
static void collect(const struct work *w, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; w->p->real == SPH_F32 && k < n_prop(w); k++) {
        const struct column *c = &destinations(w)->column[w->p->dst.column[k]];
        if (!(prop_at(w, k)->access & SUMS) || !c->mirror)
            continue;
        for (uint32_t q = 0; q < c->ncomp; q++) {
            const float *from = (const float *)c->mirror + q * c->plane + first;
            double *to = (double *)c->data + q * c->plane + first;
            for (uint64_t i = 0; i < count; i++)
                to[i] = (double)from[i];
        }
    }
}

/* Of one column; behind it there is room again. No pointer is formed that points before its memory: whole
 * numbers are. */
static double *lay_out_one(const struct column *c, double *at, uint64_t first, uint64_t count,
                           bool loads, sph_column *view)
{
    for (uint32_t q = 0; loads && q < c->ncomp; q++)
        column_load(c, q, first, count, at + q * STRIDE);
    view->data = (void *)((uintptr_t)at - first * sizeof(double));
    view->plane = STRIDE;
    return at + (size_t)c->ncomp * STRIDE;
}

/* Doubles of a chunk of what is not held in them: laid out so that element i of the view is particle i. Of
 * what is only written the old values are not looked for, but by a pass that iterates, which may leave
 * some. */
static void lay_out(const struct work *w, char *scratch, sph_column *view, sph_batch *b)
{
    const struct column *h = smoothing_in_floats(w);
    double *at = (double *)(void *)scratch;
    if (h)
        at = lay_out_one(h, at, b->first, b->count, true, &b->h_dst);
    for (uint32_t k = 0; k < n_prop(w); k++) {
        const struct column *c = &destinations(w)->column[w->p->dst.column[k]];
        const bool loads = w->p->max_sweeps || prop_at(w, k)->access != SPH_DST_WRITE;
        view[k] = w->alone.dst[k];
        if (in_floats(w, k) && !is_given(w, k))
            view[k].data = NULL;
        else if (in_floats(w, k))
            at = lay_out_one(c, at, b->first, b->count, loads, &view[k]);
    }
    b->dst = view;
}

static void put_back(const struct work *w, const char *scratch, uint64_t first, uint64_t count)
{
    const double *at = (const double *)(const void *)scratch;
    if (smoothing_in_floats(w))
        at += STRIDE;
    for (uint32_t k = 0; k < n_prop(w); k++) {
        const struct column *c = &destinations(w)->column[w->p->dst.column[k]];
        if (!in_floats(w, k) || !is_given(w, k))
            continue;
        for (uint32_t q = 0; (prop_at(w, k)->access & WRITES) && q < c->ncomp; q++)
            column_store(c, q, first, count, at + q * STRIDE);
        at += (size_t)c->ncomp * STRIDE;
    }
}

static sph_status alone(const struct work *w, sph_range_fn f, char *scratch, uint64_t first,
                        uint64_t count)
{
    sph_batch b = w->alone;
    b.first = first;
    b.count = count;
    if (!w->laid)
        return f(&b);
    sph_column *view = (sph_column *)(void *)scratch;
    char *room = scratch + (n_prop(w) * sizeof *view + 63) / 64 * 64;
    lay_out(w, room, view, &b);
    const sph_status status = f(&b);
    put_back(w, room, first, count);
    return status;
}

static sph_status sweeps(const struct work *w, uint64_t first, uint64_t count)
{
    sph_status status = SPH_OK;
    for (size_t s = 0; s < w->p->n_src && status == SPH_OK; s++) {
        sph_batch b = w->pair[s];
        b.first = first;
        b.count = count;
        status = w->p->run(&b);
    }
    collect(w, first, count);
    return status;
}

static sph_status do_stage(const struct work *w, enum stage stage, char *scratch, size_t k)
{
    const uint64_t first = w->ranges->first[k], count = w->ranges->count[k];
    switch (stage) {
    case STAGE_RESET:
        reset(w, first, count);
        return SPH_OK;
    case STAGE_BEFORE: {
        const sph_status status = alone(w, w->p->before, scratch, first, count);
        reflect(w, first, count);
        return status;
    }
    case STAGE_POINT:
        return alone(w, w->p->run, scratch, first, count);
    case STAGE_SWEEP:
        return sweeps(w, first, count);
    case STAGE_AFTER:
        return alone(w, w->p->after, scratch, first, count);
    }
    return SPH_E_INVALID;
}

/* -- All chunks --------------------------------------------------------------------------------- */

static int failed(const struct run *r, const struct pass *p, sph_status status, struct error *e)
{
    char why[512];
    registry_reason(r->plan->registry, status, why, sizeof why);
    return error_set(e, EXIT_RUN, "%s at step %llu, t = %g: %s", p->name,
                     (unsigned long long)r->step, r->time, why);
}

/* Stages [from, to) of a chunk; with the last the pass is done with it. */
static sph_status do_chunk(struct work *w, size_t from, size_t to, size_t k)
{
    const uint64_t first = w->ranges->first[k], count = w->ranges->count[k];
    char *scratch = w->room ? w->scratch + (size_t)omp_get_thread_num() * w->room : NULL;
    void *kept = scratch ? scratch + w->laid : NULL;
    sph_status status = SPH_OK;
    if (from == 0)
        closing_open(&w->closing, kept, first, count);
    for (size_t s = from; s < to && status == SPH_OK; s++)
        status = do_stage(w, w->stage[s], scratch, k);
    if (to == w->n_stage)
        closing_close(&w->closing, kept, k, first, count);
    return status;
}

/* Stages [from, to) of chunks [begin, end). */
static int do_chunks(struct work *w, size_t from, size_t to, size_t begin, size_t end,
                     struct error *e)
{
    sph_status worst = SPH_OK;
    const int threads = w->p->serial || end - begin < 2 ? 1 : w->r->threads;
    const bool pokes = begin < w->ranges->near && w->ranges->near < w->ranges->n;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (size_t k = begin; k < end; k++) {
        const sph_status status = do_chunk(w, from, to, k);
        if (pokes && omp_get_thread_num() == 0)
            run_domain_poke(w->r);
        if (status != SPH_OK) {
#pragma omp critical(pass_status)
            if (status < worst)
                worst = status;
        }
    }
    return worst == SPH_OK ? 0 : failed(w->r, w->p, worst, e);
}

/* Stages [from, to) of every chunk. */
static int do_stages(struct work *w, size_t from, size_t to, struct error *e)
{
    const struct ranges *a = w->ranges;
    if (do_chunks(w, from, to, 0, a->near, e))
        return -1;
    if (a->near == a->n)
        return 0;
    return pass_arrive(w->r, w->p, e) || do_chunks(w, from, to, a->near, a->n, e) ? -1 : 0;
}

/* -- Batches ------------------------------------------------------------------------------------ */

static void batch_alone(struct work *w)
{
    const struct pass *p = w->p;
    const struct plan_array *a = &w->r->plan->array[p->dst.array];
    sph_column *dst = p->space;
    for (uint32_t k = 0; k < n_prop(w); k++)
        dst[k] = p->dst.column[k] < 0 || prop_at(w, k)->access & SPH_DST_SWEEP
                     ? (sph_column){0}
                     : particles_column(&a->p, p->dst.column[k]);
    w->alone = run_batch(w->r, &p->use, dst, n_prop(w), a->p.n);
    if (p->shape == SPH_PAIR)
        w->alone.h_dst = particles_column(&a->p, a->smoothing);
}

static sph_column column_for(const struct work *w, const struct particles *p, int column)
{
    return w->p->real == SPH_F32 ? particles_column4(p, column) : particles_column(p, column);
}

/* The place that neighbours were looked for in. */
static int place_in(const struct work *w, const struct plan_array *a)
{
    return w->p->frame == 0 ? a->position
                            : particles_find(&a->p, w->r->plan->frame[w->p->frame].name);
}

static bool is_uniform(const struct run *r, size_t dst, size_t src)
{
    return r->h_fixed && !(r->h_low[dst] < r->h_high[dst]) && !(r->h_low[src] < r->h_high[src]) &&
           !(r->h_low[dst] < r->h_low[src]) && !(r->h_low[src] < r->h_low[dst]);
}

static void batch_pair(struct work *w, size_t s)
{
    struct run *r = w->r;
    const struct pass *p = w->p;
    const struct binding *from = &p->src[s];
    const struct plan_array *dst = &r->plan->array[p->dst.array],
                            *src = &r->plan->array[from->array];
    const struct group_list *list = &r->list[p->list[s]];
    const uint32_t n = n_prop(w);
    sph_column *own = p->space + n, *others = p->space + (2 + s) * n;
    for (uint32_t k = 0; k < n; k++) {
        own[k] = p->dst.column[k] < 0 ? (sph_column){0} : column_for(w, &dst->p, p->dst.column[k]);
        others[k] = from->column[k] < 0 ? (sph_column){0} : column_for(w, &src->p, from->column[k]);
    }
    sph_batch b = w->alone;
    b.real = p->real;
    b.dst = own;
    b.src = others;
    b.n_src = src->p.n + src->p.n_ghost;
    b.same = from->array == p->dst.array;
    b.path = r->path;
    b.quantum = p->real == SPH_F32 ? r->quantum : 0.0;
    b.uniform_h = is_uniform(r, p->dst.array, from->array);
    b.begin = list->begin;
    b.span = list->span;
    b.list = list->step;
    b.x_dst = column_for(w, &dst->p, place_in(w, dst));
    b.h_dst = column_for(w, &dst->p, dst->smoothing);
    b.x_src = column_for(w, &src->p, place_in(w, src));
    b.h_src = column_for(w, &src->p, src->smoothing);
    w->pair[s] = b;
}

static int make_room(struct work *w, struct error *e)
{
    size_t doubles = smoothing_in_floats(w) ? STRIDE : 0;
    for (uint32_t k = 0; k < n_prop(w); k++)
        if (in_floats(w, k) && is_given(w, k))
            doubles += (size_t)destinations(w)->column[w->p->dst.column[k]].ncomp * STRIDE;
    if (doubles && (w->p->before || w->p->after || w->p->shape == SPH_POINT))
        w->laid = ((n_prop(w) * sizeof(sph_column) + 63) / 64 + (doubles * 8 + 63) / 64 + 2) * 64;
    w->room = w->laid + closing_room(&w->closing, CHUNK);
    if (!w->room)
        return 0;
    w->scratch = aligned_alloc(64, (size_t)w->r->threads * w->room);
    return w->scratch ? 0 : error_memory(e, "columns in doubles", (size_t)w->r->threads * w->room);
}

static int run_stages(struct work *w, struct error *e)
{
    const struct pass *p = w->p;
    int status = 0;
    w->stage[w->n_stage++] = STAGE_RESET;
    if (p->before)
        w->stage[w->n_stage++] = STAGE_BEFORE;
    w->stage[w->n_stage++] = p->shape == SPH_POINT ? STAGE_POINT : STAGE_SWEEP;
    if (p->after)
        w->stage[w->n_stage++] = STAGE_AFTER;
    if (p->local)
        status = do_stages(w, 0, w->n_stage, e);
    for (size_t k = 0; !status && !p->local && k < w->n_stage; k++)
        status = do_stages(w, k, k + 1, e);
    if (!status)
        closing_end(&w->closing);
    return status;
}

int chunks_run(struct run *r, struct pass *p, const struct ranges *ranges, struct error *e)
{
    struct work w = {.r = r, .p = p, .ranges = ranges};
    batch_alone(&w);
    w.pair = calloc(p->n_src + 1, sizeof *w.pair);
    int status = w.pair ? 0 : error_memory(e, "a pass", p->n_src * sizeof *w.pair);
    for (size_t s = 0; !status && p->shape == SPH_PAIR && s < p->n_src; s++)
        batch_pair(&w, s);
    if (!status)
        status = closing_begin(&w.closing, r, p, ranges->n, e);
    if (!status)
        status = make_room(&w, e);
    if (!status)
        status = run_stages(&w, e);
    closing_free(&w.closing);
    free(w.pair);
    free(w.scratch);
    return status;
}

int chunks_prepare(struct run *r, const struct pass *p, struct error *e)
{
    if (!p->function || !p->function->prepare)
        return 0;
    sph_batch b =
        run_batch(r, &p->use, NULL, p->use.item->props.count, r->plan->array[p->dst.array].p.n);
    b.first = b.count = 0;
    const sph_status status = p->function->prepare(&b);
    return status == SPH_OK ? 0 : failed(r, p, status, e);
}
