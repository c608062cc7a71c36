/* plan/plan.c -- plan_make: names to items, items to passes; plan_fill: particles and their first state. */
#include "plan/plan.h"
#include "base/text.h"
#include "plan/inside.h"
#include "registry/kernel_form.h"
#include "scene/fill.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int find_scheme(struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    plan->cfl = s->time.cfl;
    plan->scheme_name = s->scheme.name;
    if (s->scheme.name) {
        const struct entry *entry = registry_find(plan->registry, KIND_SCHEME, s->scheme.name);
        if (!entry)
            return plan_unknown(plan, s->scheme.node, KIND_SCHEME, s->scheme.name, e);
        plan->scheme = entry_scheme(entry);
        if (!(plan->scheme->item->dims & (1u << plan->dim)))
            return document_fail(s->doc, s->scheme.node, e,
                                 "the scheme \"%s\" does not work in %d dimensions", s->scheme.name,
                                 plan->dim);
        if (isnan(plan->cfl))
            plan->cfl = plan->scheme->cfl;
    }
    if (isnan(plan->cfl) || plan->cfl <= 0.0)
        plan->cfl = 0.3;
    return 0;
}

static int find_kernel(struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    plan->kernel_name = s->kernel.name ? s->kernel.name
                        : plan->scheme ? plan->scheme->kernel
                                       : NULL;
    if (!plan->kernel_name)
        return 0;
    const cJSON *node = s->kernel.node ? s->kernel.node : s->scheme.node;
    const struct entry *entry = registry_find(plan->registry, KIND_KERNEL, plan->kernel_name);
    if (!entry)
        return plan_unknown(plan, node, KIND_KERNEL, plan->kernel_name, e);
    if (!(entry->item->dims & (1u << plan->dim)))
        return document_fail(s->doc, node, e, "the kernel \"%s\" does not work in %d dimensions",
                             plan->kernel_name, plan->dim);
    plan->has_kernel = true;
    return kernel_form_make(&plan->kernel, entry_kernel(entry), plan->dim, e);
}

static int find_integrator(struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    const char *name = s->time.integrator ? s->time.integrator
                       : plan->scheme     ? plan->scheme->integrator
                                          : "kdk";
    plan->integrator = integrator_find(name);
    if (plan->integrator) {
        /* The scheme's number is for its own integrator. */
        const struct integrator *own =
            plan->scheme ? integrator_find(plan->scheme->integrator) : NULL;
        if (own && isnan(s->time.cfl))
            plan->cfl *= plan->integrator->knee / own->knee;
        return 0;
    }
    size_t n;
    const char *const *known = integrator_names(&n);
    char near[256];
    return document_fail(s->doc, s->time.node, e, "there is no integrator \"%s\"%s", name,
                         text_suggest(near, sizeof near, name, known, n));
}

static int find_manager(struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    const char *name[16];
    char near[256];
    size_t n = 0;
    if (!s->neighbours.manager)
        return 0;
    plan->manager = neighbour_manager_find(s->neighbours.manager);
    for (; n < 16 && neighbour_manager_at(n); n++)
        name[n] = neighbour_manager_at(n)->name;
    if (plan->manager)
        return 0;
    return document_fail(s->doc, json_get(s->neighbours.node, "manager"), e,
                         "there is no neighbour manager \"%s\"%s", s->neighbours.manager,
                         text_suggest(near, sizeof near, s->neighbours.manager, name, n));
}

/* A scheme's member that no step declares is a slip of the pen. */
static int check_scheme_members(const struct plan *plan, struct error *e)
{
    const cJSON *member;
    cJSON_ArrayForEach(member, plan->scene->scheme.params)
    {
        bool known = false;
        const char *name[256];
        size_t n = 0;
        for (size_t i = 0; i < plan->n_pass; i++) {
            const sph_item *item = plan->pass[i].use.item;
            if (!plan->pass[i].function)
                continue;
            known = known || use_declares(&plan->pass[i].use, member->string);
            for (uint32_t k = 0; k < item->params.count && n < 256; k++) {
                name[n] = ((const sph_param *)list_at(&item->params, k))->name;
                bool seen = false;
                for (size_t m = 0; m < n; m++)
                    seen = seen || strcmp(name[m], name[n]) == 0;
                n += !seen;
            }
        }
        char near[512];
        if (!known)
            return document_fail(plan->scene->doc, member, e, "%s%s%s has no parameter \"%s\"%s",
                                 plan->scheme_name ? "the scheme \"" : "the recipe",
                                 plan->scheme_name ? plan->scheme_name : "",
                                 plan->scheme_name ? "\"" : "", member->string,
                                 text_suggest(near, sizeof near, member->string, name, n));
    }
    return 0;
}

/* The parameters of a function by name, behind the n that are in `name`; true: `member` is one. */
static bool declares(const struct plan *plan, const char *function, const char *member,
                     const char **name, size_t most, size_t *n)
{
    const struct entry *x = registry_find(plan->registry, KIND_FUNCTION, function);
    bool found = false;
    for (uint32_t k = 0; x && k < x->item->params.count; k++) {
        const char *own = ((const sph_param *)list_at(&x->item->params, k))->name;
        found = found || strcmp(own, member) == 0;
        if (*n < most)
            name[(*n)++] = own;
    }
    return found;
}

/* A boundary condition's member that none of its steps declares, likewise: neither of those that it
 * brings, which an edit may have taken out, nor of those that an edit has put into their place. */
static int check_boundary_members(const struct plan *plan, const struct scene_boundary *b,
                                  struct error *e)
{
    const sph_list *steps =
        &entry_boundary(registry_find(plan->registry, KIND_BOUNDARY, b->name))->steps;
    const cJSON *member;
    cJSON_ArrayForEach(member, b->params)
    {
        const char *name[256];
        size_t n = 0;
        bool known = false;
        for (uint32_t i = 0; i < steps->count; i++)
            known = declares(plan, ((const sph_step *)list_at(steps, i))->name, member->string,
                             name, 256, &n) ||
                    known;
        for (size_t i = 0; i < plan->n_step; i++)
            if (plan->step[i].shared == b->params && plan->step[i].node != b->node)
                known = declares(plan, plan->step[i].name, member->string, name, 256, &n) || known;
        char near[512];
        if (!known)
            return document_fail(plan->scene->doc, member, e,
                                 "the boundary condition \"%s\" has no parameter \"%s\"%s", b->name,
                                 member->string,
                                 text_suggest(near, sizeof near, member->string, name, n));
    }
    return 0;
}

static int check_boundaries(const struct plan *plan, struct error *e)
{
    for (size_t i = 0; i < plan->scene->n_boundary; i++)
        if (check_boundary_members(plan, &plan->scene->boundary[i], e))
            return -1;
    return 0;
}

/* A list that reaches further is made less often, and costs each of its sweeps some per cent: the best is
 * flat. A third of the list's making was saved at no cost where one sweep walks it in 2D; in 3D the
 * list is large, and with several sweeps it is they that take the time. */
static void decide_skin(struct plan *plan)
{
    size_t sweeps = 0;
    for (size_t i = 0; i < plan->n_pass; i++)
        sweeps += plan->pass[i].shape == SPH_PAIR && plan->pass[i].moment == MOMENT_EVALUATE;
    plan->skin = plan->scene->neighbours.skin;
    if (isnan(plan->skin))
        plan->skin = plan->dim < 3 && sweeps == 1 ? 0.15 : 0.1;
}

int plan_make(struct plan *plan, struct registry *r, const struct scene *s, bool guarded,
              struct error *e)
{
    *plan = (struct plan){.registry = r, .scene = s, .dim = s->dim};
    if (find_scheme(plan, e) || find_kernel(plan, e) || find_integrator(plan, e) ||
        find_manager(plan, e) || recipe_make(plan, e) || columns_begin(plan, guarded, e) ||
        bind_passes(plan, e) || check_scheme_members(plan, e) || check_boundaries(plan, e) ||
        columns_finish(plan, e) || asked_bind(plan, e))
        return -1;
    decide_skin(plan);
    return 0;
}

void plan_free(struct plan *plan)
{
    asked_free(plan);
    bind_free(plan);
    recipe_free(plan);
    kernel_form_fini(&plan->kernel);
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        if (pa->eos.item)
            use_fini(&pa->eos, plan->registry);
        particles_fini(&pa->p);
        free(pa->rate);
        free(pa->given);
        free(pa->required);
        free(pa->initial);
        free(pa->in_floats);
        free(pa->in_two);
        free(pa->mirrored);
    }
    free(plan->array);
    *plan = (struct plan){0};
}
