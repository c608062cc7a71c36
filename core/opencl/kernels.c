/* opencl/kernels.c -- stages as kernels: built for a device, handed their arguments, launched (see kernels.h). What
 * they are made of is written by kernels_text.c. */
#include "config.h"

#include "opencl/kernels_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Arguments in front of those of arrays and sources. */
#define SCALARS 9u

struct kernels {
    struct device *d;
    const struct plan *plan;
    struct stage_shape *shape;
    size_t n;
    bool vectors;
    char *text;
    /* [0] for any smoothing lengths, [1] where all are the same; built when asked for. */
    struct device_program *program[2];
    struct device_kernel **kernel[2]; /* [n * PART_COUNT] */
    struct pass_numbers *numbers;     /* [plan->n_pass] */
    double *value, *given;            /* what they are, and as the device has them */
    size_t n_value;
    struct device_buffer on_device, table, failure;
    struct kernel_now last;
    struct device_arg *arg;
};

/* -- Build -------- */

/* Passes' names, joined: what times are told under. */
char *stage_label(const struct plan *plan, const struct stage *s)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);

    if (!out)
        return NULL;
    for (size_t i = 0; i < s->n; i++)
        fprintf(out, "%s%s", i ? "+" : "", plan->pass[s->pass[i]].name);
    fclose(out);
    return text;
}

static int find_kernels(struct kernels *k, int uniform, struct error *e)
{
    char name[64];

    for (size_t i = 0; i < k->n; i++) {
        char *label = stage_label(k->plan, k->shape[i].stage);
        int status = label ? 0 : error_memory(e, "a stage", 64);
        for (int part = 0; !status && part < PART_COUNT; part++) {
            if (k->shape[i].phased != (part != PART_ALL))
                continue;
            stage_kernel_name(name, sizeof(name), &k->shape[i], (enum kernel_part)part);
            status = device_kernel(k->d, k->program[uniform], name, label,
                                   &k->kernel[uniform][i * PART_COUNT + (size_t)part], e);
        }
        free(label);
        if (status)
            return -1;
    }
    return 0;
}

static bool has_file(const char *file, const char *text, const char *prelude)
{
    return (text && strcmp(file, text) == 0) || (prelude && strcmp(file, prelude) == 0);
}

/* Whether a text of the pass is of that file. */
static bool is_from(const struct pass *p, const char *file)
{
    const sph_device_point *const point[3] = {pass_before(p), pass_after(p), pass_point(p)};
    const sph_device_body *const pair = p->function ? p->function->device : NULL;
    bool is = pair && has_file(file, pair->file, pair->prelude_file);

    for (int i = 0; i < 3; i++)
        is = is || (point[i] && has_file(file, point[i]->file, point[i]->prelude_file));
    return is;
}

/* Puts the plugin whose text does not compile in front of the sentence, where only one has such a file. */
static void blame(const struct kernels *k, struct error *e)
{
    const char *file = device_build_file(k->d);
    const struct pass *found = NULL;

    for (size_t i = 0; file && i < k->plan->n_pass; i++) {
        const struct pass *p = &k->plan->pass[i];
        if (!p->use.entry || p->use.entry->text || !is_from(p, file))
            continue;
        if (found && found->use.entry->plugin != p->use.entry->plugin)
            return;
        found = found ? found : p;
    }
    if (found)
        error_prefix(e, "\"%s\" of plugin \"%s\"", found->use.item->name,
                     k->plan->registry->plugin[found->use.entry->plugin].name);
}

static int build(struct kernels *k, int uniform, struct error *e)
{
    if (k->program[uniform])
        return 0;
    k->kernel[uniform] = calloc(k->n * PART_COUNT + 1, sizeof(struct device_kernel *));
    if (!k->kernel[uniform])
        return error_memory(e, "kernels", k->n * PART_COUNT);
    if (device_build(k->d, &k->program[uniform], k->text,
                     uniform ? "-cl-std=CL1.2 -w -DSPH_UNIFORM=1" : "-cl-std=CL1.2 -w",
                     "the scene's passes", e)) {
        blame(k, e);
        return -1;
    }
    return find_kernels(k, uniform, e);
}

/* Whether a run begins with one smoothing length, and keeps it. */
static bool begins_uniform(const struct plan *plan)
{
    double low = INFINITY, high = -INFINITY;

    for (size_t a = 0; a < plan->n_array; a++) {
        const struct column *h = &plan->array[a].p.column[plan->array[a].smoothing];
        if (plan_changes(plan, a, plan->array[a].smoothing))
            return false;
        for (size_t i = 0; i < plan->array[a].p.n; i++) {
            low = fmin(low, column_get(h, 0, i));
            high = fmax(high, column_get(h, 0, i));
        }
    }
    return !(low < high);
}

/* -- What stays as it is -------- */

static int check(const struct kernels *k, size_t i, struct error *e)
{
    const struct stage *s = k->shape[i].stage;
    char why[256];

    for (size_t q = 0; q < s->n; q++)
        if (!pass_on_device(k->plan, &k->plan->pass[s->pass[q]], why, sizeof(why)))
            return error_set(e, EXIT_REFUSED, "%s", why);
    return 0;
}

static int make_shapes(struct kernels *k, const struct stage *stage, size_t n, struct error *e)
{
    k->shape = calloc(n + 1, sizeof(*k->shape));
    if (!k->shape)
        return error_memory(e, "kernels", n * sizeof(*k->shape));
    for (size_t i = 0; i < n; i++) {
        k->n = i + 1;
        if (stage_shape_make(&k->shape[i], k->plan, &stage[i], i, e) || check(k, i, e))
            return -1;
    }
    return 0;
}

/* A kernel with nothing behind a pointer still gets a buffer. */
static int make_buffers(struct kernels *k, struct error *e)
{
    const sph_kernel_form *f = &k->plan->kernel;
    const size_t cells = k->plan->has_kernel && f->n_table ? 2 * ((size_t)f->n_table + 1) : 0;

    if (device_reserve(k->d, &k->on_device, (k->n_value + 1) * sizeof(double), "parameters", e) ||
        device_reserve(k->d, &k->table, (cells + 1) * sizeof(double), "the kernel's table", e) ||
        device_reserve(k->d, &k->failure, sizeof(int32_t), "a failure", e) ||
        device_fill(k->d, &k->failure, 0, 0u, sizeof(int32_t), e))
        return -1;
    return cells ? device_write(k->d, &k->table, 0, f->table, cells * sizeof(double), e) : 0;
}

static int make(struct kernels *k, const struct arena *arena, const struct stage *stage, size_t n,
                struct error *e)
{
    size_t most = 0;

    if (make_shapes(k, stage, n, e))
        return -1;
    for (size_t i = 0; i < n; i++) {
        const size_t args = SCALARS + 3 * (k->shape[i].n_array + k->shape[i].n_source);
        most = args > most ? args : most;
    }
    k->numbers = pass_numbers_make(k->plan, &k->n_value);
    k->value = calloc(k->n_value + 1, sizeof(*k->value));
    k->given = calloc(k->n_value + 1, sizeof(*k->given));
    k->arg = calloc(most + 1, sizeof(*k->arg));
    if (!k->numbers || !k->value || !k->given || !k->arg)
        return error_memory(e, "kernels", k->n_value * sizeof(*k->value));
    k->text = kernels_text(k->plan, arena, k->shape, n, k->numbers, k->vectors, e);
    if (!k->text || make_buffers(k, e) || build(k, begins_uniform(k->plan), e))
        return -1;
    return kernels_update(k, e);
}

int kernels_make(struct kernels **out, struct device *d, const struct plan *plan,
                 const struct arena *arena, const struct stage *stage, size_t n_stage,
                 struct error *e)
{
    return kernels_make_as(out, d, plan, arena, stage, n_stage, device_facts(d)->cpu, e);
}

int kernels_make_as(struct kernels **out, struct device *d, const struct plan *plan,
                    const struct arena *arena, const struct stage *stage, size_t n_stage,
                    bool vectors, struct error *e)
{
    struct kernels *k = calloc(1, sizeof(*k));

    *out = NULL;
    if (!k)
        return error_memory(e, "kernels", sizeof(*k));
    k->d = d;
    k->plan = plan;
    k->vectors = vectors;
    if (make(k, arena, stage, n_stage, e)) {
        kernels_free(k);
        return -1;
    }
    *out = k;
    return 0;
}

void kernels_free(struct kernels *k)
{
    if (!k)
        return;
    for (int u = 0; u < 2; u++) {
        device_program_free(k->d, k->program[u]);
        free(k->kernel[u]);
    }
    device_release(k->d, &k->on_device);
    device_release(k->d, &k->table);
    device_release(k->d, &k->failure);
    for (size_t i = 0; i < k->n; i++)
        stage_shape_free(&k->shape[i]);
    free(k->shape);
    free(k->text);
    free(k->numbers);
    free(k->value);
    free(k->given);
    free(k->arg);
    free(k);
}

char *kernels_source(const struct plan *plan, const struct arena *arena, const struct stage *stage,
                     size_t n_stage, bool vectors, struct error *e)
{
    struct kernels k = {.plan = plan};
    char *text = NULL;

    if (!make_shapes(&k, stage, n_stage, e)) {
        k.numbers = pass_numbers_make(plan, &k.n_value);
        if (k.numbers)
            text = kernels_text(plan, arena, k.shape, n_stage, k.numbers, vectors, e);
        else
            error_memory(e, "kernels", plan->n_pass * sizeof(*k.numbers));
    }
    for (size_t i = 0; i < k.n; i++)
        stage_shape_free(&k.shape[i]);
    free(k.shape);
    free(k.numbers);
    return text;
}

/* -- What changes -------- */

int kernels_update(struct kernels *k, struct error *e)
{
    for (size_t i = 0; i < k->plan->n_pass; i++) {
        const struct pass *p = &k->plan->pass[i];
        const struct pass_numbers *numbers = &k->numbers[i];
        if (numbers->n_param)
            memcpy(k->value + numbers->param, p->use.config.value,
                   numbers->n_param * sizeof(double));
        if (numbers->n_state && p->use.state)
            memcpy(k->value + numbers->state, p->use.state, numbers->n_state * sizeof(double));
    }
    if (!k->n_value || memcmp(k->value, k->given, k->n_value * sizeof(double)) == 0)
        return 0;
    memcpy(k->given, k->value, k->n_value * sizeof(double));
    return device_write(k->d, &k->on_device, 0, k->value, k->n_value * sizeof(double), e);
}

static size_t items_of(const struct kernels *k, const struct stage *s, size_t n)
{
    if (!k->vectors)
        return n;
    if (s->n_head == s->n)
        return (n + KERNELS_POINTS - 1) / KERNELS_POINTS;
    const size_t at_once = KERNELS_GROUPS * SPH_LANES;
    return (n + at_once - 1) / at_once;
}

int kernels_launch(struct kernels *k, size_t s, const struct arena *arena,
                   const struct device_list *list, const struct kernel_now *now, struct error *e)
{
    const struct stage_shape *shape = &k->shape[s];
    const size_t n = arena[shape->stage->array].n;
    const uint32_t n_own = (uint32_t)n;
    const int uniform = now->uniform_h;
    uint64_t plane[16]; /* what arguments point to */
    size_t at = 0;
    struct device_arg *arg = k->arg;

    if (n == 0)
        return 0;
    if (shape->n_array > sizeof(plane) / sizeof(plane[0]))
        return error_set(e, EXIT_RUN, "a pass over more than %zu arrays does not run on a device",
                         sizeof(plane) / sizeof(plane[0]));
    if (build(k, uniform, e))
        return -1;
    k->last = *now;
    arg[at++] = DEVICE_VALUE(n_own);
    arg[at++] = DEVICE_VALUE(now->time);
    arg[at++] = DEVICE_VALUE(now->dt);
    arg[at++] = DEVICE_VALUE(now->quantum);
    arg[at++] = DEVICE_VALUE(now->step);
    arg[at++] = DEVICE_VALUE(now->sweep);
    arg[at++] = DEVICE_BUFFER(&k->on_device);
    arg[at++] = DEVICE_BUFFER(&k->table);
    arg[at++] = DEVICE_BUFFER(&k->failure);
    for (size_t i = 0; i < shape->n_array; i++) {
        const struct arena *a = &arena[shape->array[i]];
        plane[i] = a->plane;
        arg[at++] = DEVICE_BUFFER(&a->wide);
        arg[at++] = DEVICE_BUFFER(&a->narrow);
        arg[at++] = DEVICE_VALUE(plane[i]);
    }
    for (size_t i = 0; i < shape->n_source; i++) {
        const struct device_list *l = &list[shape->source[i].list];
        arg[at++] = DEVICE_BUFFER(&l->begin);
        arg[at++] = DEVICE_BUFFER(&l->common);
        arg[at++] = DEVICE_BUFFER(&l->step);
    }
    for (size_t part = 0; part < PART_COUNT; part++) {
        struct device_kernel *kernel = k->kernel[uniform][s * PART_COUNT + part];
        if (kernel && device_launch(k->d, kernel, items_of(k, shape->stage, n), arg, at, e))
            return -1;
    }
    return 0;
}

/* The sentence that a body gave the number of. */
static const char *sentence(const struct pass *p, uint32_t number)
{
    const sph_device_point *const d[3] = {pass_before(p), pass_after(p), pass_point(p)};

    for (int k = 0; k < 3; k++)
        if (d[k] && number >= failures_before(k) && number - failures_before(k) < d[k]->fail.count)
            return *(const char *const *)list_at(&d[k]->fail, number - failures_before(k));
    return "it failed";
}

int kernels_failed(struct kernels *k, bool *failed, struct error *e)
{
    int32_t word = 0;

    *failed = false;
    if (device_read(k->d, &k->failure, 0, &word, sizeof(word), e))
        return -1;
    if (word == 0)
        return 0;
    *failed = true;
    const uint32_t pass = (uint32_t)(word - 1) / FAILURES, number = (uint32_t)(word - 1) % FAILURES;
    if (device_fill(k->d, &k->failure, 0, 0u, sizeof(word), e) || pass >= k->plan->n_pass)
        return -1;
    const struct pass *p = &k->plan->pass[pass];
    error_set(e, EXIT_RUN, "%s at step %llu, t = %g: %s", p->name, (unsigned long long)k->last.step,
              k->last.time, sentence(p, number));
    return 0;
}
