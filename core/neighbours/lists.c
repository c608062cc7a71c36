/* neighbours/lists.c -- makes the source lists of groups of destinations. Reads the clouds,
 * writes the list. Groups are shared among threads in chunks, which each makes in memory of its
 * own. Where a chunk goes is known once all before it are made; it is then moved there out of the
 * cache, if the list has room, as it has when it is made again; else when all are made. */
#include "neighbours/worker.h"

#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#define CHUNK 512 /* groups that a thread takes at a time */

#define NONE SIZE_MAX

/* Where a chunk's lists stand in its worker's memory, and where they go in the list. */
struct chunk {
    size_t span, n_span, step, n_step;
    size_t to_span, to_step;
    size_t next; /* of the same worker */
    bool made;
};

struct team {
    struct worker *worker;
    struct chunk *chunk;
    size_t n_worker, n_chunk;
    size_t crowded; /* the first chunk that ended at a crowd: those behind it are not made */
    size_t n_placed, n_span, n_step; /* chunks that know where they go; what is in them */
};

static int worker_number(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

/* Says where chunks go, up to the first that is not yet made; how many know it. */
static size_t chunk_made(struct team *t, size_t k)
{
    size_t placed;

#pragma omp critical(neighbour_chunks)
    {
        t->chunk[k].made = true;
        for (; t->n_placed < t->n_chunk && t->chunk[t->n_placed].made; t->n_placed++) {
            struct chunk *c = &t->chunk[t->n_placed];

            c->to_span = t->n_span;
            c->to_step = t->n_step;
            t->n_span += c->n_span;
            t->n_step += c->n_step;
        }
        placed = t->n_placed;
    }
    return placed;
}

/* Moves what a worker has left of the chunks before `placed`, as far as there is room. */
static void chunks_move(const struct group_list *list, const struct team *t, struct worker *w,
                        size_t placed)
{
    while (w->left < placed) {
        const struct chunk *c = &t->chunk[w->left];
        sph_span *span = list->span + c->to_span;

        if (c->to_span + c->n_span > list->span_capacity ||
            c->to_step + c->n_step > list->step_capacity) {
            return;
        }
        for (size_t s = 0; s < c->n_span; s++) {
            span[s] = w->span[c->span + s];
            span[s].first += c->to_step - c->step;
        }
        if (c->n_step > 0) {
            memcpy(list->step + c->to_step, w->step + c->step, c->n_step * sizeof *w->step);
        }
        w->left = c->next;
    }
}

/* Appends chunk k to its worker's memory, which begins anew where all in it has been moved. */
static void chunk_make(const struct team *t, const struct job *j, size_t n_group, struct worker *w,
                       size_t k)
{
    struct chunk *c = &t->chunk[k];
    size_t first = k * CHUNK, last = first + CHUNK;

    if (w->left == NONE && t->n_worker > 1) {
        w->n_span = w->n_step = 0;
    }
    *c = (struct chunk){.span = w->n_span, .step = w->n_step, .next = NONE};
    worker_make(j, w, first, last < n_group ? last : n_group);
    c->n_span = w->n_span - c->span;
    c->n_step = w->n_step - c->step;
    if (w->left == NONE) {
        w->left = k;
    } else {
        t->chunk[w->last].next = k;
    }
    w->last = k;
}

/* Chunk k is the last that is needed, unless one before it is. */
static void chunk_crowded(struct team *t, size_t k)
{
#pragma omp critical(neighbour_crowd)
    if (k < t->crowded) {
#pragma omp atomic write
        t->crowded = k;
    }
}

/* Which thread makes a chunk does not matter: what is in it depends on nothing but its groups. */
static void team_run(const struct group_list *list, struct team *t, const struct job *j)
{
#pragma omp parallel for schedule(dynamic, 1) num_threads((int)t->n_worker)
    for (size_t k = 0; k < t->n_chunk; k++) {
        struct worker *w = &t->worker[worker_number()];
        size_t placed, crowded;

#pragma omp atomic read
        crowded = t->crowded;
        if (k > crowded) {
            continue;
        }
        chunk_make(t, j, list->n_group, w, k);
        placed = chunk_made(t, k);
        if (j->crowd.stops && w->crowd.n > 0) {
            chunk_crowded(t, k);
            continue;
        }
        if (t->n_worker > 1) {
            chunks_move(list, t, w, placed);
        }
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

/* An array of n elements and little more, with what was in it. */
static int resize(void *array, size_t *capacity, size_t n, size_t size, struct error *e)
{
    void *old, *fresh;

    memcpy(&old, array, sizeof old);
    if (n <= *capacity && *capacity - n <= n / 64 + 64) {
        return 0;
    }
    n += n / 1024 + 16;
    fresh = realloc(old, n * size);
    *capacity = fresh ? n : *capacity;
    old = fresh ? fresh : old;
    memcpy(array, &old, sizeof old);
    return fresh ? 0 : error_memory(e, "neighbour lists", n * size);
}

/* Each group's count of spans becomes where they begin. */
static void list_begin(struct group_list *list)
{
    uint64_t sum = 0;

    for (size_t g = 0; g <= list->n_group; g++) {
        uint64_t count = list->begin[g];

        list->begin[g] = sum;
        sum += count;
    }
}

/* Puts the chunks together in the order of their groups. */
static int team_collect(struct group_list *list, struct team *t, struct error *e)
{
    list->n_span = t->n_span;
    list->n_entry = t->n_step;
    list_begin(list);
    if (t->n_worker == 1) {
        list_take(list, &t->worker[0]);
    }
    if (resize(&list->span, &list->span_capacity, list->n_span, sizeof *list->span, e) != 0 ||
        resize(&list->step, &list->step_capacity, list->n_entry, sizeof *list->step, e) != 0) {
        return -1;
    }
#pragma omp parallel for schedule(static, 1) num_threads((int)t->n_worker) if (t->n_worker > 1)
    for (size_t k = 0; k < t->n_worker; k++) {
        if (t->n_worker > 1) {
            chunks_move(list, t, &t->worker[k], t->n_chunk);
        }
    }
    return 0;
}

/* What the workers have met of crowds: the first in the order of the destinations. Chunks are begun in
 * order, so it is the same for any number of threads. */
static int team_crowd(struct group_list *list, const struct team *t, struct error *e)
{
    struct overflow *all = &list->crowd;

    for (size_t k = 0; k < t->n_worker; k++) {
        const struct overflow *c = &t->worker[k].crowd;

        if (c->n > 0 && (all->n == 0 || c->first < all->first)) {
            all->first = c->first;
            all->neighbours = c->neighbours;
        }
        all->n += c->n;
    }
    return all->stops && all->n > 0
               ? error_set(e, EXIT_RUN, "destination %zu has %llu neighbours, more than %llu",
                           all->first, (unsigned long long)all->neighbours,
                           (unsigned long long)all->most)
               : 0;
}

/* Whether every worker had the memory it needed; counts their work. */
static int team_check(struct group_list *list, const struct team *t, struct error *e)
{
    bool no_memory = false;

    list->candidates = list->visited = 0;
    for (size_t k = 0; k < t->n_worker; k++) {
        list->candidates += t->worker[k].candidates;
        list->visited += t->worker[k].visited;
        no_memory = no_memory || t->worker[k].no_memory;
    }
    return no_memory ? error_memory(e, "neighbour lists, and more", t->n_step * sizeof(uint16_t))
                     : 0;
}

/* Shares the groups among threads. */
static int list_fill(struct group_list *list, const struct job *j, int threads, struct error *e)
{
    struct team t = {.n_chunk = (list->n_group + CHUNK - 1) / CHUNK, .crowded = SIZE_MAX};
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
    for (size_t k = 0; k < t.n_worker; k++) {
        t.worker[k].left = NONE;
    }
    team_run(list, &t, j);
    status = team_check(list, &t, e);
    if (status == 0) {
        status = team_crowd(list, &t, e);
    }
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
    struct job j = {.dst = dst,
                    .filter = filter,
                    .scale = dst->scale * factor,
                    .src = &sources,
                    .all = src,
                    .symmetric = symmetric};
    size_t bytes = 0;
    void *search;
    int status = -1;

    threads = threads > 0 ? threads : 1;
    if (check(dst, src, symmetric, skin, e) != 0 ||
        list_reserve(list, (dst->n + LANES - 1) / LANES, e) != 0) {
        return -1;
    }
    list->symmetric = symmetric;
    list->crowd.n = 0;
    j.crowd = list->crowd;
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
