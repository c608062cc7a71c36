/* plan/initial.c -- plan_fill: the particles of every array and what the scene leaves unsaid of their first
 * state: the inverse equation of state, declared defaults. */
#include "plan/inside.h"
#include "scene/fill.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does the scene give a column that the equation of state writes (p) but not the one that its inverse
 * finds (u)? */
static bool wants_inverse(const struct plan_array *a, const sph_eos *eos)
{
    bool given = false, missing = false;
    for (uint32_t k = 0; k < eos->inverse_props.count; k++) {
        const sph_prop *prop = list_at(&eos->inverse_props, k);
        int c = particles_find(&a->p, prop->name);
        if (c < 0)
            continue;
        if (prop->access & SPH_DST_WRITE)
            missing = missing || !a->given[c];
        else
            for (uint32_t i = 0; i < eos->item->props.count; i++) {
                const sph_prop *out = list_at(&eos->item->props, i);
                given = given || ((out->access & SPH_DST_WRITE) && a->given[c] &&
                                  strcmp(out->name, prop->name) == 0);
            }
    }
    return given && missing;
}

static int run_inverse(struct plan *plan, struct plan_array *a, struct error *e)
{
    const sph_eos *eos = entry_eos(a->eos.entry);
    uint32_t n = eos->inverse_props.count;
    sph_column *column = calloc(n ? n : 1, sizeof *column);
    if (!column)
        return error_memory(e, "columns", n);
    int status = 0;
    for (uint32_t k = 0; !status && k < n; k++) {
        const sph_prop *prop = list_at(&eos->inverse_props, k);
        int c = particles_find(&a->p, prop->name);
        if (c < 0 || (!(prop->access & SPH_DST_WRITE) && !a->given[c]))
            status = document_fail(
                plan->scene->doc, a->scene->node, e,
                "to find the state of \"%s\" from its equation of state, \"fields\" must "
                "give \"%s\" too",
                a->p.name, prop->name);
        else
            column[k] = particles_column(&a->p, c);
        if (!status && (prop->access & SPH_DST_WRITE))
            a->given[c] = true;
    }
    if (!status) {
        sph_batch b = use_batch(plan, &a->eos, column, n, a->p.n);
        sph_status s = eos->inverse(&b);
        char why[512];
        if (s != SPH_OK) {
            registry_reason(plan->registry, s, why, sizeof why);
            status = error_set(e, EXIT_USAGE, "initial state of \"%s\": %s", a->p.name, why);
        }
    }
    free(column);
    return status;
}

static int complete(struct plan *plan, struct plan_array *a, struct error *e)
{
    if (a->eos.item && entry_eos(a->eos.entry)->inverse &&
        wants_inverse(a, entry_eos(a->eos.entry)) && run_inverse(plan, a, e))
        return -1;
    for (size_t c = 0; c < a->p.n_column; c++) {
        bool own =
            (int)c == a->position || (int)c == a->smoothing || (int)c == a->mass || (int)c == a->id;
        if (!a->required[c] || a->given[c] || own)
            continue;
        const struct column *column = &a->p.column[c];
        if (isnan(a->initial[c]))
            return document_fail(plan->scene->doc, a->scene->node, e,
                                 "nothing gives the initial \"%s\" (%s): add it to \"fields\"",
                                 column->name, column->doc);
        if (column->type == SPH_INT32 || column->type == SPH_INT64)
            continue; /* zero */
        for (uint32_t k = 0; k < column->ncomp; k++)
            for (size_t i = 0; i < a->p.n; i++)
                ((double *)column->data)[k * column->plane + i] = a->initial[c];
    }
    return 0;
}

int plan_fill(struct plan *plan, struct error *e)
{
    struct particles *all = calloc(plan->n_array ? plan->n_array : 1, sizeof *all);
    if (!all)
        return error_memory(e, "arrays", plan->n_array * sizeof *all);
    int status = 0;
    uint64_t total = 0;
    for (size_t a = 0; !status && a < plan->n_array; a++) {
        status =
            fill_array(&plan->array[a].p, plan->scene, a, &plan->next_id, plan->array[a].given, e);
        total += plan->array[a].p.n;
        all[a] = plan->array[a].p;
    }
    if (!status)
        status = fill_check_overlap(all, plan->n_array, plan->scene, e);
    free(all);
    if (!status && total == 0)
        return document_fail(plan->scene->doc, NULL, e, "the scene has no particles");
    for (size_t a = 0; !status && a < plan->n_array; a++)
        status = complete(plan, &plan->array[a], e);
    return status;
}
