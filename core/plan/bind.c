/* plan/bind.c -- steps to passes: one for each destination array, its columns bound to the names that the
 * function declares, its sources found. */
#include "base/text.h"
#include "plan/inside.h"
#include <stdlib.h>
#include <string.h>

static bool listed(const char *const *names, size_t n, const char *name)
{
    if (n == 0)
        return true;
    for (size_t i = 0; i < n; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

/* Every name of an edit's list is an array. */
static int check_arrays(const struct plan *plan, const struct step *s, const char *const *names,
                        size_t n, struct error *e)
{
    for (size_t i = 0; i < n; i++) {
        bool found = false;
        for (size_t a = 0; a < plan->n_array; a++)
            found = found || strcmp(plan->array[a].p.name, names[i]) == 0;
        if (found)
            continue;
        char near[512];
        const char **known = calloc(plan->n_array + 1, sizeof *known);
        for (size_t a = 0; known && a < plan->n_array; a++)
            known[a] = plan->array[a].p.name;
        text_suggest(near, sizeof near, names[i], known, known ? plan->n_array : 0);
        free(known);
        return document_fail(plan->scene->doc, s->node, e, "there is no particle array \"%s\"%s",
                             names[i], near);
    }
    return 0;
}

/* Columns of `array` for every declared property; access_mask: those that must exist there. */
int bind_columns(struct plan *plan, struct binding *b, size_t array, const sph_item *item,
                 uint32_t access_mask, struct error *e)
{
    struct particles *p = &plan->array[array].p;
    b->array = array;
    b->column = malloc((item->props.count + 1) * sizeof *b->column);
    if (!b->column)
        return error_memory(e, "the plan", item->props.count * sizeof *b->column);
    for (uint32_t k = 0; k < item->props.count; k++) {
        const sph_prop *prop = list_at(&item->props, k);
        b->column[k] = -1;
        if (!(prop->access & access_mask))
            continue;
        b->column[k] = particles_add(p, prop->name, prop->unit, prop->doc, prop->type, e);
        if (b->column[k] < 0)
            return error_prefix(e, "%s", item->name);
    }
    return 0;
}

/* The parameters of a use: the scheme's members that it declares, then its boundary condition's, then
 * those of its own steps (more than one where a function stands for several). */
static int configure(struct plan *plan, struct use *use, const struct step *s, size_t parts,
                     struct error *e)
{
    const struct document *d = plan->scene->doc;
    const cJSON *member;
    cJSON_ArrayForEach(member, plan->scene->scheme.params)
    {
        if (use_declares(use, member->string) && use_set(use, d, member, e))
            return -1;
    }
    cJSON_ArrayForEach(member, s->shared)
    {
        if (use_declares(use, member->string) && use_set(use, d, member, e))
            return -1;
    }
    for (size_t k = 0; k < parts; k++)
        if (use_set_all(use, d, s[k].params, e))
            return -1;
    return 0;
}

/* What the plugin, or a parameter that is missing, has against it, with the place that asks for it. */
static int create(struct plan *plan, struct use *use, const cJSON *node, struct error *e)
{
    struct error why = {0};
    if (use_create(use, plan->registry, plan->dim, &why) == 0)
        return 0;
    return document_fail(plan->scene->doc, node, e, "%s", why.text);
}

static int configure_eos(struct plan *plan, struct use *use, const struct scene_material *m,
                         struct error *e)
{
    const struct document *d = plan->scene->doc;
    const struct entry *entry = registry_find(plan->registry, KIND_EOS, m->eos);
    if (!entry)
        return plan_unknown(plan, m->eos_node, KIND_EOS, m->eos, e);
    const sph_eos *eos = entry_eos(entry);
    if (use_init(use, entry, eos->item, eos->life, e))
        return -1;
    if (use_set_all(use, d, m->eos_params, e))
        return -1;
    return create(plan, use, m->eos_node, e);
}

static const struct scene_material *material_of(const struct plan *plan, size_t array)
{
    size_t m = plan->scene->array[array].material;
    return m == SIZE_MAX ? NULL : &plan->scene->material[m];
}

static struct pass *new_pass(struct plan *plan, const struct step *s, size_t array, struct error *e)
{
    struct pass *bigger = plan_grow(plan->pass, &plan->n_pass, sizeof *bigger);
    if (!bigger) {
        error_memory(e, "the plan", sizeof *bigger);
        return NULL;
    }
    plan->pass = bigger;
    struct pass *p = &bigger[plan->n_pass - 1];
    p->step = s->name;
    p->moment = s->moment;
    p->unfinished = -1;
    if (plan_name(&p->name, e, "%s(%s)", s->name, plan->array[array].p.name))
        return NULL;
    return p;
}

#define DST_ANY                                                                                    \
    (SPH_DST_READ | SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN | SPH_SRC_READ)

/* What the scene says of an operation must fit what is declared: an assignment acts on each particle alone, a
 * summation sums over neighbours, an integration gives a rate. */
static int check_operation(struct plan *plan, const struct pass *p, const struct step *s,
                           struct error *e)
{
    const struct document *d = plan->scene->doc;
    const char *operation = s->operation ? s->operation : "";
    bool integration = strcmp(operation, "integration") == 0, sets = false, rate = false;
    for (uint32_t i = 0; p->function && i < p->function->rates.count; i++) {
        const sph_rate *r = list_at(&p->function->rates, i);
        rate = rate || !s->of || strcmp(r->property, s->of) == 0;
    }
    for (uint32_t k = 0; s->of && k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        sets =
            sets || ((prop->access & (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)) &&
                     strcmp(prop->name, s->of) == 0);
    }
    if (strcmp(operation, "summation") == 0 && p->shape != SPH_PAIR)
        return document_fail(d, s->node, e, "%s is no summation: it sums over no neighbours",
                             s->name);
    if (strcmp(operation, "assignment") == 0 && p->shape == SPH_PAIR)
        return document_fail(d, s->node, e, "%s is no assignment: it sums over neighbours",
                             s->name);
    if (integration && !rate)
        return document_fail(d, s->node, e, "%s is no integration: it declares no rate%s%s%s",
                             s->name, s->of ? " of \"" : "", s->of ? s->of : "", s->of ? "\"" : "");
    if (s->of && !integration && !sets && (s->operation || !rate))
        return document_fail(d, s->node, e, "%s does not set \"%s\"", s->name, s->of);
    return 0;
}

static int bind_eos(struct plan *plan, const struct step *s, size_t array, struct error *e)
{
    const struct scene_material *m = material_of(plan, array);
    if (!m || !m->eos) {
        if (s->n_to == 0)
            return 0;
        return document_fail(plan->scene->doc, s->node, e, "array \"%s\" has no equation of state",
                             plan->array[array].p.name);
    }
    struct pass *p = new_pass(plan, s, array, e);
    if (!p || configure_eos(plan, &p->use, m, e))
        return -1;
    const sph_eos *eos = entry_eos(p->use.entry);
    p->shape = SPH_POINT;
    p->run = eos->run;
    if (bind_columns(plan, &p->dst, array, eos->item, DST_ANY, e) || check_operation(plan, p, s, e))
        return -1;
    /* The state and parameters that the inverse needs, too. */
    return plan->array[array].eos.item ? 0 : configure_eos(plan, &plan->array[array].eos, m, e);
}

static int bind_assignment(struct plan *plan, const struct step *s, size_t array, struct error *e)
{
    struct pass *p = new_pass(plan, s, array, e);
    if (!p || assignment_bind(plan, p, s, array, e))
        return -1;
    return bind_columns(plan, &p->dst, array, p->use.item, DST_ANY, e);
}

/* Of a function: its frame, made if it is new. */
static int find_frame(struct plan *plan, const struct pass *p, const struct step *s, size_t *frame,
                      struct error *e)
{
    const char *over = p->function->over;
    const struct box *box = &plan->scene->box;
    for (*frame = 0; over && *frame < plan->n_frame; (*frame)++)
        if (strcmp(plan->frame[*frame].name, over) == 0 &&
            plan->frame[*frame].frozen == (p->function->frozen != 0))
            return 0;
    if (!over)
        return 0;
    for (int c = 0; box->bounded && c < plan->dim; c++)
        if (box->side[c][0] != SIDE_OPEN || box->side[c][1] != SIDE_OPEN)
            return document_fail(plan->scene->doc, s->node ? s->node : plan->scene->scheme.node, e,
                                 "%s looks for neighbours in \"%s\", which is not possible in a "
                                 "domain with periodic or mirror sides",
                                 s->name, over);
    struct frame *bigger = plan_grow(plan->frame, &plan->n_frame, sizeof *bigger);
    if (!bigger)
        return error_memory(e, "the plan", sizeof *bigger);
    plan->frame = bigger;
    plan->frame[*frame] = (struct frame){over, p->function->frozen != 0, NULL, NULL};
    return plan->frame[*frame].frozen &&
                   (plan_name(&plan->frame[*frame].kept, e, "%s.frozen", over) ||
                    plan_name(&plan->frame[*frame].kept_h, e, "%s.frozen-h", over))
               ? -1
               : 0;
}

/* The columns that a frame looks for neighbours in outlive sorts, and so do the copies of a frozen one. */
static int frame_columns(struct plan *plan, size_t frame, size_t array, struct error *e)
{
    struct particles *p = &plan->array[array].p;
    const struct frame *f = &plan->frame[frame];
    const int over = particles_find(p, f->name);
    if (frame == 0 || over < 0)
        return 0;
    p->column[over].state = true;
    if (!f->frozen)
        return 0;
    const int x = particles_add(p, f->kept, "m", "where neighbours were found", SPH_VECTOR, e);
    const int h = x < 0 ? -1 : particles_add(p, f->kept_h, "m", "likewise", SPH_SCALAR, e);
    if (x < 0 || h < 0)
        return -1;
    p->column[x].state = p->column[h].state = true;
    return 0;
}

/* The list of this pair in this frame, made if it is new; it reaches as far as any pass asks. */
static int find_list(struct plan *plan, const struct pass *p, size_t src, size_t *list,
                     struct error *e)
{
    for (*list = 0; *list < plan->n_list; (*list)++) {
        struct plan_list *l = &plan->list[*list];
        if (l->dst != p->dst.array || l->src != src || l->frame != p->frame)
            continue;
        l->reach = p->reach > l->reach ? p->reach : l->reach;
        return 0;
    }
    struct plan_list *bigger = plan_grow(plan->list, &plan->n_list, sizeof *bigger);
    if (!bigger)
        return error_memory(e, "the plan", sizeof *bigger);
    plan->list = bigger;
    plan->list[*list] = (struct plan_list){p->dst.array, src, p->frame, p->reach};
    return 0;
}

static int bind_sources(struct plan *plan, struct pass *p, const struct step *s, struct error *e)
{
    p->src = calloc(plan->n_array, sizeof *p->src);
    p->list = calloc(plan->n_array, sizeof *p->list);
    if (!p->src || !p->list)
        return error_memory(e, "the plan", plan->n_array * sizeof *p->src);
    if (find_frame(plan, p, s, &p->frame, e))
        return -1;
    for (size_t a = 0; a < plan->n_array; a++) {
        if (!listed(s->from, s->n_from, plan->array[a].p.name))
            continue;
        if (bind_columns(plan, &p->src[p->n_src], a, p->use.item, SPH_SRC_READ, e) ||
            find_list(plan, p, a, &p->list[p->n_src], e) || frame_columns(plan, p->frame, a, e) ||
            frame_columns(plan, p->frame, p->dst.array, e))
            return -1;
        p->n_src++;
    }
    return 0;
}

/* What a function that makes particles needs besides its own columns. */
static int bind_population(struct plan *plan, const struct pass *p, const struct step *s,
                           struct error *e)
{
    const sph_population *d = p->use.entry->population;
    struct particles *particles = &plan->array[p->dst.array].p;
    if (!d)
        return 0;
    if (s->moment != MOMENT_FINISH)
        return document_fail(plan->scene->doc, s->node ? s->node : plan->scene->scheme.node, e,
                             "%s removes or creates particles, so it stands at \"finish\", not at "
                             "\"%s\"",
                             s->name, moment_name[s->moment]);
    for (uint32_t k = 0; k < d->born_props.count; k++) {
        const sph_prop *prop = list_at(&d->born_props, k);
        if (particles_add(particles, prop->name, prop->unit, prop->doc, prop->type, e) < 0)
            return error_prefix(e, "%s", s->name);
    }
    return 0;
}

/* parts: of a function that stands for several steps, from s on, those; else 1. */
static int bind_function(struct plan *plan, const struct step *s, size_t parts,
                         const struct entry *entry, size_t array, struct error *e)
{
    if (!entry)
        return plan_unknown(plan, s->node ? s->node : plan->scene->scheme.node, KIND_FUNCTION,
                            s->name, e);
    const sph_function *f = entry_function(entry);
    if (!(f->item->dims & (1u << plan->dim)))
        return document_fail(plan->scene->doc, s->node ? s->node : plan->scene->scheme.node, e,
                             "%s does not work in %d dimensions", s->name, plan->dim);
    struct step whole = *s; /* under its own name */
    if (parts > 1)
        whole.name = (char *)(uintptr_t)f->item->name;
    struct pass *p = new_pass(plan, &whole, array, e);
    if (!p || use_init(&p->use, entry, f->item, f->life, e) ||
        configure(plan, &p->use, s, parts, e))
        return -1;
    if (create(plan, &p->use, s->node ? s->node : plan->scene->scheme.node, e))
        return -1;
    p->function = f;
    p->shape = f->shape;
    p->before = f->before;
    p->run = f->run;
    p->after = f->after;
    p->reach = f->reach;
    p->max_sweeps = f->max_sweeps;
    if (bind_columns(plan, &p->dst, array, f->item, DST_ANY, e) || check_operation(plan, p, s, e) ||
        bind_population(plan, p, s, e))
        return -1;
    if (f->max_sweeps)
        p->unfinished = particles_find(&plan->array[array].p, f->unfinished);
    if (f->shape != SPH_PAIR)
        return 0;
    if (!plan->has_kernel)
        return document_fail(plan->scene->doc, plan->scene->scheme.node, e,
                             "%s sums over neighbours, so the scene needs a \"kernel\"", s->name);
    if (f->reach_scale > plan->reach_scale)
        plan->reach_scale = f->reach_scale;
    return bind_sources(plan, p, s, e);
}

static int bind_reductions(struct plan *plan, size_t pass, struct error *e)
{
    const struct pass *p = &plan->pass[pass];
    for (uint32_t i = 0; p->function && i < p->function->reductions.count; i++) {
        const sph_reduction *declared = list_at(&p->function->reductions, i);
        struct reduction *bigger = plan_grow(plan->reduction, &plan->n_reduction, sizeof *bigger);
        if (!bigger)
            return error_memory(e, "reductions", sizeof *bigger);
        plan->reduction = bigger;
        bigger[plan->n_reduction - 1] =
            (struct reduction){declared, pass, p->dst.array,
                               particles_find(&plan->array[p->dst.array].p, declared->property)};
    }
    return 0;
}

/* Nothing that the sweeps read of sources is written by this pass, so that one chunk of destinations may
 * be done with while another has not begun. */
static bool is_local(const struct plan *plan, const struct pass *p)
{
    for (size_t s = 0; s < p->n_src; s++) {
        const struct plan_array *from = &plan->array[p->src[s].array];
        for (uint32_t k = 0; k < p->use.item->props.count; k++)
            if (p->src[s].column[k] >= 0 && pass_writes(p, p->src[s].array, p->src[s].column[k]))
                return false;
        if (pass_writes(p, p->src[s].array, from->position) ||
            pass_writes(p, p->src[s].array, from->smoothing))
            return false;
    }
    return true;
}

/* The step that stands at `first` in the recipe, or as many as one function does at once; how many. */
static size_t bind_step(struct plan *plan, size_t first, struct error *e)
{
    const struct step *s = &plan->step[first];
    const struct entry *entry = NULL;
    const size_t parts = fusion_find(plan, first, &entry);
    if (!parts && s->kind == KIND_FUNCTION && !s->expression)
        entry = registry_find(plan->registry, KIND_FUNCTION, s->name);
    if (check_arrays(plan, s, s->to, s->n_to, e) || check_arrays(plan, s, s->from, s->n_from, e))
        return 0;
    for (size_t a = 0; a < plan->n_array; a++) {
        if (!listed(s->to, s->n_to, plan->array[a].p.name))
            continue;
        const int status = s->expression ? bind_assignment(plan, s, a, e)
                           : s->kind == KIND_EOS
                               ? bind_eos(plan, s, a, e)
                               : bind_function(plan, s, parts ? parts : 1, entry, a, e);
        if (status)
            return 0;
    }
    return parts ? parts : 1;
}

int bind_passes(struct plan *plan, struct error *e)
{
    plan->frame = plan_grow(NULL, &plan->n_frame, sizeof *plan->frame);
    if (!plan->frame)
        return error_memory(e, "the plan", sizeof *plan->frame);
    plan->frame[0] = (struct frame){"x", false, NULL, NULL};
    plan->reach_scale = 0.0;
    for (size_t i = 0, n; i < plan->n_step; i += n) {
        n = bind_step(plan, i, e);
        if (!n)
            return -1;
    }
    if (plan->reach_scale <= 0.0)
        plan->reach_scale = 1.0;
    for (size_t i = 0; i < plan->n_pass; i++) {
        struct pass *p = &plan->pass[i];
        p->local = is_local(plan, p);
        p->space = calloc((2 + p->n_src) * p->use.item->props.count + 1, sizeof *p->space);
        if (!p->space)
            return error_memory(e, "the plan", p->use.item->props.count * sizeof *p->space);
        if (bind_reductions(plan, i, e))
            return -1;
    }
    return 0;
}

const struct plan_list *plan_pair(const struct plan *plan, size_t dst, size_t src)
{
    for (size_t i = 0; i < plan->n_list; i++)
        if (plan->list[i].dst == dst && plan->list[i].src == src && plan->list[i].frame == 0)
            return &plan->list[i];
    return NULL;
}

void bind_free(struct plan *plan)
{
    for (size_t i = 0; i < plan->n_pass; i++) {
        struct pass *p = &plan->pass[i];
        use_fini(&p->use, plan->registry);
        assignment_free(p->assignment);
        free(p->name);
        free(p->dst.column);
        free(p->continues);
        free(p->space);
        for (size_t k = 0; k < p->n_src; k++)
            free(p->src[k].column);
        free(p->src);
        free(p->list);
    }
    free(plan->pass);
    free(plan->reduction);
    for (size_t i = 0; i < plan->n_frame; i++) {
        free(plan->frame[i].kept);
        free(plan->frame[i].kept_h);
    }
    free(plan->frame);
    free(plan->list);
}

static bool binding_has(const struct pass *p, const struct binding *b, size_t array, int column,
                        uint32_t access)
{
    if (b->array != array)
        return false;
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if ((prop->access & access) && b->column[k] == column)
            return true;
    }
    return false;
}

bool pass_writes(const struct pass *p, size_t array, int column)
{
    return binding_has(p, &p->dst, array, column,
                       SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN);
}

bool pass_reads_source(const struct pass *p, size_t array, int column)
{
    for (size_t s = 0; s < p->n_src; s++)
        if (binding_has(p, &p->src[s], array, column, SPH_SRC_READ))
            return true;
    return false;
}

bool plan_changes(const struct plan *plan, size_t array, int column)
{
    const struct plan_array *a = &plan->array[array];
    for (size_t k = 0; k < a->n_rate; k++)
        if (a->rate[k].property == column)
            return true;
    for (size_t i = 0; i < plan->n_pass; i++)
        if (pass_writes(&plan->pass[i], array, column))
            return true;
    return false;
}
