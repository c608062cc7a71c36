/* plan/recipe.c -- the scheme's steps, as the scene has edited them: inserted, replaced, deleted, added. */
#include "base/text.h"
#include "plan/inside.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const moment_name[MOMENT_COUNT] = {SPH_AT_START, SPH_AT_EVALUATE, SPH_AT_FINISH};

void *plan_grow(void *array, size_t *n, size_t size)
{
    char *bigger = realloc(array, (*n + 1) * size);
    if (!bigger)
        return NULL;
    memset(bigger + *n * size, 0, size);
    *n += 1;
    return bigger;
}

int plan_name(char **out, struct error *e, const char *format, ...)
{
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    *out = text_format("%s", text);
    return *out ? 0 : error_memory(e, "a name", strlen(text));
}

int plan_unknown(const struct plan *plan, const cJSON *node, enum kind kind, const char *name,
                 struct error *e)
{
    char near[512] = "";
    size_t n = 0;
    const char **known = registry_names(plan->registry, kind, &n);
    if (n == 0)
        snprintf(near, sizeof near,
                 "; no plugin that is loaded has any: use --load or \"plugins\"");
    else
        text_suggest(near, sizeof near, name, known, n);
    free(known);
    return document_fail(plan->scene->doc, node, e, "no %s \"%s\" is registered%s",
                         kind_label[kind], name, near);
}

static int moment_find(const char *at)
{
    for (int k = 0; k < MOMENT_COUNT; k++)
        if (strcmp(at, moment_name[k]) == 0)
            return k;
    return -1;
}

static int step_find(const struct plan *plan, const char *name)
{
    for (size_t i = 0; i < plan->n_step; i++)
        if (strcmp(plan->step[i].name, name) == 0)
            return (int)i;
    return -1;
}

/* Makes room for a step at `index` and returns it. */
static struct step *step_insert(struct plan *plan, size_t index, struct error *e)
{
    struct step *bigger = plan_grow(plan->step, &plan->n_step, sizeof *bigger);
    if (!bigger) {
        error_memory(e, "the recipe", sizeof *bigger);
        return NULL;
    }
    plan->step = bigger;
    memmove(bigger + index + 1, bigger + index, (plan->n_step - 1 - index) * sizeof *bigger);
    bigger[index] = (struct step){0};
    return &bigger[index];
}

static void step_delete(struct plan *plan, size_t index)
{
    free(plan->step[index].name);
    memmove(plan->step + index, plan->step + index + 1,
            (plan->n_step - 1 - index) * sizeof *plan->step);
    plan->n_step--;
}

static struct step *recipe_step(struct plan *plan, const sph_step *declared, const cJSON *node,
                                size_t index, struct error *e)
{
    struct step *s = step_insert(plan, index, e);
    if (!s)
        return NULL;
    bool eos = strcmp(declared->kind, SPH_KIND_EOS) == 0;
    s->kind = eos ? KIND_EOS : KIND_FUNCTION;
    s->moment = (enum moment)moment_find(declared->at);
    s->node = node;
    return plan_name(&s->name, e, "%s", eos ? "eos" : declared->name) ? NULL : s;
}

static int recipe_from_scheme(struct plan *plan, struct error *e)
{
    for (uint32_t i = 0; i < plan->scheme->steps.count; i++)
        if (!recipe_step(plan, list_at(&plan->scheme->steps, i), NULL, plan->n_step, e))
            return -1;
    return 0;
}

static int edit_target(const struct plan *plan, const struct scene_edit *edit, struct error *e)
{
    int at = step_find(plan, edit->anchor);
    if (at >= 0)
        return at;
    char near[512];
    const char **known = calloc(plan->n_step + 1, sizeof *known);
    for (size_t i = 0; known && i < plan->n_step; i++)
        known[i] = plan->step[i].name;
    text_suggest(near, sizeof near, edit->anchor, known, known ? plan->n_step : 0);
    free(known);
    return document_fail(plan->scene->doc, edit->node, e, "the recipe has no step \"%s\"%s",
                         edit->anchor, near);
}

static int recipe_edit(struct plan *plan, const struct scene_edit *edit, struct error *e)
{
    size_t index = plan->n_step;
    enum moment moment = MOMENT_EVALUATE;
    struct step old = {0}; /* whose arrays and parameters a replacement takes over */
    if (edit->kind != EDIT_APPEND) {
        int at = edit_target(plan, edit, e);
        if (at < 0)
            return -1;
        moment = plan->step[at].moment;
        if (edit->kind == EDIT_REPLACE)
            old = plan->step[at];
        index = (size_t)at + (edit->kind == EDIT_INSERT_AFTER ? 1u : 0u);
    }
    if (edit->kind == EDIT_DELETE || edit->kind == EDIT_REPLACE)
        step_delete(plan, index);
    if (edit->kind == EDIT_DELETE)
        return 0;
    if (!edit->function && !(edit->expression && edit->of))
        return document_fail(
            plan->scene->doc, edit->node, e,
            "an operation needs \"function\", the name of a registered function, or "
            "\"of\" and \"expression\"");
    struct step *s = step_insert(plan, index, e);
    if (!s)
        return -1;
    bool eos = edit->function && strcmp(edit->function, "eos") == 0;
    s->kind = eos ? KIND_EOS : KIND_FUNCTION;
    s->moment = moment;
    /* The scene fills in a default; beside an anchor, the anchor's moment is the better one. */
    if (edit->at && (edit->kind == EDIT_APPEND || json_get(edit->node, "at"))) {
        int k = moment_find(edit->at);
        if (k < 0)
            return document_fail(plan->scene->doc, edit->node, e,
                                 "\"at\" is \"%s\"; it must be start, evaluate or finish",
                                 edit->at);
        s->moment = (enum moment)k;
    }
    s->node = edit->node;
    s->params = edit->params;
    s->shared = old.shared;
    s->to = edit->n_to ? edit->to : old.to;
    s->n_to = edit->n_to ? edit->n_to : old.n_to;
    s->from = edit->n_from ? edit->from : old.from;
    s->n_from = edit->n_from ? edit->n_from : old.n_from;
    s->operation = edit->operation;
    s->of = edit->of;
    s->expression = edit->function ? NULL : edit->expression;
    return plan_name(&s->name, e, "%s", edit->function ? edit->function : edit->of);
}

/* Behind the last step of a name, or before the first; the end if there is none. */
static size_t place_of(const struct plan *plan, const sph_step *declared)
{
    size_t place = plan->n_step;
    for (size_t i = 0; i < plan->n_step; i++) {
        if (declared->after && strcmp(plan->step[i].name, declared->after) == 0)
            place = i + 1;
        else if (declared->after && place == i && plan->step[i].shared)
            place = i + 1; /* behind those that came before with the same wish */
        if (declared->before && strcmp(plan->step[i].name, declared->before) == 0)
            return i;
    }
    return place;
}

/* A boundary condition brings steps of its own, each at the place that it asks for. */
static int recipe_boundary(struct plan *plan, const struct scene_boundary *b, struct error *e)
{
    const struct entry *entry = registry_find(plan->registry, KIND_BOUNDARY, b->name);
    if (!entry)
        return plan_unknown(plan, b->node, KIND_BOUNDARY, b->name, e);
    const sph_list *steps = &entry_boundary(entry)->steps;
    if (!(entry->item->dims & (1u << plan->dim)))
        return document_fail(plan->scene->doc, b->node, e,
                             "the boundary condition \"%s\" does not work in %d dimensions",
                             b->name, plan->dim);
    for (uint32_t i = 0; i < steps->count; i++) {
        const sph_step *declared = list_at(steps, i);
        const bool own = declared->on == SPH_ON_BOUNDARY;
        struct step *s = recipe_step(plan, declared, b->node, place_of(plan, declared), e);
        if (!s)
            return -1;
        s->shared = b->params;
        s->to = own ? b->array : b->with;
        s->n_to = own ? b->n_array : b->n_with;
        s->from = own ? b->with : b->array;
        s->n_from = own ? b->n_with : b->n_array;
    }
    return 0;
}

int recipe_make(struct plan *plan, struct error *e)
{
    if (plan->scheme && recipe_from_scheme(plan, e))
        return -1;
    for (size_t i = 0; i < plan->scene->n_boundary; i++)
        if (recipe_boundary(plan, &plan->scene->boundary[i], e))
            return -1;
    for (size_t i = 0; i < plan->scene->scheme.n_edit; i++)
        if (recipe_edit(plan, &plan->scene->scheme.edit[i], e))
            return -1;
    if (plan->n_step == 0)
        return document_fail(plan->scene->doc, plan->scene->scheme.node, e,
                             "nothing to do: the scheme has no steps");
    return 0;
}

void recipe_free(struct plan *plan)
{
    for (size_t i = 0; i < plan->n_step; i++)
        free(plan->step[i].name);
    free(plan->step);
    plan->step = NULL;
    plan->n_step = 0;
}
