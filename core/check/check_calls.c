/* check/check_calls.c -- the check `calls`: every pass of an item over particles of all numbers and
 * dimensions. What it touches is watched by the memory's protection (watch.c); here its results are
 * compared: whole, again, in other pieces, on threads, in one piece alone. */
#include "check/checks.h"
#include "check/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define THREAD_ROUNDS 20

static const struct style whole = {"in one piece", 0, false, 1, false, 0, 0};
static const struct style again = {"called again", 0, false, 1, false, 0, 0};
static const struct style small = {"in pieces of 8", 8, false, 1, false, 0, 0};
static const struct style mixed = {"in pieces of 56, in another order", 56, true, 1, false, 0, 0};
static const struct style threads = {"on 4 threads", 64, false, 4, false, 0, 0};

static const struct bench_shape shapes[] = {
    {0, LAYOUT_REGULAR, 1000, true, 0}, {0, LAYOUT_CLUSTER, 0, false, 0},
    {0, LAYOUT_CLUSTER, 1, false, 0},   {0, LAYOUT_CLUSTER, 7, true, 0},
    {0, LAYOUT_CLUSTER, 8, true, 0},    {0, LAYOUT_CLUSTER, 9, true, 0},
    {0, LAYOUT_ALONE, 9, true, 0},
};

/* One comparison: the bench and its results. `failed`: something has been said. */
struct trial {
    const struct subject *subject;
    struct bench *bench;
    struct sweep *sweep;
    char words[128]; /* "run, 2 dimensions, 1000 particles" */
    bool failed;
    bool *odd; /* a note has been made on particles that stand alone */
};

static double real_at(const char *data, size_t element)
{
    double value;

    memcpy(&value, data + 8 * element, sizeof(value));
    return value;
}

static bool same(const struct column *c, const char *a, const char *b, size_t element)
{
    if (memcmp(a + c->size * element, b + c->size * element, c->size) == 0)
        return true;
    return c->type < SPH_INT32 && isnan(real_at(a, element)) && isnan(real_at(b, element));
}

/* "3.5", or an integer. */
static const char *shown(char *out, size_t size, const struct column *c, const char *data,
                         size_t element)
{
    int32_t small_integer;
    int64_t integer;

    if (c->type == SPH_INT32) {
        memcpy(&small_integer, data + 4 * element, 4);
        snprintf(out, size, "%d", (int)small_integer);
    } else if (c->type == SPH_INT64) {
        memcpy(&integer, data + 8 * element, 8);
        snprintf(out, size, "%lld", (long long)integer);
    } else {
        snprintf(out, size, "%.17g", real_at(data, element));
    }
    return out;
}

/* The values that a destination's call reads, for a sentence: "rho = 1, v = 2 3". */
static const char *inputs(const struct trial *t, size_t i, char *out, size_t size)
{
    const struct bench *b = t->bench;
    const struct image *given = &t->sweep->given; /* of what it has changed since */
    size_t n = 0;

    out[0] = '\0';
    for (uint32_t k = 0; k < bench_count(b) && n < size; k++) {
        const struct column *c = bench_column(b, k);
        const char *found = given->data[k] ? given->data[k] : c->data;
        if (!(bench_prop(b, k)->access & SPH_DST_READ) || c->type >= SPH_INT32)
            continue;
        n += (size_t)snprintf(out + n, size - n, "%s%s =", n ? ", " : "", c->name);
        for (uint32_t q = 0; q < c->ncomp && n < size; q++)
            n += (size_t)snprintf(out + n, size - n, " %g", real_at(found, q * c->plane + i));
    }
    return out;
}

/* The sign of a NaN means nothing. */
static double unsigned_nan(double value)
{
    return isnan(value) ? NAN : value;
}

/* -- Results -------- */

/* Did the calls go well? A failure where particles stand alone is only told of: a host may meet it.
 */
static bool went_well(struct trial *t, const struct style *style)
{
    const struct sweep *w = t->sweep;

    if (w->mode_after) {
        say(t->subject, VERDICT_FAIL, "%s, %s: %s changes the floating point mode", t->words,
            style->words, w->mode_after);
        t->failed = true;
    }
    if (w->status == SPH_OK)
        return !t->failed;
    if (t->bench->shape.layout == LAYOUT_REGULAR && t->subject->entry->kind != KIND_EOS) {
        say(t->subject, VERDICT_FAIL, "%s, %s: fails with status %d: %s", t->words, style->words,
            (int)w->status, w->reason);
        t->failed = true;
    } else if (!*t->odd) {
        say(t->subject, VERDICT_NOTE, "%s: fails: %s", t->words, w->reason);
        *t->odd = true;
    }
    return false;
}

/* The first element of what is written that differs within [from, to); says so. */
static bool differs(struct trial *t, const struct image *reference, uint64_t from, uint64_t to,
                    const char *how)
{
    for (uint32_t k = 0; k < bench_count(t->bench); k++) {
        const struct column *c = bench_column(t->bench, k);
        for (uint32_t q = 0; reference->data[k] && q < c->ncomp; q++)
            for (uint64_t i = from; i < to; i++) {
                const size_t at = q * c->plane + i;
                char a[40], b[40];
                if (same(c, reference->data[k], c->data, at))
                    continue;
                say(t->subject, VERDICT_FAIL,
                    "%s: %s, \"%s\" of particle %llu is %s, but was %s in one piece", t->words, how,
                    c->name, (unsigned long long)i, shown(b, sizeof(b), c, c->data, at),
                    shown(a, sizeof(a), c, reference->data[k], at));
                t->failed = true;
                return true;
            }
    }
    return false;
}

/* Nothing but [from, to) has changed since the calls began. What lies behind the last particle is
 * lost (batch.h), as far as a group and its vectors go: so much is forgiven. */
static void check_outside(struct trial *t, uint64_t from, uint64_t to, const char *how)
{
    const struct image *given = &t->sweep->given;
    const struct particles *p = &t->bench->own;

    for (uint32_t k = 0; k < bench_count(t->bench); k++) {
        const struct column *c = bench_column(t->bench, k);
        for (uint32_t q = 0; given->data[k] && q < c->ncomp; q++)
            for (uint64_t i = 0; i < c->plane; i++) {
                const size_t at = q * c->plane + i;
                const bool ours = i >= p->n && i < p->n + p->n_ghost && t->bench->spec->max_sweeps;
                if ((i >= from && i < to) || ours ||
                    memcmp(given->data[k] + c->size * at, (char *)c->data + c->size * at,
                           c->size) == 0)
                    continue;
                if (i >= p->n && i < p->n + 2 * SPH_LANES && p->n_ghost == 0)
                    continue;
                say(t->subject, VERDICT_FAIL,
                    "%s: %s, writes \"%s\" of particle %llu, outside its destinations %llu to %llu "
                    "of %zu",
                    t->words, how, c->name, (unsigned long long)i, (unsigned long long)from,
                    (unsigned long long)(to ? to - 1 : 0), p->n);
                t->failed = true;
                return;
            }
    }
}

static bool fine(const struct trial *t, uint32_t k, double value)
{
    const bool extreme = bench_prop(t->bench, k)->access & (SPH_DST_MAX | SPH_DST_MIN);

    return extreme ? !isnan(value) : isfinite(value);
}

/* Everything is set, and is a number. */
static void check_values(struct trial *t, bool lenient)
{
    const struct bench *b = t->bench;
    char read[400];

    for (uint32_t k = 0; k < bench_count(b) && !t->failed; k++) {
        const struct column *c = bench_column(b, k);
        const uint32_t access = bench_prop(b, k)->access;
        for (size_t e = 0; access & BENCH_WRITES && e < c->ncomp * b->own.n; e++) {
            const size_t i = e % b->own.n, at = e / b->own.n * c->plane + i;
            const bool set = !(access & SPH_DST_WRITE) || access & SPH_DST_READ ||
                             !sweep_is_mark(c, c->data, at);
            if (set && (c->type >= SPH_INT32 || fine(t, k, real_at(c->data, at))))
                continue;
            inputs(t, i, read, sizeof(read));
            if (!set || !lenient) {
                say(t->subject, VERDICT_FAIL,
                    set ? "%s: \"%s\" of particle %zu is %g%s%s"
                        : "%s: \"%s\", which is declared as written, is not set at particle %zu",
                    t->words, c->name, i, set ? unsigned_nan(real_at(c->data, at)) : 0,
                    read[0] ? ", at " : "", read);
                t->failed = true;
            } else if (!*t->odd) {
                say(t->subject, VERDICT_NOTE, "%s: \"%s\" is %g%s%s", t->words, c->name,
                    unsigned_nan(real_at(c->data, at)), read[0] ? ", at " : "", read);
                *t->odd = true;
            }
            break;
        }
    }
}

/* -- One bench -------- */

static int compare(struct trial *t, const struct image *reference, const struct style *style,
                   struct error *e)
{
    if (sweep_run(t->sweep, t->bench, style, e))
        return -1;
    if (went_well(t, style))
        differs(t, reference, 0, t->bench->own.n, style->words);
    return 0;
}

/* One piece in the midst of others, and the last, short one. */
static int compare_part(struct trial *t, const struct image *reference, struct error *e)
{
    const uint64_t n = t->bench->own.n, last = n / SPH_LANES * SPH_LANES;
    const uint64_t first[] = {n > 64 ? 496 : 0, last < n ? last : 0};

    for (int i = 0; i < 2 && n > SPH_LANES && !t->failed; i++) {
        const uint64_t count = n - first[i] < 2 * SPH_LANES ? n - first[i] : SPH_LANES;
        char words[64];
        const struct style part = {words, 0, false, 1, true, first[i], count};
        snprintf(words, sizeof(words), "destinations %llu to %llu alone",
                 (unsigned long long)first[i], (unsigned long long)(first[i] + count - 1));
        if (sweep_run(t->sweep, t->bench, &part, e))
            return -1;
        if (!went_well(t, &part))
            return 0;
        check_outside(t, first[i], first[i] + count, words);
        /* The others keep their h, so that what iterates may come to another end. */
        if (!t->failed && !t->bench->spec->max_sweeps)
            differs(t, reference, first[i], first[i] + count, words);
    }
    return 0;
}

static int compare_all(struct trial *t, struct error *e)
{
    static const struct style *const styles[] = {&small, &mixed};
    struct image reference = {0};
    int status = 0;
    const bool lenient =
        t->bench->shape.layout != LAYOUT_REGULAR || t->subject->entry->kind == KIND_EOS;

    if (sweep_run(t->sweep, t->bench, &whole, e))
        return -1;
    if (!went_well(t, &whole))
        return 0;
    check_outside(t, 0, t->bench->own.n, whole.words);
    check_values(t, lenient);
    if (t->sweep->unfinished && !lenient)
        say(t->subject, VERDICT_NOTE, "%s: \"%s\" still asks for more after max_sweeps (%u)",
            t->words, t->bench->spec->unfinished, t->bench->spec->max_sweeps);
    status = image_take(&reference, t->bench, e);
    if (!status)
        status = compare(t, &reference, &again, e);
    if (!status && !t->failed)
        status = compare_part(t, &reference, e);
    for (size_t i = 0; !status && !t->failed && i < sizeof(styles) / sizeof(styles[0]); i++)
        status = compare(t, &reference, styles[i], e);
    for (int i = 0; !status && !t->failed && t->bench->own.n > 64 && i < THREAD_ROUNDS; i++)
        status = compare(t, &reference, &threads, e);
    image_free(&reference, t->bench);
    return status;
}

/* The bench stays until the process ends: its columns are watched. */
static bool try_shape(const struct subject *s, const struct pass_spec *spec,
                      const struct bench_shape *shape, bool *odd)
{
    struct bench *b = calloc(1, sizeof(*b));
    struct sweep sweep = {0};
    struct trial t = {.subject = s, .bench = b, .sweep = &sweep, .odd = odd};
    struct error e = {0};
    char words[100];
    int status = b ? bench_make(b, s, spec, shape, &e) : error_memory(&e, "a bench", sizeof(*b));

    if (!status) {
        snprintf(t.words, sizeof(t.words), "%s, %s", spec->label,
                 bench_words(b, words, sizeof(words)));
        status = sweep_begin(&sweep, b, &e);
        if (!status)
            status = compare_all(&t, &e);
        sweep_end(&sweep, b);
        bench_close(b);
    }
    if (status) {
        say(s, VERDICT_FAIL, "%s, %d dimensions, %zu particles: %s", spec->label, shape->dim,
            shape->n, e.text);
        return false;
    }
    return !t.failed;
}

void check_calls(const struct subject *s)
{
    struct pass_spec spec[2];
    const size_t n = passes_of(s->entry, spec);
    char dims[40];
    struct use use;
    struct error e = {0};
    bool odd = false;

    if (subject_configure(s, &use, &e)) { /* `life` has said why */
        return;
    }
    use_fini(&use, s->registry);
    for (size_t i = 0; i < n; i++)
        for (int dim = 1; dim <= 3; dim++)
            for (size_t k = 0; subject_works_in(s, dim) && k < sizeof(shapes) / sizeof(shapes[0]);
                 k++) {
                struct bench_shape shape = shapes[k];
                shape.dim = dim;
                if (!try_shape(s, &spec[i], &shape, &odd))
                    return;
            }
    say(s, VERDICT_OK,
        "touches only what it declares; the same bits in pieces, again and on 4 threads, with 0 to "
        "1000 particles in %s",
        subject_dims(s, dims, sizeof(dims)));
}
