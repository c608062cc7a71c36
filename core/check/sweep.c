/* check/sweep.c -- calls passes (see sweep.h). Touches the columns of its bench. */
#include "check/sweep.h"

#include "registry/fpmode.h"
#include "scene/random.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>

#define MOST_THREADS 4
#define STUMBLES 20

/* Bit patterns that arithmetic does not give: a NaN with a payload of ours; an odd integer. */
static const uint64_t mark = 0x7ff4a0d1700dbeefull;
static const int32_t mark32 = 0x5ead0bad;

bool sweep_is_mark(const struct column *c, const char *data, size_t element)
{
    return c->size == 8 ? memcmp(data + 8 * element, &mark, 8) == 0
                        : memcmp(data + 4 * element, &mark32, 4) == 0;
}

/* -- Images -------- */

static size_t bytes_of(const struct column *c)
{
    return (size_t)c->ncomp * c->plane * c->size;
}

static bool is_written(const struct bench *b, uint32_t k)
{
    return bench_prop(b, k)->access & BENCH_WRITES;
}

int image_take(struct image *out, const struct bench *b, struct error *e)
{
    out->data = calloc(bench_count(b) + 1u, sizeof(*out->data));
    for (uint32_t k = 0; out->data && k < bench_count(b); k++) {
        const struct column *c = bench_column(b, k);
        if (!is_written(b, k))
            continue;
        out->data[k] = malloc(bytes_of(c) + 1);
        if (!out->data[k])
            return error_memory(e, "a copy", bytes_of(c));
        memcpy(out->data[k], c->data, bytes_of(c));
    }
    return out->data ? 0 : error_memory(e, "a copy", bench_count(b));
}

void image_free(struct image *s, const struct bench *b)
{
    for (uint32_t k = 0; s->data && k < bench_count(b); k++)
        free(s->data[k]);
    free(s->data);
    s->data = NULL;
}

void image_put(const struct image *s, struct bench *b)
{
    for (uint32_t k = 0; k < bench_count(b); k++)
        if (s->data[k])
            memcpy(bench_column(b, k)->data, s->data[k], bytes_of(bench_column(b, k)));
}

/* -- What a pass finds -------- */

static void set_real(struct column *c, double value, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; k < c->ncomp; k++)
        for (uint64_t i = first; i < first + count; i++)
            ((double *)c->data)[k * c->plane + i] = value;
}

static void set_mark(struct column *c, size_t n)
{
    for (uint32_t k = 0; k < c->ncomp; k++)
        for (size_t i = k * c->plane; i < k * c->plane + n; i++)
            if (c->size == 8)
                memcpy((char *)c->data + 8 * i, &mark, 8);
            else
                memcpy((char *)c->data + 4 * i, &mark32, 4);
}

static void reset_sums(struct bench *b, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; k < bench_count(b); k++) {
        const sph_prop *p = bench_prop(b, k);
        struct column *c = bench_column(b, k);
        if (p->access & (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN) && c->type < SPH_INT32)
            set_real(c, p->start, first, count);
    }
}

int sweep_begin(struct sweep *s, struct bench *b, struct error *e)
{
    *s = (struct sweep){0};
    for (uint32_t k = 0; k < bench_count(b); k++) {
        const uint32_t access = bench_prop(b, k)->access;
        if (access & SPH_DST_WRITE && !(access & SPH_DST_READ))
            set_mark(bench_column(b, k), b->own.n);
    }
    reset_sums(b, 0, b->own.n);
    if (bench_refresh(b, e))
        return -1;
    return image_take(&s->given, b, e);
}

void sweep_end(struct sweep *s, const struct bench *b)
{
    image_free(&s->given, b);
}

/* -- Ranges -------- */

struct ranges {
    uint64_t *first, *count;
    size_t n;
};

static int ranges_make(struct ranges *r, const struct bench *b, const struct style *style,
                       struct error *e)
{
    const uint64_t n = b->own.n, chunk = style->chunk ? style->chunk : n;
    const size_t most = chunk ? (size_t)(n / chunk) + 1 : 1;
    struct random random;

    r->n = 0;
    r->first = calloc(most + 1, sizeof(uint64_t));
    r->count = calloc(most + 1, sizeof(uint64_t));
    if (!r->first || !r->count)
        return error_memory(e, "ranges", most * sizeof(uint64_t));
    if (style->part || n == 0) {
        r->first[0] = style->first;
        r->count[0] = style->count;
        r->n = 1;
        return 0;
    }
    for (uint64_t first = 0; first < n; first += chunk, r->n++) {
        r->first[r->n] = first;
        r->count[r->n] = n - first < chunk ? n - first : chunk;
    }
    random_init(&random, 3);
    for (size_t i = r->n; style->shuffled && i > 1; i--) {
        const size_t j = (size_t)(random_bits(&random) % i);
        const uint64_t first = r->first[j], count = r->count[j];
        r->first[j] = r->first[i - 1];
        r->count[j] = r->count[i - 1];
        r->first[i - 1] = first;
        r->count[i - 1] = count;
    }
    return 0;
}

/* Drops the ranges without a destination that asks for more. Joins none: a range stays a range. */
static void ranges_unfinished(struct ranges *r, const int32_t *unfinished)
{
    size_t kept = 0;

    for (size_t i = 0; i < r->n; i++) {
        bool any = false;
        for (uint64_t k = r->first[i]; k < r->first[i] + r->count[i]; k++)
            any = any || unfinished[k] != 0;
        if (!any)
            continue;
        r->first[kept] = r->first[i];
        r->count[kept++] = r->count[i];
    }
    r->n = kept;
}

/* -- Calls -------- */

struct call {
    const struct ranges *ranges;
    const sph_batch *batch;
    sph_range_fn f;
    pthread_barrier_t *start;
    int thread, threads;
    sph_status status;
    bool mode_changed;
};

static void call_ranges(struct call *c)
{
    for (size_t k = (size_t)c->thread; k < c->ranges->n; k += (size_t)c->threads) {
        const uint64_t mode = fpmode_get();
        sph_batch batch = *c->batch;
        sph_status status;

        batch.first = c->ranges->first[k];
        batch.count = c->ranges->count[k];
        status = c->f(&batch);
        if (status < c->status)
            c->status = status;
        if (fpmode_get() != mode) {
            fpmode_set(mode);
            c->mode_changed = true;
        }
    }
}

/* While threads run, one after the other is put to sleep where it stands, in the midst of a call,
 * so that the others overtake it, however few processors there are. So often a run; for the
 * handler, so a global. */
static volatile sig_atomic_t stumbles;

static void tick(long microseconds)
{
    const struct itimerval once = {{0, 0}, {0, microseconds}};

    setitimer(ITIMER_REAL, &once, NULL);
}

static void stumble(int number)
{
    const struct timespec moment = {0, 10000};

    (void)number;
    nanosleep(&moment, NULL);
    if (stumbles > 0) {
        stumbles = stumbles - 1;
        tick(100); /* from now: there is always time to go on */
    }
}

/* The caller itself does not stumble. */
static void stumbling(bool on)
{
    struct sigaction action = {.sa_handler = stumble, .sa_flags = SA_RESTART};
    sigset_t alarm;

    sigemptyset(&action.sa_mask);
    sigemptyset(&alarm);
    sigaddset(&alarm, SIGALRM);
    pthread_sigmask(SIG_BLOCK, &alarm, NULL);
    if (on)
        sigaction(SIGALRM, &action, NULL);
    tick(on && stumbles > 0 ? 20 : 0);
}

static void *call_thread(void *context)
{
    struct call *c = context;
    sigset_t alarm;

    sigemptyset(&alarm);
    sigaddset(&alarm, SIGALRM);
    pthread_sigmask(SIG_UNBLOCK, &alarm, NULL);
    pthread_barrier_wait(c->start);
    call_ranges(c);
    return NULL;
}

/* All calls of one function over the ranges; on threads they begin together. */
static int call_all(struct sweep *s, const struct bench *b, const char *name, sph_range_fn f,
                    const sph_batch *batch, const struct ranges *ranges, int threads,
                    struct error *e)
{
    struct call call[MOST_THREADS];
    pthread_t thread[MOST_THREADS];
    pthread_barrier_t start;
    int made = 0;

    if (!f)
        return 0;
    for (int t = 0; t < threads; t++)
        call[t] = (struct call){ranges, batch, f, &start, t, threads, SPH_OK, false};
    if (threads < 2) {
        call_ranges(&call[0]);
    } else {
        pthread_barrier_init(&start, NULL, (unsigned)threads + 1);
        while (made < threads && !pthread_create(&thread[made], NULL, call_thread, &call[made]))
            made++;
        if (made < threads) /* those that wait are lost with the process */
            return error_set(e, EXIT_RUN, "no threads are to be had");
        stumbling(true);
        pthread_barrier_wait(&start);
        for (int t = 0; t < threads; t++)
            pthread_join(thread[t], NULL);
        stumbling(false);
        pthread_barrier_destroy(&start);
    }
    for (int t = 0; t < threads; t++) {
        if (call[t].mode_changed)
            s->mode_after = name;
        if (call[t].status < s->status) {
            s->status = call[t].status;
            registry_reason(b->subject->registry, s->status, s->reason, sizeof(s->reason));
        }
    }
    return 0;
}

static int one_sweep(struct sweep *s, struct bench *b, const struct ranges *ranges, int threads,
                     const char *where, struct error *e)
{
    const struct pass_spec *spec = b->spec;
    const sph_batch batch = bench_batch(b);
    sph_batch alone = batch;

    alone.dst = b->alone;
    stage(b->subject, "before in %s", where);
    if (call_all(s, b, "before", spec->before, &alone, ranges, threads, e))
        return -1;
    stage(b->subject, "%s in %s", spec->label, where);
    if (spec->shape == SPH_POINT &&
        call_all(s, b, spec->label, spec->run, &batch, ranges, threads, e))
        return -1;
    for (int k = 0; spec->shape == SPH_PAIR && k < 2; k++) {
        sph_batch with = batch;
        if (k == 1 && !b->shape.second)
            continue;
        bench_sources(b, &with, k);
        if (call_all(s, b, spec->label, spec->run, &with, ranges, threads, e))
            return -1;
    }
    stage(b->subject, "after in %s", where);
    return call_all(s, b, "after", spec->after, &alone, ranges, threads, e);
}

/* Sweeps until no destination asks for more. */
static int all_sweeps(struct sweep *s, struct bench *b, struct ranges *ranges, int threads,
                      const char *where, struct error *e)
{
    const int32_t *busy = NULL;

    for (uint32_t k = 0; b->spec->unfinished && k < bench_count(b); k++)
        if (strcmp(bench_prop(b, k)->name, b->spec->unfinished) == 0)
            busy = bench_column(b, k)->data;
    s->sweeps = 0;
    s->unfinished = false;
    while (ranges->n > 0) {
        if (one_sweep(s, b, ranges, threads, where, e))
            return -1;
        s->sweeps++;
        if (!busy || s->status != SPH_OK)
            return 0;
        ranges_unfinished(ranges, busy);
        if (s->sweeps >= b->spec->max_sweeps) {
            s->unfinished = ranges->n > 0;
            return 0;
        }
        if (ranges->n > 0 && bench_refresh(b, e))
            return -1;
        for (size_t i = 0; i < ranges->n; i++)
            reset_sums(b, ranges->first[i], ranges->count[i]);
    }
    return 0;
}

int sweep_run(struct sweep *s, struct bench *b, const struct style *style, struct error *e)
{
    struct ranges ranges = {0};
    char words[128], where[240];
    int status;

    stumbles = STUMBLES;
    s->status = SPH_OK;
    s->mode_after = NULL;
    s->reason[0] = '\0';
    bench_words(b, words, sizeof(words));
    snprintf(where, sizeof(where), "%s, %s", words, style->words);
    bench_protect(b, false);
    image_put(&s->given, b);
    status = bench_refresh(b, e) ? -1 : ranges_make(&ranges, b, style, e);
    bench_protect(b, true);
    if (!status)
        status = all_sweeps(s, b, &ranges, style->threads, where, e);
    bench_protect(b, false);
    free(ranges.first);
    free(ranges.count);
    return status;
}
