/* check/check_paths.c -- the check `paths`: a pair function's `run` by all the ways that a batch can
 * ask for (sph_batch.path), and in floats if it takes them, against the plain loop in long doubles
 * on the same particles: every accumulator, in each dimension, with kernels that loops have
 * compiled in and others, with many smoothing lengths and one. */
#include "check/checks.h"
#include "check/floats.h"
#include "check/sweep.h"
#include "registry/kernel_form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the sum of the terms' absolute values. Doubles: some 300 terms, added in another order. Floats:
 * likewise, but terms that cancel within the body lose more. A wrong formula misses by far. */
#define BAR_F64 1e-13
#define BAR_F32 1e-5
/* A destination whose neighbours are all at the kernel's edge has small terms, of which a unit of
 * r / h is many: no less than this share of the largest destination's terms is the measure. */
#define SHARE 1e-3
#define PARTICLES 1000u
#define PIECE 56u

static const struct way {
    uint32_t path;
    const char *name;
} ways[] = {
    {SPH_PATH_BEST, "the best loop"},
    {SPH_PATH_REFERENCE, "the plain loop"},
    {SPH_PATH_BASE, "base"},
    {SPH_PATH_AVX2, "avx2"},
    {SPH_PATH_AVX512, "avx512"},
    {SPH_PATH_ANY_KERNEL + SPH_PATH_BEST, "the best loop for any kernel"},
    {SPH_PATH_ANY_KERNEL + SPH_PATH_BASE, "base for any kernel"},
    {SPH_PATH_ANY_KERNEL + SPH_PATH_AVX2, "avx2 for any kernel"},
};
#define N_WAYS (sizeof(ways) / sizeof(ways[0]))

/* What the loops meet. */
static const struct setup {
    const char *words;
    bool one_piece, one_h;
} setups[] = {
    {"a spline", false, false},
    {"a kernel of one piece", true, false},
    {"a kernel of one piece, one smoothing length", true, true},
};
#define N_SETUPS (sizeof(setups) / sizeof(setups[0]))

struct trial {
    const struct subject *subject;
    const sph_function *function;
    struct bench *bench;
    const struct setup *setup;
    sph_kernel_form kernel;
    uint32_t uniform_h;
    double quantum;
    struct floats floats;
    struct image start, terms, extended, got;
    double worst[2]; /* of doubles, of floats */
    const char *worst_name[2];
    bool apart; /* two ways have differed in some bit */
    bool failed;
};

/* -- Runs -------- */

static const char *precision(bool floats)
{
    return floats ? "floats" : "doubles";
}

static sph_batch batch_of(const struct trial *t, const struct way *way, int k)
{
    sph_batch batch = bench_batch(t->bench);

    bench_sources(t->bench, &batch, k);
    batch.kernel = &t->kernel;
    batch.path = way->path;
    batch.uniform_h = t->uniform_h;
    return batch;
}

/* From the start, the sources of both arrays; `out` may be what is there already. */
static int run(struct trial *t, const struct way *way, bool floats, uint64_t piece,
               struct image *out, struct error *e)
{
    struct bench *b = t->bench;
    sph_status status = SPH_OK;

    stage(t->subject, "run by %s in %s in %d dimensions", way->name, precision(floats),
          b->shape.dim);
    image_put(&t->start, b);
    if (floats && floats_make(&t->floats, b, t->quantum, e))
        return -1;
    for (int k = 0; k < 2; k++) {
        sph_batch batch = batch_of(t, way, k);
        if (floats)
            floats_batch(&t->floats, &batch, k);
        for (batch.first = 0; batch.first < b->own.n && status == SPH_OK; batch.first += piece) {
            batch.count = b->own.n - batch.first < piece ? b->own.n - batch.first : piece;
            status = t->function->run(&batch);
        }
    }
    if (floats) {
        floats_take(&t->floats, b);
        floats_free(&t->floats, b);
    }
    if (status != SPH_OK)
        return error_set(e, EXIT_RUN, "%s in %s fails with status %d", way->name, precision(floats),
                         (int)status);
    image_free(out, b);
    return image_take(out, b, e);
}

static double *plane(const struct trial *t, uint32_t property, uint32_t c)
{
    const struct column *column = bench_column(t->bench, property);

    return (double *)column->data + c * column->plane;
}

static bool is_accumulator(const struct trial *t, uint32_t k)
{
    const uint32_t sums = SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN;

    return bench_prop(t->bench, k)->access & sums && bench_column(t->bench, k)->type < SPH_INT32;
}

static double *at(const struct image *image, uint32_t property, size_t element)
{
    return (double *)(void *)image->data[property] + element;
}

/* The sums of a group, from now 0; what they were is added to those of absolute terms. */
static void take_term(struct trial *t, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; k < bench_count(t->bench); k++)
        for (uint32_t c = 0; is_accumulator(t, k) && c < bench_column(t->bench, k)->ncomp; c++)
            for (uint64_t i = first; i < first + count; i++) {
                *at(&t->terms, k, c * bench_column(t->bench, k)->plane + i) +=
                    fabs(plane(t, k, c)[i]);
                plane(t, k, c)[i] = 0;
            }
}

static void take_terms_of(struct trial *t, int k, uint64_t *begin)
{
    static const struct way best = {SPH_PATH_BEST, ""};
    static const uint16_t none = 0;
    const struct group_list *list = &t->bench->list[k];
    sph_batch batch = batch_of(t, &best, k);
    sph_span one = {0, 0, 1, 1};

    batch.begin = begin;
    batch.span = &one;
    batch.list = &none;
    for (size_t g = 0; g < list->n_group; g++) {
        batch.first = g * SPH_LANES;
        batch.count = t->bench->own.n - batch.first;
        batch.count = batch.count < SPH_LANES ? batch.count : SPH_LANES;
        begin[g] = 0;
        begin[g + 1] = 1;
        for (struct source_walk w = source_walk_begin(list, g); source_walk_next(list, &w);) {
            one.base = w.source;
            t->function->run(&batch);
            take_term(t, batch.first, batch.count);
        }
    }
}

/* The terms by themselves, a source at a time: a loop's sums over one source. */
static int take_terms(struct trial *t, struct error *e)
{
    const size_t n = t->bench->own.n / SPH_LANES + 2;
    uint64_t *begin = calloc(n, sizeof(*begin));

    if (!begin)
        return error_memory(e, "terms", n * sizeof(*begin));
    stage(t->subject, "run with one source in %d dimensions", t->bench->shape.dim);
    image_put(&t->start, t->bench);
    image_free(&t->terms, t->bench);
    if (image_take(&t->terms, t->bench, e)) {
        free(begin);
        return -1;
    }
    for (uint32_t k = 0; k < bench_count(t->bench); k++)
        for (size_t i = 0; is_accumulator(t, k) && i < t->bench->own.n; i++)
            for (uint32_t c = 0; c < bench_column(t->bench, k)->ncomp; c++)
                *at(&t->terms, k, c * bench_column(t->bench, k)->plane + i) = 0;
    take_term(t, 0, t->bench->own.n); /* the start */
    for (int k = 0; k < 2; k++)
        take_terms_of(t, k, begin);
    free(begin);
    return 0;
}

/* -- Comparison -------- */

/* What rounding is measured by. */
static double measure(const struct trial *t, uint32_t k, size_t element)
{
    return bench_prop(t->bench, k)->access & SPH_DST_SUM ? *at(&t->terms, k, element)
                                                         : fabs(*at(&t->extended, k, element));
}

static double distance(double a, double b, double scale, bool floats)
{
    if (a == b || (isnan(a) && isnan(b)) || (floats && a == (double)(float)b))
        return 0;
    return isfinite(a) && isfinite(b) ? fabs(a - b) / scale : INFINITY;
}

static void differ(struct trial *t, const struct way *way, bool floats, uint32_t k, size_t element,
                   double far)
{
    const struct column *c = bench_column(t->bench, k);
    char words[128];

    say(t->subject, VERDICT_FAIL,
        "in %s, with %s: \"%s\" of particle %zu is %.17g by %s in %s, by the plain loop in long "
        "doubles %.17g: %.3g of the sum of absolute terms apart (bar %.3g)",
        bench_words(t->bench, words, sizeof(words)), t->setup->words, c->name, element % c->plane,
        *at(&t->got, k, element), way->name, precision(floats), *at(&t->extended, k, element), far,
        floats ? BAR_F32 : BAR_F64);
    t->failed = true;
}

/* One accumulator; false if something has been said. */
static bool compare_property(struct trial *t, const struct way *way, bool floats, uint32_t k)
{
    const struct column *c = bench_column(t->bench, k);
    const size_t n = t->bench->own.n;
    double largest = 0;

    for (size_t i = 0; i < c->ncomp * n; i++) {
        const double scale = measure(t, k, i / n * c->plane + i % n);
        if (isfinite(scale))
            largest = fmax(largest, scale);
    }
    for (size_t i = 0; i < c->ncomp * n; i++) {
        const size_t element = i / n * c->plane + i % n;
        const double a = *at(&t->got, k, element), b = *at(&t->extended, k, element);
        const double far = distance(a, b, fmax(measure(t, k, element), SHARE * largest), floats);
        t->apart |= !floats && memcmp(&a, &b, sizeof(a)) != 0;
        if (!(far <= (floats ? BAR_F32 : BAR_F64))) {
            differ(t, way, floats, k, element, far);
            return false;
        }
        if (far >= t->worst[floats]) {
            t->worst[floats] = far;
            t->worst_name[floats] = c->name;
        }
    }
    return true;
}

static int try_way(struct trial *t, const struct way *way, bool floats, struct error *e)
{
    if (run(t, way, floats, PARTICLES, &t->got, e))
        return -1;
    for (uint32_t k = 0; k < bench_count(t->bench); k++)
        if (is_accumulator(t, k) && !compare_property(t, way, floats, k))
            return 0;
    return 0;
}

/* In floats, in pieces: the same bits. (For doubles the check `calls` looks at that.) */
static int try_pieces(struct trial *t, struct error *e)
{
    struct image pieces = {0};
    int status =
        run(t, &ways[0], true, PARTICLES, &t->got, e) || run(t, &ways[0], true, PIECE, &pieces, e)
            ? -1
            : 0;

    for (uint32_t k = 0; !status && k < bench_count(t->bench); k++) {
        const struct column *c = bench_column(t->bench, k);
        for (size_t i = 0; is_accumulator(t, k) && !t->failed && i < t->bench->own.n; i++) {
            if (memcmp(at(&t->got, k, i), at(&pieces, k, i), sizeof(double)) == 0)
                continue;
            say(t->subject, VERDICT_FAIL,
                "in floats and pieces of %u, \"%s\" of particle %zu is %.9g, but was %.9g in one "
                "piece",
                PIECE, c->name, i, *at(&pieces, k, i), *at(&t->got, k, i));
            t->failed = true;
        }
    }
    image_free(&pieces, t->bench);
    return status;
}

/* -- Setups -------- */

static int make_kernel(struct trial *t, struct error *e)
{
    static const sph_kernel_term terms[] = {{5. / 16, 2, 4, 0}, {-2. / 16, 2, 5, 0}};
    static const sph_item item = {
        .size = (uint32_t)sizeof(item), .dims = SPH_ALL_DIMS, .name = "one-piece"};
    const int dim = t->bench->shape.dim;
    sph_kernel kernel = {.size = (uint32_t)sizeof(kernel), .item = &item, .support = 2};

    t->kernel = t->bench->kernel;
    if (!t->setup->one_piece)
        return 0;
    kernel.norm[dim] = t->bench->kernel.norm;
    kernel.terms[dim] = (sph_list)SPH_LIST(terms);
    return kernel_form_make(&t->kernel, &kernel, dim, e);
}

static double *smoothing(const struct particles *p, const struct bench *b)
{
    return p->column[b->h].data;
}

static void set_h(struct bench *b, double h)
{
    for (size_t i = 0; i < b->own.n + b->own.n_ghost; i++)
        smoothing(&b->own, b)[i] = h;
    for (size_t i = 0; i < b->other.n; i++)
        smoothing(&b->other, b)[i] = h;
}

static bool has_one_h(const struct bench *b)
{
    const double h = smoothing(&b->own, b)[0];
    bool one = true;

    for (size_t i = 0; i < b->own.n + b->own.n_ghost; i++)
        one = one && smoothing(&b->own, b)[i] == h;
    for (size_t i = 0; i < b->other.n; i++)
        one = one && smoothing(&b->other, b)[i] == h;
    return one;
}

/* What the sweep finds: sums at their start, then the function's own `before`. */
static int make_start(struct trial *t, struct error *e)
{
    struct sweep sweep;
    sph_batch batch;

    if (t->setup->one_h)
        set_h(t->bench, smoothing(&t->bench->own, t->bench)[0]);
    if (sweep_begin(&sweep, t->bench, e))
        return -1;
    sweep_end(&sweep, t->bench);
    batch = bench_batch(t->bench);
    batch.kernel = &t->kernel;
    batch.count = t->bench->own.n;
    if (t->function->before && t->function->before(&batch) != SPH_OK)
        return error_set(e, EXIT_RUN, "before fails");
    t->quantum = floats_round(t->bench);
    t->uniform_h = has_one_h(t->bench);
    image_free(&t->start, t->bench);
    return bench_lists(t->bench, e) || image_take(&t->start, t->bench, e) ? -1 : 0;
}

static int try_setup(struct trial *t, struct error *e)
{
    static const struct way extended = {SPH_PATH_EXTENDED, "the plain loop in long doubles"};
    const bool floats = t->function->reals & SPH_F32 && !t->function->over;

    if (make_kernel(t, e) || make_start(t, e) || take_terms(t, e) ||
        run(t, &extended, false, PARTICLES, &t->extended, e))
        return -1;
    for (int real = 0; real < 1 + floats; real++)
        for (size_t w = 0; w < N_WAYS && !t->failed; w++)
            if (try_way(t, &ways[w], real, e))
                return -1;
    return floats && !t->failed ? try_pieces(t, e) : 0;
}

static int try_dim(struct trial *t, int dim, struct error *e)
{
    const struct bench_shape shape = {dim, LAYOUT_REGULAR, PARTICLES, true, 0};
    struct pass_spec *spec = calloc(2, sizeof(*spec)); /* a bench points to it until the end */
    int status = 0;

    t->bench = calloc(1, sizeof(*t->bench));
    if (!spec || !t->bench)
        return error_memory(e, "a bench", sizeof(*t->bench));
    passes_of(t->subject->entry, spec);
    if (bench_make(t->bench, t->subject, spec, &shape, e))
        return -1;
    for (size_t k = 0; k < N_SETUPS && !status && !t->failed; k++) {
        t->setup = &setups[k];
        status = try_setup(t, e);
        if (t->setup->one_piece)
            kernel_form_fini(&t->kernel);
    }
    image_free(&t->start, t->bench);
    image_free(&t->terms, t->bench);
    image_free(&t->extended, t->bench);
    image_free(&t->got, t->bench);
    bench_close(t->bench);
    return status;
}

void check_paths(const struct subject *s)
{
    struct trial t = {.subject = s, .function = entry_function(s->entry)};
    struct error e = {0};
    char dims[64];

    if (t.function->shape != SPH_PAIR)
        return;
    for (int dim = 1; dim <= 3 && !t.failed; dim++)
        if (subject_works_in(s, dim) && try_dim(&t, dim, &e)) {
            say(s, VERDICT_FAIL, "%s", e.text);
            return;
        }
    if (t.failed)
        return;
    subject_dims(s, dims, sizeof(dims));
    if (t.apart)
        say(s, VERDICT_OK,
            "the plain loop and all vectors give the same in %s: apart by at most %.1e of the sum "
            "of absolute terms (%s; bar %.1e)",
            dims, t.worst[0], t.worst_name[0], BAR_F64);
    else
        say(s, VERDICT_NOTE, "has one way to run");
    if (t.function->reals & SPH_F32 && !t.function->over)
        say(s, VERDICT_OK,
            "floats give what doubles do in %s: apart by at most %.1e of the sum of absolute terms "
            "(%s; bar %.1e)",
            dims, t.worst[1], t.worst_name[1] ? t.worst_name[1] : "no accumulator", BAR_F32);
    else
        say(s, VERDICT_NOTE, "takes no floats");
}
