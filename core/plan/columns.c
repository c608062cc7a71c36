/* plan/columns.c -- the arrays' columns: those that every scene has, the user's own, and what the passes
 * and the integrator make of them (state, rates, initial values). */
#include "base/text.h"
#include "plan/inside.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The columns that the core itself works on. */
static int add_basic(struct plan_array *a, struct error *e)
{
    struct particles *p = &a->p;
    a->position = particles_add(p, "x", "m", "position", SPH_VECTOR, e);
    a->smoothing = particles_add(p, "h", "m", "smoothing length", SPH_SCALAR, e);
    a->mass = particles_add(p, "m", "kg", "mass", SPH_SCALAR, e);
    a->id = particles_add(p, "id", "", "number of the particle, for life", SPH_INT64, e);
    a->velocity = -1;
    if (a->position < 0 || a->smoothing < 0 || a->mass < 0 || a->id < 0)
        return -1;
    for (size_t c = 0; c < p->n_column; c++)
        p->column[c].state = p->column[c].output = true;
    return 0;
}

int columns_begin(struct plan *plan, bool guarded, struct error *e)
{
    const struct scene *s = plan->scene;
    plan->array = calloc(s->n_array ? s->n_array : 1, sizeof *plan->array);
    if (!plan->array)
        return error_memory(e, "particle arrays", s->n_array * sizeof *plan->array);
    plan->n_array = s->n_array;
    for (size_t i = 0; i < s->n_array; i++) {
        struct plan_array *a = &plan->array[i];
        a->scene = &s->array[i];
        if (particles_init(&a->p, s->array[i].name, plan->dim, e))
            return -1;
        a->p.guarded = guarded;
        if (add_basic(a, e))
            return -1;
        for (size_t k = 0; k < s->array[i].n_column; k++) {
            const struct scene_column *own = &s->array[i].column[k];
            int c = particles_add(&a->p, own->name, "", "the scene's own", own->type, e);
            if (c < 0)
                return document_fail(s->doc, own->node, e, "%s", e->text);
            a->p.column[c].state = a->p.column[c].output = true;
        }
    }
    return 0;
}

/* Whether anything needs the column's value before the passes of a step have made it. */
static void mark_required(struct plan *plan, const struct pass *p, bool **written)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        struct plan_array *dst = &plan->array[p->dst.array];
        int c = p->dst.column[k];
        if ((prop->access & SPH_DST_READ) && !written[p->dst.array][c]) {
            dst->required[c] = true;
            if (isinf(dst->initial[c]))
                dst->initial[c] = prop->start;
        }
        for (size_t s = 0; s < p->n_src; s++) {
            struct plan_array *src = &plan->array[p->src[s].array];
            int cs = p->src[s].column[k];
            if ((prop->access & SPH_SRC_READ) && !written[p->src[s].array][cs]) {
                src->required[cs] = true;
                if (isinf(src->initial[cs]))
                    src->initial[cs] = prop->start;
            }
        }
    }
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (prop->access & (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN))
            written[p->dst.array][p->dst.column[k]] = true;
    }
}

static int find_required(struct plan *plan, struct error *e)
{
    bool **written = calloc(plan->n_array, sizeof *written);
    if (!written)
        return error_memory(e, "the plan", plan->n_array);
    int status = 0;
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        size_t n = pa->p.n_column;
        written[a] = calloc(n, 1);
        pa->required = calloc(n, sizeof *pa->required);
        pa->given = calloc(n, sizeof *pa->given);
        pa->initial = malloc(n * sizeof *pa->initial);
        if (!written[a] || !pa->required || !pa->given || !pa->initial)
            status = error_memory(e, "the plan", n);
        for (size_t c = 0; pa->initial && c < n; c++)
            pa->initial[c] = INFINITY; /* nobody has said */
    }
    for (int moment = MOMENT_START; !status && moment < MOMENT_COUNT; moment++)
        for (size_t i = 0; i < plan->n_pass; i++)
            if (plan->pass[i].moment == (enum moment)moment)
                mark_required(plan, &plan->pass[i], written);
    for (size_t a = 0; a < plan->n_array; a++)
        free(written[a]);
    free(written);
    return status;
}

static int add_rate(struct plan *plan, struct plan_array *a, const sph_rate *declared,
                    struct error *e)
{
    int y = particles_find(&a->p, declared->property);
    int r = particles_find(&a->p, declared->rate);
    if (y < 0 || r < 0)
        return 0; /* an array that no function gives this rate does not move by it */
    const struct column *cy = &a->p.column[y], *cr = &a->p.column[r];
    if (cy->type != cr->type || cy->size != sizeof(double))
        return error_set(e, EXIT_REFUSED, "scheme \"%s\": %s cannot be the rate of %s: other type",
                         plan->scheme_name ? plan->scheme_name : "none", declared->rate,
                         declared->property);
    for (size_t i = 0; i < a->n_rate; i++)
        if (a->rate[i].property == y) {
            if (a->rate[i].rate == r)
                return 0;
            return error_set(e, EXIT_USAGE, "array \"%s\": %s has two rates, %s and %s", a->p.name,
                             declared->property, a->p.column[a->rate[i].rate].name, declared->rate);
        }
    struct rate *bigger = plan_grow(a->rate, &a->n_rate, sizeof *bigger);
    if (!bigger)
        return error_memory(e, "rates", sizeof *bigger);
    a->rate = bigger;
    a->rate[a->n_rate - 1] = (struct rate){y, r, declared->kind, -1, {y, -1, -1}, NO_PASS, false};
    if (y == a->position)
        a->velocity = r;
    return 0;
}

/* A rate that no array has would be forgotten in silence: all would stand still. `of` declares it. */
static int check_rates(const struct plan *plan, const char *of, const sph_list *rates,
                       struct error *e)
{
    for (uint32_t i = 0; i < rates->count; i++) {
        const sph_rate *declared = list_at(rates, i);
        const char *missing = declared->property;
        bool found = false;
        for (size_t a = 0; a < plan->n_array && !found; a++) {
            const struct particles *p = &plan->array[a].p;
            found = particles_find(p, declared->property) >= 0;
            if (found && particles_find(p, declared->rate) < 0) {
                missing = declared->rate;
                found = false;
            }
        }
        if (!found)
            return document_fail(plan->scene->doc, plan->scene->scheme.node, e,
                                 "%s advances \"%s\" with \"%s\", but no function of the recipe "
                                 "declares the property \"%s\"",
                                 of, declared->property, declared->rate, missing);
    }
    return 0;
}

static int add_rates(struct plan *plan, const sph_list *rates, size_t array, struct error *e)
{
    for (uint32_t i = 0; i < rates->count; i++)
        if (add_rate(plan, &plan->array[array], list_at(rates, i), e))
            return -1;
    return 0;
}

/* Without a scheme nobody says what moves the position: where a function advances the velocity, that does. */
static int add_motion(struct plan *plan, struct error *e)
{
    const sph_rate motion = SPH_RATE("x", "v", SPH_DRIFT);
    for (size_t i = 0; i < plan->n_array; i++) {
        struct plan_array *a = &plan->array[i];
        bool kicked = false;
        for (size_t k = 0; k < a->n_rate; k++)
            kicked = kicked || strcmp(a->p.column[a->rate[k].property].name, motion.rate) == 0;
        if (kicked && a->velocity < 0 && add_rate(plan, a, &motion, e))
            return -1;
    }
    return 0;
}

/* "a.0", "a.1": what the integrator keeps of a column, held as that is; its index, or -1. */
static int add_saved(struct plan_array *a, int column, enum slot slot, struct error *e)
{
    const struct column *of = &a->p.column[column];
    char *name = text_format("%s.%d", of->name, (int)slot - SLOT_0);
    if (!name)
        return error_memory(e, "a column", 1);
    int c = particles_add(&a->p, name, of->unit, "kept by the integrator", of->type, e);
    free(name);
    if (c < 0)
        return -1;
    a->p.column[c].state = true;
    a->in_floats[c] = a->in_floats[column];
    a->in_two[c] = a->in_two[column];
    return c;
}

static int add_integrator_columns(struct plan *plan, struct error *e)
{
    for (size_t i = 0; i < plan->n_array; i++) {
        struct plan_array *a = &plan->array[i];
        for (size_t k = 0; k < a->n_rate; k++) {
            struct rate *r = &a->rate[k];
            /* A rate outlives its evaluation (it starts the next step), so a sort must carry it. */
            a->p.column[r->rate].state = a->p.column[r->property].state = true;
            for (enum slot s = SLOT_0; s < SLOT_COUNT; s++)
                if (integrator_keeps(plan->integrator, r->kind, s) &&
                    (r->kept[s] = add_saved(a, r->property, s, e)) < 0)
                    return -1;
            if (integrator_saves_rates(plan->integrator) && r->kind == SPH_KICK &&
                r->closed == NO_PASS && (r->saved = add_saved(a, r->rate, SLOT_0, e)) < 0)
                return -1;
        }
    }
    return 0;
}

/* Rates add up over an evaluation: only the first pass that sums one starts it, unless an earlier one
 * has set it. An iterating pass starts anew, or its sweeps would add up too. */
static int find_continued(struct plan *plan, size_t pass, struct error *e)
{
    struct pass *p = &plan->pass[pass];
    const struct plan_array *a = &plan->array[p->dst.array];
    p->continues = calloc(p->use.item->props.count + 1, sizeof *p->continues);
    if (!p->continues)
        return error_memory(e, "the plan", p->use.item->props.count);
    for (uint32_t k = 0; !p->max_sweeps && k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        bool rate = false;
        for (size_t r = 0; r < a->n_rate; r++)
            rate = rate || a->rate[r].rate == p->dst.column[k];
        for (size_t i = 0; rate && (prop->access & SPH_DST_SUM) && i < pass; i++)
            if (plan->pass[i].moment == p->moment && plan->pass[i].dst.array == p->dst.array &&
                pass_writes(&plan->pass[i], p->dst.array, p->dst.column[k]))
                p->continues[k] = true;
    }
    return 0;
}

static void hide_work(struct plan *plan, const struct pass *p)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (prop->access & SPH_WORK)
            plan->array[p->dst.array].p.column[p->dst.column[k]].output = false;
    }
}

int columns_finish(struct plan *plan, struct error *e)
{
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        /* What no evaluation makes anew must outlive the sorts. */
        for (uint32_t k = 0; p->moment != MOMENT_EVALUATE && k < p->use.item->props.count; k++)
            if (pass_writes(p, p->dst.array, p->dst.column[k]))
                plan->array[p->dst.array].p.column[p->dst.column[k]].state = true;
        if (p->function && (check_rates(plan, p->name, &p->function->rates, e) ||
                            add_rates(plan, &p->function->rates, p->dst.array, e)))
            return -1;
    }
    /* An edit may take out on purpose what a rate of the scheme is about. */
    if (plan->scheme && plan->scene->scheme.n_edit == 0 &&
        check_rates(plan, plan->scheme_name, &plan->scheme->rates, e))
        return -1;
    for (size_t a = 0; plan->scheme && a < plan->n_array; a++)
        if (add_rates(plan, &plan->scheme->rates, a, e))
            return -1;
    if (!plan->scheme && add_motion(plan, e))
        return -1;
    for (size_t i = 0; i < plan->n_pass; i++)
        if (find_continued(plan, i, e))
            return -1;
    if (backend_decide(plan, e) || precision_decide(plan, e))
        return -1;
    closing_find(plan);
    if (add_integrator_columns(plan, e) || find_required(plan, e))
        return -1;
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        for (size_t k = 0; k < pa->n_rate; k++)
            pa->required[pa->rate[k].property] = true;
        for (size_t c = 0; c < pa->p.n_column; c++) {
            pa->p.column[c].state |= pa->required[c];
            if (isinf(pa->initial[c]))
                pa->initial[c] = 0.0;
            pa->p.column[c].output = !strchr(pa->p.column[c].name, '.');
        }
    }
    for (size_t i = 0; i < plan->n_pass; i++)
        hide_work(plan, &plan->pass[i]);
    return 0;
}
