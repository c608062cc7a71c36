/* check/check_device.c -- the check `device`: the native body of a pair function against the one
 * for a device, where both exist, on the same particles: every accumulator, in each dimension,
 * with a kernel as powers and as a table. */
#include "base/quiet.h"
#include "check/checks.h"
#include "check/sweep.h"
#include "opencl/pair_body.h"
#include "registry/kernel_form.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* In units of DBL_EPSILON times the sum of the terms' absolute values. Both sides add the same
 * terms in the same order, at most some 300 for a destination here; each addition rounds by half
 * a unit of the sum so far, and each term differs by some units where one side fuses a
 * multiplication with an addition. A wrong formula misses by 1e13. */
#define BAR 512.0
/* A destination whose neighbours are all at the kernel's edge has small terms, of which a unit of
 * r / h is many: no less than this share of the largest destination's terms is the measure. */
#define SHARE 1e-3
#define PARTICLES 1000u
#define CUT 504u /* the device gets its destinations in two ranges */

static const char *const form_name[] = {"powers", "a table"};

struct trial {
    const struct subject *subject;
    const sph_function *function;
    struct bench *bench;
    struct pair_body *body;
    sph_kernel_form form[2];
    struct image start, native, device, terms;
    double worst; /* [BAR's units] */
    const char *worst_name;
    char device_name[128];
};

/* The bench's own bell as a function: (2 - q)^3 - 4 (1 - q)^3, each clamped at 0. */
static double bell(double q, uint32_t dim)
{
    const double a = fmax(0, 2 - q), b = fmax(0, 1 - q);

    (void)dim;
    return a * a * a - 4 * b * b * b;
}

static double bell_slope(double q, uint32_t dim)
{
    const double a = fmax(0, 2 - q), b = fmax(0, 1 - q);

    (void)dim;
    return -3 * a * a + 12 * b * b;
}

static int make_forms(struct trial *t, struct error *e)
{
    static const sph_item item = {
        .size = (uint32_t)sizeof(item), .dims = SPH_ALL_DIMS, .name = "bell"};
    const sph_kernel_form *given = &t->bench->kernel;
    sph_kernel kernel = {.size = (uint32_t)sizeof(kernel),
                         .item = &item,
                         .support = given->support,
                         .value = bell,
                         .slope = bell_slope};

    kernel.norm[given->dim] = given->norm;
    t->form[0] = *given;
    return kernel_form_make(&t->form[1], &kernel, (int)given->dim, e);
}

/* -- Runs -------- */

/* In two ranges. */
static int run_on_device(const struct trial *t, sph_batch *batch, bool absolute, struct error *e)
{
    int kept[2], status;

    quiet_begin(kept); /* what a driver prints is not the plugin's doing */
    batch->count = CUT;
    status = pair_body_run(t->body, batch, absolute, e);
    batch->first = CUT;
    batch->count = t->bench->own.n - CUT;
    status = status || pair_body_run(t->body, batch, absolute, e) ? -1 : 0;
    quiet_end(kept);
    return status;
}

static int build(struct trial *t, size_t device, struct error *e)
{
    int kept[2], status;

    quiet_begin(kept);
    status = pair_body_build(&t->body, device, t->function, t->bench->shape.dim, true, e);
    quiet_end(kept);
    return status;
}

enum how { NATIVE, DEVICE, TERMS };

/* From the start, the sources of both arrays. */
static int sweep_both(struct trial *t, const sph_kernel_form *form, enum how how, struct image *out,
                      struct error *e)
{
    image_put(&t->start, t->bench);
    for (int k = 0; k < 2; k++) {
        sph_batch batch = bench_batch(t->bench);
        bench_sources(t->bench, &batch, k);
        batch.kernel = form;
        batch.count = t->bench->own.n;
        if (how == NATIVE) {
            const sph_status status = t->function->run(&batch);
            if (status != SPH_OK)
                return error_set(e, EXIT_RUN, "run fails with status %d", (int)status);
            continue;
        }
        if (run_on_device(t, &batch, how == TERMS, e))
            return -1;
    }
    image_free(out, t->bench);
    return image_take(out, t->bench, e);
}

/* -- Comparison -------- */

static double at(const struct image *image, uint32_t property, size_t element)
{
    return ((const double *)(const void *)image->data[property])[element];
}

/* What rounding is measured by: the sum of absolute terms, the start among them, or an extreme. */
static double measure(const struct trial *t, uint32_t property, size_t element, bool extreme)
{
    const double start = at(&t->start, property, element);

    return extreme ? fabs(at(&t->native, property, element))
                   : fabs(start) + at(&t->terms, property, element) - start;
}

/* Their distance in BAR's units. */
static double distance(double a, double b, double scale)
{
    if (a == b || (isnan(a) && isnan(b)))
        return 0;
    return isfinite(a) && isfinite(b) ? fabs(a - b) / (DBL_EPSILON * scale) : INFINITY;
}

static void differ(const struct trial *t, const sph_prop *prop, int form, size_t i, size_t element,
                   uint32_t property, double far)
{
    char words[128];

    say(t->subject, VERDICT_FAIL,
        "the device body \"%s\" and the native one differ in %s, with a kernel of %s: %s of "
        "particle %zu is %.17g on \"%s\", natively %.17g: %.3g of the sum of absolute terms apart "
        "(bar %.3g)",
        t->function->device->file, bench_words(t->bench, words, sizeof(words)), form_name[form],
        prop->name, i, at(&t->device, property, element), t->device_name,
        at(&t->native, property, element), DBL_EPSILON * far, DBL_EPSILON * BAR);
}

/* One accumulator; false if something has been said. */
static bool compare_value(struct trial *t, const sph_device_value *v, bool extreme, int form)
{
    const struct column *c = bench_column(t->bench, v->index);
    const sph_prop *prop = bench_prop(t->bench, v->index);
    const size_t n = t->bench->own.n;
    double largest = 0;

    for (size_t k = 0; k < c->ncomp * n; k++) {
        const double scale = measure(t, v->index, k / n * c->plane + k % n, extreme);
        if (isfinite(scale))
            largest = fmax(largest, scale);
    }
    for (size_t k = 0; k < c->ncomp * n; k++) {
        const size_t element = k / n * c->plane + k % n;
        const double scale = measure(t, v->index, element, extreme);
        const double far =
            distance(at(&t->device, v->index, element), at(&t->native, v->index, element),
                     fmax(scale, SHARE * largest));
        if (!(far <= BAR)) {
            differ(t, prop, form, k % n, element, v->index, far);
            return false;
        }
        if (far >= t->worst) {
            t->worst = far;
            t->worst_name = prop->name;
        }
    }
    return true;
}

static bool compare_all(struct trial *t, int form)
{
    const sph_device_body *d = t->function->device;
    const sph_list *const lists[] = {&d->sum, &d->min, &d->max};

    for (int l = 0; l < 3; l++)
        for (uint32_t k = 0; k < lists[l]->count; k++)
            if (!compare_value(t, list_at(lists[l], k), l > 0, form))
                return false;
    return true;
}

/* -- Dimensions -------- */

/* 1: compared, and equal; 0: something has been said; -1: neither. */
static int compare_forms(struct trial *t, struct error *e)
{
    for (int form = 0; form < 2; form++) {
        if (sweep_both(t, &t->form[form], NATIVE, &t->native, e) ||
            sweep_both(t, &t->form[form], DEVICE, &t->device, e) ||
            sweep_both(t, &t->form[form], TERMS, &t->terms, e))
            return -1;
        if (!compare_all(t, form))
            return 0;
    }
    return 1;
}

/* What the sweep finds: sums at their start, then the function's own `before`. */
static int make_start(struct trial *t, struct error *e)
{
    struct sweep sweep;
    sph_batch batch;

    if (sweep_begin(&sweep, t->bench, e))
        return -1;
    sweep_end(&sweep, t->bench);
    batch = bench_batch(t->bench);
    batch.count = t->bench->own.n;
    if (t->function->before && t->function->before(&batch) != SPH_OK)
        return error_set(e, EXIT_RUN, "before fails");
    return image_take(&t->start, t->bench, e);
}

static int compare_dim(struct trial *t, size_t device, int dim, struct error *e)
{
    const struct bench_shape shape = {dim, LAYOUT_REGULAR, PARTICLES, true, 0};
    struct pass_spec *spec = calloc(2, sizeof(*spec)); /* a bench points to it until the end */
    int status;

    stage(t->subject, "the device body in %d dimensions", dim);
    t->bench = calloc(1, sizeof(*t->bench));
    if (!spec || !t->bench)
        return error_memory(e, "a bench", sizeof(*t->bench));
    passes_of(t->subject->entry, spec);
    if (bench_make(t->bench, t->subject, spec, &shape, e) || make_forms(t, e) || make_start(t, e) ||
        build(t, device, e))
        return -1;
    snprintf(t->device_name, sizeof(t->device_name), "%s", pair_body_device_name(t->body));
    status = compare_forms(t, e);
    pair_body_free(t->body);
    kernel_form_fini(&t->form[1]);
    image_free(&t->start, t->bench);
    image_free(&t->native, t->bench);
    image_free(&t->device, t->bench);
    image_free(&t->terms, t->bench);
    bench_close(t->bench);
    return status;
}

static void check_pairs(const struct subject *s)
{
    struct trial t = {.subject = s, .function = entry_function(s->entry)};
    struct error e = {0};
    char dims[64];
    size_t device;

    if (!t.function->device) {
        say(s, VERDICT_NOTE, "no device body");
        return;
    }
    if (pair_body_device(&device, &e)) {
        say(s, VERDICT_NOTE, "the device body \"%s\" is not compared with the native one: %s",
            t.function->device->file, e.text);
        return;
    }
    for (int dim = 1; dim <= 3; dim++) {
        const int status = subject_works_in(s, dim) ? compare_dim(&t, device, dim, &e) : 1;
        if (status < 0 && e.exit_code == EXIT_REFUSED)
            say(s, VERDICT_FAIL, "%s", e.text);
        else if (status < 0)
            say(s, VERDICT_NOTE, "the device body \"%s\" is not compared with the native one: %s",
                t.function->device->file, e.text);
        if (status < 1)
            return;
    }
    say(s, VERDICT_OK,
        "the device body \"%s\" gives the native numbers in %s on \"%s\", with a kernel of powers "
        "and of a table: apart by at most %.1e of the sum of absolute terms (%s; bar %.1e)",
        t.function->device->file, subject_dims(s, dims, sizeof(dims)), t.device_name,
        DBL_EPSILON * t.worst, t.worst_name ? t.worst_name : "no accumulator", DBL_EPSILON * BAR);
}

void check_device(const struct subject *s)
{
    if (s->entry->kind == KIND_FUNCTION && entry_function(s->entry)->shape == SPH_PAIR)
        check_pairs(s);
    check_points(s);
}
