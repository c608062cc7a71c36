/* check/bench.c -- makes and closes benches (see bench.h). Calls the plugin's create, prepare and
 * destroy. */
#include "check/bench.h"

#include "registry/extension.h"
#include "registry/kernel_form.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define SKIN 0.02

/* A bell of two clamped cubes, for the pairs; its integral is 1. */
static int make_kernel(sph_kernel_form *out, int dim, struct error *e)
{
    static const sph_kernel_term terms[] = {{1, 2, 3, 0}, {-4, 1, 3, 0}};
    static const sph_item item = {
        .size = (uint32_t)sizeof(item), .dims = SPH_ALL_DIMS, .name = "bell"};
    const double pi = acos(-1);
    const sph_list list = SPH_LIST(terms);
    const sph_kernel kernel = {.size = (uint32_t)sizeof(kernel),
                               .item = &item,
                               .support = 2,
                               .norm = {0, 1. / 6, 5 / (14 * pi), 1 / (4 * pi)},
                               .terms = {SPH_NO_LIST, list, list, list}};

    return kernel_form_make(out, &kernel, dim, e);
}

/* -- Columns -------- */

static int add(struct particles *p, const sph_prop *prop, struct error *e)
{
    return particles_add(p, prop->name, prop->unit, prop->doc, prop->type, e);
}

/* x and h first, of both arrays alike: a batch of pairs has them whether they are declared or not.
 */
static int add_geometry(struct bench *b, struct error *e)
{
    struct particles *const both[] = {&b->own, &b->other};

    b->x = b->h = -1;
    for (int k = 0; k < 2; k++) {
        b->x = particles_add(both[k], "x", "m", "", SPH_VECTOR, e);
        if (b->x < 0)
            return -1;
        if (b->spec->shape == SPH_PAIR)
            b->h = particles_add(both[k], "h", "m", "", SPH_SCALAR, e);
        if (b->spec->shape == SPH_PAIR && b->h < 0)
            return -1;
    }
    return 0;
}

static int add_property(struct bench *b, uint32_t k, struct error *e)
{
    const sph_prop *prop = bench_prop(b, k);
    const bool source_only = !(prop->access & (BENCH_WRITES | SPH_DST_READ));

    b->own_column[k] = add(&b->own, prop, e);
    if (b->own_column[k] < 0)
        return -1;
    b->other_column[k] = prop->access & SPH_SRC_READ ? add(&b->other, prop, e) : -1;
    b->shut_column[k] = source_only ? add(&b->shut, prop, e) : -1;
    return (prop->access & SPH_SRC_READ && b->other_column[k] < 0) ||
                   (source_only && b->shut_column[k] < 0)
               ? -1
               : 0;
}

static int add_columns(struct bench *b, struct error *e)
{
    const size_t n = bench_count(b) + 1u, most = bench_count(b) + 2u;

    b->own_column = calloc(n, sizeof(int));
    b->other_column = calloc(n, sizeof(int));
    b->shut_column = calloc(n, sizeof(int));
    b->own_access = calloc(most, sizeof(int));
    b->other_access = calloc(most, sizeof(int));
    b->shut_access = calloc(most, sizeof(int));
    if (!b->own_column || !b->other_column || !b->shut_column || !b->own_access ||
        !b->other_access || !b->shut_access)
        return error_memory(e, "columns", n * sizeof(int));
    if (add_geometry(b, e))
        return -1;
    for (uint32_t k = 0; k < bench_count(b); k++)
        if (add_property(b, k, e))
            return -1;
    return 0;
}

static void declare_access(struct bench *b)
{
    if (b->spec->shape == SPH_PAIR)
        b->own_access[b->x] = b->own_access[b->h] = b->other_access[b->x] = b->other_access[b->h] =
            1;
    for (uint32_t k = 0; k < bench_count(b); k++) {
        b->own_access[b->own_column[k]] = bench_prop(b, k)->access & BENCH_WRITES ? 2 : 1;
        if (b->other_column[k] >= 0)
            b->other_access[b->other_column[k]] = 1;
    }
    b->watched[0] = (struct watched){&b->own, b->own_access, NULL};
    b->watched[1] = (struct watched){&b->other, b->other_access, NULL};
    b->watched[2] = (struct watched){&b->shut, b->shut_access,
                                     "which it declares for the sources only, at a destination"};
    for (int k = 0; k < 3; k++)
        watch_particles(&b->watched[k]);
}

/* What nobody may use holds no number: a NaN with a payload of ours. */
static void poison(const struct particles *p)
{
    const double nothing = nan("0xbad");

    for (size_t c = 0; c < p->n_column; c++) {
        const struct column *column = &p->column[c];
        const size_t used = p->n + p->n_ghost;
        for (uint32_t k = 0; column->size == 8 && k < column->ncomp; k++)
            for (size_t i = used; i < column->plane; i++)
                memcpy((char *)column->data + 8 * (k * column->plane + i), &nothing, 8);
    }
}

/* -- Lists -------- */

static struct cloud cloud_of(const struct bench *b, const struct particles *p, bool ghosts)
{
    struct cloud cloud = {.dim = b->shape.dim,
                          .n = p->n + (ghosts ? p->n_ghost : 0),
                          .h = p->column[b->h].data,
                          .scale = b->support};

    for (int c = 0; c < b->shape.dim; c++)
        cloud.x[c] = (double *)p->column[b->x].data + (size_t)c * p->column[b->x].plane;
    return cloud;
}

/* A copy that is watched, in place of an earlier one. NULL: no memory. */
static void *watched_copy(void *earlier, const void *data, size_t bytes, const char *what)
{
    void *copy = watch_memory(bytes, what);

    watch_release(earlier);
    if (copy && bytes)
        memcpy(copy, data, bytes);
    watch_seal(copy);
    return copy;
}

static int make_list(struct bench *b, int k, struct error *e)
{
    const struct cloud dst = cloud_of(b, &b->own, false);
    const struct cloud src = cloud_of(b, k ? &b->other : &b->own, true);
    struct group_list *list = &b->list[k];

    if (group_list_make(list, &dst, &src, b->spec->reach == SPH_SYMMETRIC, SKIN, NULL, 1, e))
        return -1;
    b->begin[k] = watched_copy(b->begin[k], list->begin, (list->n_group + 1) * sizeof(*list->begin),
                               "batch->begin");
    b->span[k] =
        watched_copy(b->span[k], list->span, list->n_span * sizeof(*list->span), "batch->span");
    b->step[k] = watched_copy(b->step[k], list->step, (size_t)list->n_entry * sizeof(*list->step),
                              "batch->list");
    if (!b->begin[k] || !b->span[k] || !b->step[k])
        return error_memory(e, "a neighbour list", (size_t)list->n_entry * sizeof(*list->step));
    return 0;
}

int bench_lists(struct bench *b, struct error *e)
{
    if (b->spec->shape != SPH_PAIR)
        return 0;
    return make_list(b, 0, e) || make_list(b, 1, e) ? -1 : 0;
}

int bench_refresh(struct bench *b, struct error *e)
{
    for (size_t c = 0; c < b->own.n_column; c++)
        if (b->own_access[c] == 2 && b->own.n_ghost)
            ghosts_refresh(&b->ghosts, &b->box, &b->own, (int)c);
    return b->h >= 0 && b->own_access[b->h] == 2 ? bench_lists(b, e) : 0;
}

/* -- The whole -------- */

static int make_particles(struct bench *b, struct error *e)
{
    const size_t n = b->shape.n;

    b->own.guarded = b->other.guarded = b->shut.guarded = true;
    if (add_columns(b, e) || particles_resize(&b->own, n, 0, e) ||
        particles_resize(&b->other, b->shape.second ? n / 2 : 0, 0, e) ||
        particles_resize(&b->shut, n, 0, e))
        return -1;
    declare_access(b);
    bench_place(b);
    bench_values(b);
    if (b->box.bounded && b->spec->shape == SPH_PAIR) {
        double length = INFINITY;
        for (int c = 0; c < b->shape.dim; c++)
            length = fmin(length, b->box.max[c] - b->box.min[c]);
        /* Twice the reach, so that h may grow. */
        if (ghosts_make(&b->ghosts, &b->box, &b->own, fmin(length, 2.8 * b->spacing * b->support),
                        e))
            return -1;
        for (size_t c = 0; c < b->own.n_column; c++)
            ghosts_refresh(&b->ghosts, &b->box, &b->own, (int)c);
    }
    poison(&b->own);
    poison(&b->other);
    return bench_lists(b, e);
}

static int make_views(struct bench *b, struct error *e)
{
    const uint32_t n = bench_count(b), params = b->subject->entry->item->params.count;

    b->dst = watch_memory(n * sizeof(sph_column), "batch->dst");
    b->src[0] = watch_memory(n * sizeof(sph_column), "batch->src");
    b->src[1] = watch_memory(n * sizeof(sph_column), "batch->src");
    b->alone = watch_memory(n * sizeof(sph_column), "batch->dst");
    b->param = watch_memory(params * sizeof(double), "batch->param");
    if (!b->dst || !b->src[0] || !b->src[1] || !b->alone || !b->param)
        return error_memory(e, "a batch", n * sizeof(sph_column));
    for (uint32_t k = 0; k < n; k++) {
        b->dst[k] = b->shut_column[k] >= 0 ? particles_column(&b->shut, b->shut_column[k])
                                           : particles_column(&b->own, b->own_column[k]);
        b->alone[k] =
            bench_prop(b, k)->access & SPH_DST_SWEEP ? (sph_column){.data = NULL} : b->dst[k];
        if (!(bench_prop(b, k)->access & SPH_SRC_READ))
            continue;
        b->src[0][k] = particles_column(&b->own, b->own_column[k]);
        b->src[1][k] = particles_column(&b->other, b->other_column[k]);
    }
    memcpy(b->param, b->use.config.value, params * sizeof(double));
    watch_seal(b->dst);
    watch_seal(b->alone);
    watch_seal(b->src[0]);
    watch_seal(b->src[1]);
    watch_seal(b->param);
    return 0;
}

static int call_prepare(struct bench *b, struct error *e)
{
    sph_column *none;
    sph_batch batch;
    sph_status status;
    char why[512];

    if (!b->spec->prepare)
        return 0;
    none = watch_memory(bench_count(b) * sizeof(sph_column), "batch->dst");
    batch = bench_batch(b);
    batch.dst = none;
    batch.n_dst = 0;
    batch.x_dst = batch.h_dst = (sph_column){0};
    stage(b->subject, "prepare");
    status = b->spec->prepare(&batch);
    if (status == SPH_OK)
        return 0;
    registry_reason(b->subject->registry, status, why, sizeof(why));
    return error_set(e, EXIT_RUN, "prepare fails: %s", why);
}

/* Properties of an equation of state that fit each other: what run reads, by the inverse from what
 * it writes (a stiff material may have no state at all at values near 1). */
static void settle(struct bench *b)
{
    const sph_eos *eos = entry_eos(b->subject->entry);
    const uint32_t n = eos->inverse_props.count;
    sph_column *column = watch_memory(n * sizeof(*column), "batch->dst");
    sph_batch batch = bench_batch(b);
    uint32_t found = 0;

    for (uint32_t k = 0; column && k < n; k++) {
        const sph_prop *p = list_at(&eos->inverse_props, k);
        const int c = particles_find(&b->own, p->name);
        const bool chosen = p->access & SPH_DST_WRITE && subject_setting(b->subject, p->name);
        if (c < 0 || b->own.column[c].type != p->type || chosen)
            break;
        column[found++] = particles_column(&b->own, c);
    }
    if (found < n)
        return;
    batch.dst = column;
    batch.n_columns = n;
    batch.count = b->own.n;
    stage(b->subject, "inverse, for a state to begin with");
    eos->inverse(&batch); /* where it fails the values stay as they are, or show what is wrong */
}

int bench_make(struct bench *b, const struct subject *s, const struct pass_spec *spec,
               const struct bench_shape *shape, struct error *e)
{
    *b = (struct bench){.subject = s, .spec = spec, .shape = *shape};
    if (make_kernel(&b->kernel, shape->dim, e))
        return -1;
    b->support = b->kernel.support * (spec->reach_scale > 0 ? spec->reach_scale : 1);
    if (particles_init(&b->own, "destinations", shape->dim, e) ||
        particles_init(&b->other, "sources", shape->dim, e) ||
        particles_init(&b->shut, "shut", shape->dim, e) || make_particles(b, e) ||
        subject_configure(s, &b->use, e))
        return -1;
    stage(s, "create");
    if (use_create(&b->use, s->registry, shape->dim, e) || make_views(b, e))
        return -1;
    if (s->entry->kind == KIND_EOS && spec->run != entry_eos(s->entry)->inverse &&
        entry_eos(s->entry)->inverse)
        settle(b);
    return call_prepare(b, e);
}

void bench_close(struct bench *b)
{
    stage(b->subject, "destroy");
    use_fini(&b->use, b->subject->registry);
    for (int k = 0; k < 3; k++)
        b->watched[k].closed = "a column of an earlier batch: it has kept the pointer";
    for (size_t c = 0; c < b->own.n_column; c++)
        particles_guard(&b->own, (int)c, 0);
    for (size_t c = 0; c < b->other.n_column; c++)
        particles_guard(&b->other, (int)c, 0);
    for (int k = 0; k < 2; k++)
        group_list_fini(&b->list[k]);
}

void bench_protect(struct bench *b, bool on)
{
    for (size_t c = 0; c < b->own.n_column; c++)
        particles_guard(&b->own, (int)c, on ? b->own_access[c] : 2);
    for (size_t c = 0; c < b->other.n_column; c++)
        particles_guard(&b->other, (int)c, on ? b->other_access[c] : 2);
    for (size_t c = 0; c < b->shut.n_column; c++)
        particles_guard(&b->shut, (int)c, 0);
}

/* -- Batches -------- */

/* Any reduction has come to 1; a proposal of a time step is taken and forgotten. */
static double reduction(const struct sph_run *run, const char *function, const char *name)
{
    (void)run;
    (void)function;
    (void)name;
    return 1;
}

static void propose(const struct sph_run *run, double dt)
{
    (void)run;
    (void)dt;
}

static const struct sph_run some_run = {NULL, reduction, propose};

sph_batch bench_batch(const struct bench *b)
{
    const bool in_run = b->subject->entry->kind == KIND_FUNCTION;
    /* A scene without pairs may have none. */
    const bool kernel = b->spec->shape == SPH_PAIR || (in_run && b->shape.layout == LAYOUT_REGULAR);
    sph_batch out = {.size = (uint32_t)sizeof(out),
                     .dim = (uint32_t)b->shape.dim,
                     .real = SPH_F64,
                     .lanes = SPH_LANES,
                     .n_dst = b->own.n,
                     .dst = b->dst,
                     .n_columns = bench_count(b),
                     .n_params = b->subject->entry->item->params.count,
                     .param = b->param,
                     .state = b->use.state,
                     .kernel = kernel ? &b->kernel : NULL,
                     .time = 0.25,
                     .dt = in_run ? 1e-3 : 0,
                     .step = in_run ? 10 : 0,
                     .host = &b->subject->registry->host,
                     .run = in_run ? &some_run : NULL};

    if (b->spec->shape == SPH_PAIR) {
        out.x_dst = particles_column(&b->own, b->x);
        out.h_dst = particles_column(&b->own, b->h);
    }
    return out;
}

void bench_sources(const struct bench *b, sph_batch *batch, int k)
{
    const struct particles *p = k ? &b->other : &b->own;

    batch->src = b->src[k];
    batch->n_src = p->n + p->n_ghost;
    batch->same = k == 0;
    batch->begin = b->begin[k];
    batch->span = b->span[k];
    batch->list = b->step[k];
    batch->x_src = particles_column(p, b->x);
    batch->h_src = particles_column(p, b->h);
}

const char *bench_words(const struct bench *b, char *out, size_t size)
{
    snprintf(out, size, "%d dimension%s, %zu particle%s%s", b->shape.dim,
             b->shape.dim == 1 ? "" : "s", b->shape.n, b->shape.n == 1 ? "" : "s",
             b->shape.layout == LAYOUT_ALONE && b->shape.n ? " without neighbours" : "");
    return out;
}
