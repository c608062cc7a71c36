/* on_device.c -- see on_device.h. */
#include "config.h"

#include "on_device.h"

#include "opencl/pair_body.h"
#include "registry/loader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool on_device_there(size_t *number, struct error *e)
{
    return pair_body_device(number, e) == 0;
}

/* A device knows no column in two parts. */
static void hold_plainly(struct plan *plan)
{
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        for (size_t c = 0; c < pa->p.n_column; c++) {
            pa->mirrored[c] = pa->mirrored[c] || pa->in_floats[c];
            pa->in_floats[c] = pa->in_two[c] = false;
        }
        pa->mirrored[pa->position] = pa->mirrored[pa->position] || pa->in_quanta;
        pa->in_quanta = false;
    }
}

static int make_plan(struct on_device *o, const struct on_device_as *as, struct error *e)
{
    if (document_parse(&o->document, "scene.json", o->text, strlen(o->text), e))
        return -1;
    o->has_document = true;
    if (scene_compile(&o->scene, &o->document, e))
        return -1;
    o->has_scene = true;
    o->scene.precision = as->precision;
    if (registry_init(&o->registry, e))
        return -1;
    o->has_registry = true;
    for (size_t i = 0; i < o->scene.n_plugin; i++)
        if (loader_load(&o->registry, o->scene.plugin[i], e))
            return -1;
    if (as->entry && registry_add(&o->registry, "/test/test.so", as->entry, NULL, NULL, e))
        return -1;
    o->has_plan = true;
    if (plan_make(&o->plan, &o->registry, &o->scene, false, e))
        return -1;
    hold_plainly(&o->plan);
    return plan_fill(&o->plan, e);
}

static int run_natively(struct on_device *o, int threads, struct error *e)
{
    if (run_init(&o->run, &o->plan, threads, SPH_PATH_BEST, false, e))
        return -1;
    o->has_run = true;
    o->run.dt = 1e-4;
    return run_passes(&o->run, MOMENT_START, e) || run_passes(&o->run, MOMENT_EVALUATE, e) ? -1 : 0;
}

int on_device_open(struct on_device *o, size_t number, const struct on_device_as *as,
                   struct error *e)
{
    *o = (struct on_device){.text = strdup(as->scene)};
    if (!o->text)
        return error_memory(e, "a scene", strlen(as->scene));
    for (char *s = o->text; *s; s++)
        *s = *s == '\'' ? '"' : *s;
    if (make_plan(o, as, e) || run_natively(o, as->threads, e) || device_open(&o->d, number, e))
        return -1;
    o->arena = calloc(o->plan.n_array + 1, sizeof(*o->arena));
    o->list = calloc(o->plan.n_list + 1, sizeof(*o->list));
    if (!o->arena || !o->list)
        return error_memory(e, "arrays", o->plan.n_array);
    for (size_t a = 0; a < o->plan.n_array; a++)
        if (arena_init(&o->arena[a], o->d, &o->plan.array[a].p, e))
            return -1;
    return stages_plan(&o->plan, MOMENT_EVALUATE, as->fuse, &o->stage, &o->n_stage, e) ||
                   kernels_make_as(&o->kernels, o->d, &o->plan, o->arena, o->stage, o->n_stage,
                                   as->vectors, e)
               ? -1
               : 0;
}

void on_device_close(struct on_device *o)
{
    kernels_free(o->kernels);
    stages_free(o->stage, o->n_stage);
    for (size_t k = 0; o->list && k < o->plan.n_list; k++) {
        device_release(o->d, &o->list[k].begin);
        device_release(o->d, &o->list[k].common);
        device_release(o->d, &o->list[k].step);
    }
    for (size_t a = 0; o->arena && a < o->plan.n_array; a++)
        if (o->arena[a].d)
            arena_fini(&o->arena[a]);
    free(o->arena);
    free(o->list);
    device_close(o->d);
    if (o->has_run)
        run_free(&o->run);
    if (o->has_plan)
        plan_free(&o->plan);
    if (o->has_registry)
        registry_fini(&o->registry);
    if (o->has_scene)
        scene_free(&o->scene);
    if (o->has_document)
        document_free(&o->document);
    free(o->text);
}

/* -- To the device -------- */

static int put_column(struct on_device *o, size_t array, int k, struct error *e)
{
    struct arena *a = &o->arena[array];
    const struct column *c = &a->p->column[k];
    const struct arena_place *at = &a->place[k];
    const size_t n = a->p->n + a->p->n_ghost;

    for (uint32_t q = 0; q < c->ncomp; q++) {
        if (device_write(o->d, c->size == 8 ? &a->wide : &a->narrow,
                         (at->slot + q) * a->plane * c->size,
                         (const char *)c->data + q * c->plane * c->size, n * c->size, e))
            return -1;
        if (c->mirror && device_write(o->d, &a->narrow, ((uint32_t)at->mirror + q) * a->plane * 4,
                                      (const char *)c->mirror + q * c->plane * 4, n * 4, e))
            return -1;
    }
    return 0;
}

/* Spans' sources one by one: of all what is for all lanes, then what takes turns. */
static int put_list(struct on_device *o, size_t k, struct error *e)
{
    const struct group_list *l = &o->run.list[k];
    struct device_list *to = &o->list[k];
    uint32_t *begin = calloc(2 * l->n_group + 2, sizeof(*begin)), *common = begin + l->n_group + 1;
    uint32_t *step = calloc(l->n_entry + 1, sizeof(*step)), at = 0;
    int status = begin && step ? 0 : error_memory(e, "a list", l->n_entry);

    for (size_t g = 0; !status && g < l->n_group; g++) {
        begin[g] = at;
        for (int turns = 0; turns < 2; turns++) {
            for (uint64_t s = l->begin[g]; s < l->begin[g + 1]; s++)
                for (uint32_t i = turns ? l->span[s].common : 0;
                     i < (turns ? l->span[s].count : l->span[s].common); i++)
                    step[at++] = l->span[s].base + l->step[l->span[s].first + i];
            if (!turns)
                common[g] = at - begin[g];
        }
        begin[g + 1] = at;
    }
    to->n_group = l->n_group;
    to->n_entry = at;
    if (!status)
        status = device_reserve(o->d, &to->begin, (l->n_group + 1) * 4, "lists", e) ||
                 device_reserve(o->d, &to->common, (l->n_group + 1) * 4, "lists", e) ||
                 device_reserve(o->d, &to->step, (at + 1u) * 4u, "lists", e) ||
                 device_write(o->d, &to->begin, 0, begin, (l->n_group + 1) * 4, e) ||
                 device_write(o->d, &to->common, 0, common, l->n_group * 4, e) ||
                 device_write(o->d, &to->step, 0, step, at * 4u, e);
    free(begin);
    free(step);
    return status;
}

int on_device_put(struct on_device *o, struct error *e)
{
    for (size_t a = 0; a < o->plan.n_array; a++) {
        const struct particles *p = &o->plan.array[a].p;
        if (arena_resize(&o->arena[a], p->n, p->n_ghost, e))
            return -1;
        for (int c = 0; c < (int)p->n_column; c++) {
            if (run_refresh(&o->run, a, c, e) || run_mirror(&o->run, a, c, e) ||
                put_column(o, a, c, e))
                return -1;
        }
    }
    for (size_t k = 0; k < o->plan.n_list; k++)
        if (put_list(o, k, e))
            return -1;
    return 0;
}

struct kernel_now on_device_now(const struct on_device *o)
{
    const struct run *r = &o->run;
    double low = INFINITY, high = 0.0;

    for (size_t a = 0; a < o->plan.n_array; a++) {
        low = fmin(low, r->h_low[a]);
        high = fmax(high, r->h_high[a]);
    }
    return (struct kernel_now){.time = r->time,
                               .dt = r->dt,
                               .step = r->step,
                               .quantum = r->quantum,
                               .uniform_h = r->h_fixed && !(low < high)};
}

static int is_busy(const struct on_device *o, const struct stage *s, bool *busy, struct error *e)
{
    const struct arena *a = &o->arena[s->array];
    const struct pass *p = &o->plan.pass[s->pass[s->n_head]];
    int32_t *asks = malloc((a->n + 1) * sizeof(*asks));
    int status = asks ? 0 : error_memory(e, "a column", a->n);

    *busy = false;
    if (!status)
        status = device_read(o->d, &a->narrow, a->place[p->unfinished].slot * a->plane * 4, asks,
                             a->n * 4, e);
    for (size_t i = 0; !status && i < a->n; i++)
        *busy = *busy || asks[i];
    free(asks);
    return status;
}

int on_device_stage(struct on_device *o, size_t k, struct error *e)
{
    const struct stage *s = &o->stage[k];
    struct kernel_now now = on_device_now(o);
    bool again = true;

    if (kernels_update(o->kernels, e))
        return -1;
    for (now.sweep = 0; again; now.sweep++) {
        if (kernels_launch(o->kernels, k, o->arena, o->list, &now, e))
            return -1;
        again = s->iterates && now.sweep + 1 < o->plan.pass[s->pass[s->n_head]].max_sweeps;
        if (again && is_busy(o, s, &again, e))
            return -1;
    }
    return 0;
}

int on_device_fetch(struct on_device *o, struct error *e)
{
    for (size_t a = 0; a < o->plan.n_array; a++) {
        const struct arena *arena = &o->arena[a];
        for (size_t k = 0; k < arena->p->n_column; k++) {
            const struct column *c = &arena->p->column[k];
            for (uint32_t q = 0; q < c->ncomp; q++)
                if (device_read(o->d, c->size == 8 ? &arena->wide : &arena->narrow,
                                (arena->place[k].slot + q) * arena->plane * c->size,
                                (char *)c->data + q * c->plane * c->size, arena->n * c->size, e))
                    return -1;
            run_changed(&o->run, a, (int)k);
        }
    }
    return 0;
}

int on_device_run(struct on_device *o, struct error *e)
{
    for (size_t k = 0; k < o->n_stage; k++)
        if (on_device_put(o, e) || on_device_stage(o, k, e) || on_device_fetch(o, e))
            return -1;
    return 0;
}
