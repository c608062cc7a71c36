/* neighbours/lists.c -- makes the source lists of groups of destinations. Reads the clouds,
 * writes the list. Groups are shared among threads in chunks, whose lists are then joined in
 * order. */
#include "neighbours/worker.h"

#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#define CHUNK 512 /* groups that a thread takes at a time */

/* Where a chunk's lists stand in its worker's memory. */
struct chunk {
    size_t worker, span, n_span, step, n_step;
};

struct team {
    struct worker *worker;
    struct chunk *chunk;
    size_t n_worker, n_chunk;
};

static int worker_number(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

/* Which thread makes a chunk does not matter: what is in it depends on nothing but its groups. */
static void team_run(struct team *t, const struct job *j, size_t n_group)
{
#pragma omp parallel for schedule(dynamic, 1) num_threads((int)t->n_worker)
    for (size_t k = 0; k < t->n_chunk; k++) {
        size_t me = (size_t)worker_number(), first = k * CHUNK, last = first + CHUNK;
        struct worker *w = &t->worker[me];

        t->chunk[k] = (struct chunk){.worker = me, .span = w->n_span, .step = w->n_step};
        worker_make(j, w, first, last < n_group ? last : n_group);
        t->chunk[k].n_span = w->n_span - t->chunk[k].span;
        t->chunk[k].n_step = w->n_step - t->chunk[k].step;
    }
}

/* A single worker works in the list's own memory. */
static void list_lend(struct group_list *list, struct worker *w)
{
    w->span = list->span;
    w->span_capacity = list->span_capacity;
    w->step = list->step;
    w->step_capacity = list->step_capacity;
    list->span = NULL;
    list->step = NULL;
    list->span_capacity = list->step_capacity = 0;
}

static void list_take(struct group_list *list, struct worker *w)
{
    list->span = w->span;
    list->span_capacity = w->span_capacity;
    list->step = w->step;
    list->step_capacity = w->step_capacity;
    w->span = NULL;
    w->step = NULL;
    w->span_capacity = w->step_capacity = 0;
}

/* An array of n elements and little more; what was in it is kept if `keep`. */
static int resize(void *array, size_t *capacity, size_t n, size_t size, bool keep, struct error *e)
{
    void *old, *fresh;

    memcpy(&old, array, sizeof old);
    if (n <= *capacity && *capacity - n <= n / 32 + 64) {
        return 0;
    }
    n += n / 128 + 16;
    if (!keep) {
        free(old);
        old = NULL;
    }
    fresh = realloc(old, n * size);
    *capacity = fresh ? n : keep ? *capacity : 0;
    old = fresh ? fresh : old;
    memcpy(array, &old, sizeof old);
    return fresh ? 0 : error_memory(e, "neighbour lists", n * size);
}

static int list_resize(struct group_list *list, bool keep, struct error *e)
{
    return resize(&list->span, &list->span_capacity, list->n_span, sizeof *list->span, keep, e) ||
                   resize(&list->step, &list->step_capacity, list->n_entry, sizeof *list->step,
                          keep, e)
               ? -1
               : 0;
}

/* Where a chunk's spans and steps go: counts become begins. */
static void team_place(struct group_list *list, const struct team *t)
{
    uint64_t sum = 0;

    for (size_t g = 0; g < list->n_group; g++) {
        uint64_t count = list->begin[g];

        list->begin[g] = sum;
        sum += count;
    }
    list->begin[list->n_group] = list->n_span = sum;
    list->n_entry = 0;
    for (size_t k = 0; k < t->n_worker; k++) {
        list->n_entry += t->worker[k].n_step;
    }
}

/* Joins the chunks in the order of their groups. */
static int team_collect(struct group_list *list, struct team *t, struct error *e)
{
    size_t *first = NULL, sum = 0;

    team_place(list, t);
    if (t->n_worker == 1) {
        list_take(list, &t->worker[0]);
        return list_resize(list, true, e);
    }
    first = malloc(t->n_chunk * sizeof *first);
    if (!first) {
        return error_memory(e, "neighbour lists", t->n_chunk * sizeof *first);
    }
    for (size_t k = 0; k < t->n_chunk; k++) {
        first[k] = sum;
        sum += t->chunk[k].n_step;
    }
    if (list_resize(list, false, e) != 0) {
        free(first);
        return -1;
    }
#pragma omp parallel for schedule(static) num_threads((int)t->n_worker)
    for (size_t k = 0; k < t->n_chunk; k++) {
        const struct chunk *c = &t->chunk[k];
        const struct worker *w = &t->worker[c->worker];
        sph_span *span = list->span + list->begin[k * CHUNK];

        for (size_t s = 0; s < c->n_span; s++) {
            span[s] = w->span[c->span + s];
            span[s].first += first[k] - c->step;
        }
        if (c->n_step > 0) {
            memcpy(list->step + first[k], w->step + c->step, c->n_step * sizeof *w->step);
        }
    }
    free(first);
    return 0;
}

/* Whether every worker had the memory it needed; counts their work. */
static int team_check(struct group_list *list, const struct team *t, struct error *e)
{
    size_t bytes = 0;
    bool no_memory = false;

    list->candidates = list->visited = 0;
    for (size_t k = 0; k < t->n_worker; k++) {
        list->candidates += t->worker[k].candidates;
        list->visited += t->worker[k].visited;
        bytes += t->worker[k].n_step * sizeof *t->worker[k].step;
        no_memory = no_memory || t->worker[k].no_memory;
    }
    return no_memory ? error_memory(e, "neighbour lists, and more", bytes) : 0;
}

/* Shares the groups among threads. */
static int list_fill(struct group_list *list, const struct job *j, int threads, struct error *e)
{
    struct team t = {.n_chunk = (list->n_group + CHUNK - 1) / CHUNK};
    int status = -1;

    t.n_worker = (size_t)threads < t.n_chunk ? (size_t)threads : t.n_chunk;
    t.worker = calloc(t.n_worker, sizeof *t.worker);
    t.chunk = calloc(t.n_chunk, sizeof *t.chunk);
    if (!t.worker || !t.chunk) {
        error_memory(e, "neighbour lists", t.n_chunk * sizeof *t.chunk);
        goto done;
    }
    if (t.n_worker == 1) {
        list_lend(list, &t.worker[0]);
    }
    team_run(&t, j, list->n_group);
    status = team_check(list, &t, e);
    if (status == 0) {
        status = team_collect(list, &t, e);
    }
    for (size_t k = 0; k < t.n_worker; k++) {
        list->search_bytes += worker_bytes(&t.worker[k]);
    }
done:
    for (size_t k = 0; t.worker && k < t.n_worker; k++) {
        worker_fini(&t.worker[k]);
    }
    free(t.worker);
    free(t.chunk);
    return status;
}

static int list_reserve(struct group_list *list, size_t n_group, struct error *e)
{
    list->n_group = list->n_span = 0;
    list->n_entry = 0;
    if (n_group + 1 > list->group_capacity) {
        size_t capacity = n_group + n_group / 128 + 1;
        uint64_t *begin = realloc(list->begin, capacity * sizeof *begin);

        if (!begin) {
            return error_memory(e, "neighbour lists", capacity * sizeof *begin);
        }
        list->begin = begin;
        list->group_capacity = capacity;
    }
    list->n_group = n_group;
    memset(list->begin, 0, (n_group + 1) * sizeof *list->begin);
    return 0;
}

static int check(const struct cloud *dst, const struct cloud *src, bool symmetric, double skin,
                 struct error *e)
{
    if (dst->dim < 1 || dst->dim > 3 || src->dim != dst->dim) {
        return error_set(e, EXIT_RUN, "neighbour lists between %d and %d dimensions", dst->dim,
                         src->dim);
    }
    if (!(skin >= 0 && skin < 1e6) || !(dst->scale >= 0) || (symmetric && !(src->scale >= 0))) {
        return error_set(e, EXIT_RUN, "neighbour lists with a skin of %g and a reach of %g h", skin,
                         dst->scale);
    }
    if ((dst->n > 0 && !dst->h) || (symmetric && src->n > 0 && !src->h)) {
        return error_set(e, EXIT_RUN, "neighbour lists of particles without smoothing length");
    }
    return 0;
}

int filter_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                bool symmetric, double skin, const struct neighbour_manager *manager, int threads,
                const struct filter *filter, struct error *e)
{
    double factor = (1 + skin) * (1 + SLACK);
    struct sources sources;
    struct job j = {.dst = dst, .filter = filter, .scale = dst->scale * factor, .src = &sources};
    size_t bytes = 0;
    void *search;
    int status = -1;

    threads = threads > 0 ? threads : 1;
    if (check(dst, src, symmetric, skin, e) != 0 ||
        list_reserve(list, (dst->n + LANES - 1) / LANES, e) != 0) {
        return -1;
    }
    list->symmetric = symmetric;
    list->candidates = list->visited = list->search_bytes = 0;
    if (sources_make(&sources, dst, src, symmetric, factor, threads, e) != 0) {
        list->n_group = 0;
        return -1;
    }
    if (dst->n == 0 || src->n == 0) {
        return 0;
    }
    list->manager = manager ? manager : neighbour_manager_default();
    j.manager = list->manager->calls;
    j.search = search = j.manager->make(&sources, filter, threads, &bytes, e);
    j.count = list->begin;
    list->search_bytes = sources.bytes + bytes;
    if (search) {
        status = list_fill(list, &j, threads, e);
        j.manager->free(search);
    }
    sources_free(&sources);
    if (status != 0) {
        list->n_group = list->n_span = 0; /* nobody shall read half a list */
        list->n_entry = 0;
    }
    return status;
}

int group_list_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                    bool symmetric, double skin, const struct neighbour_manager *manager,
                    int threads, struct error *e)
{
    return filter_make(list, dst, src, symmetric, skin, manager, threads, filter_best(), e);
}

void group_list_fini(struct group_list *list)
{
    free(list->begin);
    free(list->span);
    free(list->step);
    memset(list, 0, sizeof *list);
}

size_t group_list_bytes(const struct group_list *list)
{
    return list->group_capacity * sizeof *list->begin + list->span_capacity * sizeof *list->span +
           list->step_capacity * sizeof *list->step;
}
