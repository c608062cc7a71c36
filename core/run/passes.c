/* run/passes.c -- executes passes: accumulators set to their start, ghosts refreshed, chunks of groups handed
 * to the plugin on all threads, sweeps repeated where a pass iterates, reductions taken. */
#include "run/run.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Destinations a task: a multiple of SPH_LANES, small enough to balance, large enough to hide the call. */
#define CHUNK 512

/* Ranges of destinations that still take part. */
struct ranges {
    uint64_t *first, *count;
    size_t n, capacity;
};

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
    return 0;
}

static int call(struct run *r, const struct pass *p, sph_range_fn f, const sph_batch *batch,
                const struct ranges *ranges, struct error *e)
{
    sph_status worst = SPH_OK;
    const long n = (long)ranges->n;
    const int threads = p->serial || n < 2 ? 1 : r->threads;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (long k = 0; k < n; k++) {
        sph_batch b = *batch;
        b.first = ranges->first[k];
        b.count = ranges->count[k];
        sph_status status = f(&b);
        if (status != SPH_OK) {
#pragma omp critical(pass_status)
            if (status < worst)
                worst = status;
        }
    }
    if (worst == SPH_OK)
        return 0;
    char why[512];
    registry_reason(r->plan->registry, worst, why, sizeof why);
    return error_set(e, EXIT_RUN, "%s at step %llu, t = %g: %s", p->name,
                     (unsigned long long)r->step, r->time, why);
}

static void reset_accumulators(const struct run *r, const struct pass *p,
                               const struct ranges *ranges)
{
    const struct particles *particles = &r->plan->array[p->dst.array].p;
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (!(prop->access & (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)) || p->continues[k])
            continue;
        const struct column *column = &particles->column[p->dst.column[k]];
        for (uint32_t c = 0; c < column->ncomp; c++)
            for (size_t q = 0; q < ranges->n; q++)
                for (uint64_t i = ranges->first[q]; i < ranges->first[q] + ranges->count[q]; i++)
                    ((double *)column->data)[c * column->plane + i] = prop->start;
    }
}

static void columns_of(const struct run *r, const struct pass *p, const struct binding *b,
                       sph_column *out)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++)
        out[k] = b->column[k] < 0 ? (sph_column){0}
                                  : particles_column(&r->plan->array[b->array].p, b->column[k]);
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

static void batch_begin(const struct run *r, const struct pass *p, sph_batch *b, sph_column *dst)
{
    const struct plan_array *a = &r->plan->array[p->dst.array];
    columns_of(r, p, &p->dst, dst);
    *b = run_batch(r, &p->use, dst, p->use.item->props.count, a->p.n);
    if (p->shape == SPH_PAIR) {
        b->x_dst = particles_column(&a->p, a->position);
        b->h_dst = particles_column(&a->p, a->smoothing);
    }
}

static void batch_source(const struct run *r, const struct pass *p, size_t s, sph_batch *b,
                         sph_column *src)
{
    const struct plan *plan = r->plan;
    const struct plan_array *from = &plan->array[p->src[s].array];
    const struct group_list *list = &r->list[p->dst.array * plan->n_array + p->src[s].array];
    columns_of(r, p, &p->src[s], src);
    b->src = src;
    b->n_src = from->p.n + from->p.n_ghost;
    b->same = p->src[s].array == p->dst.array;
    b->begin = list->begin;
    b->list = list->source;
    b->x_src = particles_column(&from->p, from->position);
    b->h_src = particles_column(&from->p, from->smoothing);
}

static void refresh_sources(struct run *r, const struct pass *p)
{
    for (size_t s = 0; s < p->n_src; s++) {
        const struct binding *b = &p->src[s];
        run_refresh(r, b->array, r->plan->array[b->array].position);
        run_refresh(r, b->array, r->plan->array[b->array].smoothing);
        for (uint32_t k = 0; k < p->use.item->props.count; k++)
            if (b->column[k] >= 0)
                run_refresh(r, b->array, b->column[k]);
    }
}

/* What the pass has written is old in the ghosts; a changed h or x makes the lists suspect. */
static void mark_written(struct run *r, const struct pass *p)
{
    const struct plan_array *a = &r->plan->array[p->dst.array];
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        int c = p->dst.column[k];
        if (c < 0 || !pass_writes(p, p->dst.array, c))
            continue;
        r->stale[p->dst.array][c] = a->p.n_ghost > 0;
        if (c == a->smoothing || c == a->position)
            r->lists_suspect = true;
    }
}

static int sweep(struct run *r, struct pass *p, const struct ranges *ranges, struct error *e)
{
    sph_column *dst = p->space, *src = p->space + p->use.item->props.count;
    sph_batch b;
    if (p->shape == SPH_PAIR && r->lists_suspect && run_lists(r, true, e))
        return -1;
    if (p->shape == SPH_PAIR)
        refresh_sources(r, p);
    batch_begin(r, p, &b, dst);
    reset_accumulators(r, p, ranges);
    audit_begin(r, p);
    const sph_batch alone = b; /* no sources: for what each destination does by itself */
    int status = p->before ? call(r, p, p->before, &alone, ranges, e) : 0;
    if (!status && p->shape == SPH_POINT)
        status = call(r, p, p->run, &b, ranges, e);
    for (size_t s = 0; !status && p->shape == SPH_PAIR && s < p->n_src; s++) {
        batch_source(r, p, s, &b, src);
        status = call(r, p, p->run, &b, ranges, e);
    }
    if (!status && p->after)
        status = call(r, p, p->after, &alone, ranges, e);
    if (audit_end(r, p, status ? NULL : e))
        status = -1;
    mark_written(r, p);
    return status;
}

static void count_pairs(struct run *r, struct pass *p, const struct ranges *ranges)
{
    const struct plan *plan = r->plan;
    p->sweeps++;
    for (size_t s = 0; p->shape == SPH_PAIR && s < p->n_src; s++) {
        const struct group_list *list = &r->list[p->dst.array * plan->n_array + p->src[s].array];
        uint64_t entries = 0;
        for (size_t k = 0; k < ranges->n; k++) {
            uint64_t g = ranges->first[k] / SPH_LANES;
            uint64_t end = (ranges->first[k] + ranges->count[k] + SPH_LANES - 1) / SPH_LANES;
            entries += list->begin[end] - list->begin[g];
        }
        uint64_t pairs = (uint64_t)(list->true_share * (double)entries);
        p->pairs += pairs;
        r->cost.pairs += pairs;
    }
}

/* The plugin's own turn: no particles, one thread. */
static int prepare(struct run *r, const struct pass *p, struct error *e)
{
    if (!p->function || !p->function->prepare)
        return 0;
    sph_batch b;
    uint64_t zero = 0;
    struct ranges once = {&zero, &zero, 1, 1};
    batch_begin(r, p, &b, p->space);
    b.dst = NULL;
    b.x_dst = b.h_dst = (sph_column){0};
    return call(r, p, p->function->prepare, &b, &once, e);
}

static int run_pass(struct run *r, struct pass *p, struct error *e)
{
    const struct particles *particles = &r->plan->array[p->dst.array].p;
    double begin = omp_get_wtime(), other = r->cost.neighbour;
    struct ranges ranges = {0};
    int status = prepare(r, p, e);
    if (!status)
        status = ranges_all(&ranges, particles->n, e);
    for (uint32_t k = 0; !status && ranges.n; k++) {
        status = sweep(r, p, &ranges, e);
        if (status)
            break;
        count_pairs(r, p, &ranges);
        if (!p->max_sweeps)
            break;
        status = ranges_unfinished(&ranges, particles->column[p->unfinished].data, particles->n, e);
        if (k + 1 >= p->max_sweeps) {
            r->cost.unfinished += ranges.n;
            break;
        }
    }
    ranges_free(&ranges);
    if (!status && (r->look || r->audit))
        status = finite_pass(r, p, e);
    p->seconds += omp_get_wtime() - begin - (r->cost.neighbour - other);
    return status;
}

/* The same order of summation for any number of threads. A NaN in a minimum or maximum comes through. */
static double reduce(const struct plan *plan, const struct reduction *d)
{
    const struct plan_array *a = &plan->array[d->array];
    const double *value = a->p.column[d->column].data, *m = a->p.column[a->mass].data;
    uint32_t op = d->declared->op;
    double out = op == SPH_REDUCE_MIN ? INFINITY : op == SPH_REDUCE_MAX ? -INFINITY : 0.0;
    bool weighted = d->declared->use == SPH_USE_INTERNAL || d->declared->use == SPH_USE_POTENTIAL;
    for (size_t i = 0; i < a->p.n; i++) {
        if (op == SPH_REDUCE_SUM)
            out += weighted ? m[i] * value[i] : value[i];
        else if (isnan(value[i]))
            return NAN;
        else
            out = op == SPH_REDUCE_MIN ? fmin(out, value[i]) : fmax(out, value[i]);
    }
    return out;
}

/* Right after its pass: later steps, and other functions, see what it came to. */
static void reduce_pass(struct run *r, size_t pass)
{
    for (size_t i = 0; i < r->plan->n_reduction; i++)
        if (r->plan->reduction[i].pass == pass)
            r->reduced[i] = reduce(r->plan, &r->plan->reduction[i]);
}

static void bound_dt(struct run *r)
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
    if (moment != MOMENT_FINISH && run_lists(r, false, e))
        return -1;
    for (size_t i = 0; i < r->plan->n_pass; i++) {
        if (r->plan->pass[i].moment != moment)
            continue;
        if (run_pass(r, &r->plan->pass[i], e))
            return -1;
        reduce_pass(r, i);
    }
    if (moment != MOMENT_EVALUATE)
        return 0;
    bound_dt(r);
    return finite_rates(r, e);
}
