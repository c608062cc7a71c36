/* check/check_points.c -- the check `device` of what destinations do alone: the native function against
 * its body for a device, on the same particles, in each dimension. */
#include "base/quiet.h"
#include "check/checks.h"
#include "check/sweep.h"
#include "opencl/pair_body.h"
#include "opencl/point_body.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The measure is how far the native result moves when the last digit of all that it reads does, and its
 * own last digit: rounding may differ by as much at each operation inside. A wrong formula misses by
 * 1e10 and more. */
#define BAR 64.0
#define TRIALS 8
#define PARTICLES 1000u

/* What is compared: a function's part. */
struct part {
    const char *name; /* "after" */
    sph_range_fn native;
    const sph_device_point *point;
    bool alone; /* before, after: columns as these are given them */
};

struct trial {
    const struct subject *subject;
    const struct part *part;
    struct bench *bench;
    struct device *device;
    size_t n_in, n_out;            /* numbers that it reads, and sets */
    double *start, *kept;          /* [n_in + n_out]: all of them, as they were; [n_in]: scratch */
    double *native, *moved, *slip; /* [n_out]; slip: how far they move */
    double worst;
    const char *worst_name;
};

/* -- Values -------- */

static double *real_at(const struct column *c, size_t k, size_t n)
{
    return (double *)c->data + k / n * c->plane + k % n;
}

/* The numbers of a list's columns, one after the other; `back`: put there. Returns how many. */
static size_t carry(const struct bench *b, const sph_list *list, double *flat, bool back)
{
    const size_t n = b->own.n;
    size_t total = 0;

    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        const struct column *c = bench_column(b, v->index);
        for (size_t k = 0; flat && k < c->ncomp * n; k++) {
            double *at = &flat[total + k];
            if (v->type != SPH_INT32 && back)
                *real_at(c, k, n) = *at;
            else if (v->type != SPH_INT32)
                *at = *real_at(c, k, n);
            else if (back)
                ((int32_t *)c->data)[k] = (int32_t)*at;
            else
                *at = ((const int32_t *)c->data)[k];
        }
        total += c->ncomp * n;
    }
    return total;
}

/* All that it reads: in, inout, h. */
static size_t carry_in(const struct trial *t, double *flat, bool back)
{
    const sph_device_point *d = t->part->point;
    const struct bench *b = t->bench;
    size_t n = carry(b, &d->in, flat, back);

    n += carry(b, &d->inout, flat ? flat + n : NULL, back);
    for (size_t k = 0; d->h && k < b->own.n; k++, n++) {
        double *h = (double *)b->own.column[b->h].data + k;
        if (flat && back)
            *h = flat[n];
        else if (flat)
            flat[n] = *h;
    }
    return n;
}

static size_t carry_out(const struct trial *t, double *flat, bool back)
{
    const sph_device_point *d = t->part->point;
    const size_t n = carry(t->bench, &d->inout, flat, back);

    return n + carry(t->bench, &d->out, flat ? flat + n : NULL, back);
}

static void restore(const struct trial *t)
{
    carry_out(t, t->start + t->n_in, true);
    carry_in(t, t->start, true);
}

/* -- Runs -------- */

static sph_batch batch_of(const struct trial *t)
{
    sph_batch batch = bench_batch(t->bench);

    batch.count = t->bench->own.n;
    if (t->part->alone)
        batch.dst = t->bench->alone;
    return batch;
}

static int run_natively(const struct trial *t, double *out, struct error *e)
{
    const sph_batch batch = batch_of(t);
    const sph_status status = t->part->native(&batch);

    if (status != SPH_OK)
        return error_set(e, EXIT_RUN, "%s fails with status %d", t->part->name, (int)status);
    carry_out(t, out, false);
    return 0;
}

/* Every number's last digit up or down, but for whole ones, such as 0. */
static void move_all(const struct trial *t, uint64_t *seed)
{
    memcpy(t->kept, t->start, t->n_in * sizeof(double));
    for (size_t k = 0; k < t->n_in; k++) {
        *seed = *seed * 6364136223846793005u + 1442695040888963407u;
        if (t->kept[k] < floor(t->kept[k]) || t->kept[k] > floor(t->kept[k]))
            t->kept[k] *= *seed >> 63 ? 1 + DBL_EPSILON : 1 - DBL_EPSILON;
    }
    carry_in(t, t->kept, true);
}

static int run_native_trials(struct trial *t, struct error *e)
{
    uint64_t seed = 1;

    restore(t);
    if (run_natively(t, t->native, e))
        return -1;
    for (size_t k = 0; k < t->n_out; k++)
        t->slip[k] = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        restore(t);
        move_all(t, &seed);
        if (run_natively(t, t->moved, e))
            return -1;
        for (size_t k = 0; k < t->n_out; k++)
            t->slip[k] = fmax(t->slip[k], fabs(t->moved[k] - t->native[k]));
    }
    return 0;
}

static int run_on_device(struct trial *t, uint32_t *failed, struct error *e)
{
    const sph_batch batch = batch_of(t);
    struct point_body *body;
    int kept[2], status;

    restore(t);
    quiet_begin(kept); /* what a driver prints is not the plugin's doing */
    status = point_body_build(&body, t->device, t->part->point, t->bench->shape.dim, e);
    if (!status) {
        status = point_body_run(body, &batch, failed, e);
        point_body_free(body);
    }
    quiet_end(kept);
    if (!status)
        carry_out(t, t->moved, false);
    return status;
}

/* -- Comparison -------- */

static void differ(const struct trial *t, const char *name, size_t i, size_t k, double measure)
{
    char words[128];

    say(t->subject, VERDICT_FAIL,
        "the device body \"%s\" of %s and the native one differ in %s: %s of particle %zu is %.17g "
        "on \"%s\", natively %.17g: %.3g apart, where the last digit of what it reads moves it by "
        "%.3g (bar %g times)",
        t->part->point->file, t->part->name, bench_words(t->bench, words, sizeof(words)), name, i,
        t->moved[k], device_facts(t->device)->name, t->native[k], fabs(t->moved[k] - t->native[k]),
        measure, BAR);
}

/* Of one list; false if something has been said. */
static bool compare(struct trial *t, const sph_list *list, size_t *at)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        const size_t n = t->bench->own.n, end = *at + bench_column(t->bench, v->index)->ncomp * n;
        const char *name = bench_prop(t->bench, v->index)->name;
        for (const size_t first = *at; *at < end; ++*at) {
            const double a = t->moved[*at], b = t->native[*at];
            const double measure = t->slip[*at] + DBL_EPSILON * fabs(b) + DBL_MIN;
            const bool same = a == b || (isnan(a) && isnan(b));
            const double far = same ? 0 : fabs(a - b) / measure;
            if (!(far <= BAR)) {
                differ(t, name, (*at - first) % n, *at, measure);
                return false;
            }
            if (far >= t->worst) {
                t->worst = far;
                t->worst_name = name;
            }
        }
    }
    return true;
}

static int make_room(struct trial *t, struct error *e)
{
    t->n_in = carry_in(t, NULL, false);
    t->n_out = carry_out(t, NULL, false);
    /* The child's end frees it. */
    t->start = calloc(2 * t->n_in + 4 * t->n_out + 1, sizeof(double));
    if (!t->start)
        return error_memory(e, "a copy of columns", (t->n_in + t->n_out) * sizeof(double));
    t->kept = t->start + t->n_in + t->n_out;
    t->native = t->kept + t->n_in;
    t->moved = t->native + t->n_out;
    t->slip = t->moved + t->n_out;
    carry_in(t, t->start, false);
    carry_out(t, t->start + t->n_in, false);
    return 0;
}

/* 1: compared, and equal; 0: something has been said; -1: neither. */
static int compare_part(struct trial *t, struct error *e)
{
    const sph_device_point *d = t->part->point;
    uint32_t failed = 0;
    size_t at = 0;

    if (make_room(t, e) || run_native_trials(t, e) || run_on_device(t, &failed, e))
        return -1;
    if (failed) {
        say(t->subject, VERDICT_FAIL,
            "the device body \"%s\" of %s fails where the native one does not: %s", d->file,
            t->part->name,
            failed <= d->fail.count ? *(const char *const *)list_at(&d->fail, failed - 1) : "?");
        return 0;
    }
    const int same = compare(t, &d->inout, &at) && compare(t, &d->out, &at);
    /* What follows finds what the native one has made. */
    restore(t);
    carry_out(t, t->native, true);
    return same;
}

static int sweep_natively(struct bench *b, const sph_function *f, struct error *e)
{
    for (int k = 0; k < 2; k++) {
        sph_batch batch = bench_batch(b);
        bench_sources(b, &batch, k);
        batch.count = b->own.n;
        if (f->run(&batch) != SPH_OK)
            return error_set(e, EXIT_RUN, "run fails");
    }
    return 0;
}

/* The parts of an item in the order in which they are called; one without a body is called natively. */
static int compare_parts(struct trial *t, const struct part *part, size_t n, struct error *e)
{
    for (size_t k = 0; k < n; k++) {
        int status = 1;
        t->part = &part[k];
        if (strcmp(part[k].name, "after") == 0 &&
            sweep_natively(t->bench, entry_function(t->subject->entry), e))
            return -1;
        if (part[k].point) {
            status = compare_part(t, e);
        } else if (part[k].native) {
            const sph_batch batch = batch_of(t);
            if (part[k].native(&batch) != SPH_OK)
                return error_set(e, EXIT_RUN, "%s fails", part[k].name);
        }
        if (status < 1)
            return status;
    }
    return 1;
}

static int compare_dim(struct trial *t, const struct part *part, size_t n, int dim, struct error *e)
{
    const struct bench_shape shape = {dim, LAYOUT_REGULAR, PARTICLES, true, 0};
    struct pass_spec *spec = calloc(2, sizeof(*spec)); /* a bench points to it until the end */
    struct sweep sweep;
    int status;

    stage(t->subject, "the bodies of points in %d dimensions", dim);
    t->bench = calloc(1, sizeof(*t->bench));
    if (!spec || !t->bench)
        return error_memory(e, "a bench", sizeof(*t->bench));
    passes_of(t->subject->entry, spec);
    if (bench_make(t->bench, t->subject, spec, &shape, e) || sweep_begin(&sweep, t->bench, e))
        return -1;
    sweep_end(&sweep, t->bench);
    status = compare_parts(t, part, n, e);
    bench_close(t->bench);
    return status;
}

/* -- Items -------- */

/* What of the item there is; how many. */
static size_t parts_of(const struct entry *x, struct part out[2])
{
    if (x->kind == KIND_EOS) {
        out[0] = (struct part){"run", entry_eos(x)->run, entry_eos(x)->device, false};
        return 1;
    }
    const sph_function *f = entry_function(x);
    if (f->shape == SPH_POINT) {
        out[0] = (struct part){"run", f->run, f->device_run, false};
        return 1;
    }
    out[0] = (struct part){"before", f->before, f->device_before, true};
    out[1] = (struct part){"after", f->after, f->device_after, true};
    return 2;
}

/* files: "the device body "a.body.h" of after". */
static void compare_dims(struct trial *t, const struct part *part, size_t n, const char *files)
{
    struct error e = {0};
    char dims[64];

    for (int dim = 1; dim <= 3; dim++) {
        const int status = subject_works_in(t->subject, dim) ? compare_dim(t, part, n, dim, &e) : 1;
        if (status < 0 && e.exit_code == EXIT_REFUSED)
            say(t->subject, VERDICT_FAIL, "%s", e.text);
        else if (status < 0)
            say(t->subject, VERDICT_NOTE, "%s is not compared with the native one: %s", files,
                e.text);
        if (status < 1)
            return;
    }
    say(t->subject, VERDICT_OK,
        "%s gives the native numbers in %s on \"%s\": apart by at most %.2g of what the last digit "
        "of all that it reads does (%s; bar %g)",
        files, subject_dims(t->subject, dims, sizeof(dims)), device_facts(t->device)->name,
        t->worst, t->worst_name ? t->worst_name : "nothing is set", BAR);
}

void check_points(const struct subject *s)
{
    struct trial t = {.subject = s};
    struct part part[2] = {0};
    const size_t n = parts_of(s->entry, part);
    char files[256] = "";
    struct error e = {0};
    size_t device, length = 0;
    int kept[2], status;

    for (size_t k = 0; k < n; k++) {
        if (part[k].native && !part[k].point)
            say(s, VERDICT_NOTE, "no device body of %s", part[k].name);
        else if (part[k].point && length < sizeof(files))
            length += (size_t)snprintf(files + length, sizeof(files) - length,
                                       "%sthe device body \"%s\" of %s", length ? ", " : "",
                                       part[k].point->file, part[k].name);
    }
    if (length == 0)
        return;
    quiet_begin(kept);
    status = pair_body_device(&device, &e) || device_open(&t.device, device, &e);
    quiet_end(kept);
    if (status) {
        say(s, VERDICT_NOTE, "%s is not compared with the native one: %s", files, e.text);
        return;
    }
    compare_dims(&t, part, n, files);
    device_close(t.device);
}
