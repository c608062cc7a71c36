/* plan/fusion.c -- steps that one function does in one sweep: those that a plugin has declared to be its
 * parts, where they follow each other on the same arrays at the same moment. */
#include "plan/inside.h"
#include <string.h>

static bool same_names(const char **a, size_t n, const char **b, size_t m)
{
    if (n != m)
        return false;
    for (size_t i = 0; i < n; i++)
        if (strcmp(a[i], b[i]) != 0)
            return false;
    return true;
}

static bool declares(const sph_item *item, const char *param)
{
    for (uint32_t i = 0; i < item->params.count; i++)
        if (strcmp(((const sph_param *)list_at(&item->params, i))->name, param) == 0)
            return true;
    return false;
}

/* A parameter that one part alone was given must not reach another through the whole. */
static bool own_params(const struct plan *plan, size_t first, size_t n, size_t part)
{
    const cJSON *member;
    cJSON_ArrayForEach(member, plan->step[first + part].params)
    {
        for (size_t k = 0; k < n; k++) {
            const struct entry *x =
                registry_find(plan->registry, KIND_FUNCTION, plan->step[first + k].name);
            if (k != part && x && declares(x->item, member->string))
                return false;
        }
    }
    return true;
}

static bool fits(const struct plan *plan, size_t first, const struct entry *whole)
{
    const struct step *s = &plan->step[first];
    if (whole->n_part > plan->n_step - first)
        return false;
    for (size_t k = 0; k < whole->n_part; k++) {
        const struct step *q = s + k;
        if (q->kind != KIND_FUNCTION || q->expression || q->operation || q->of ||
            strcmp(q->name, whole->part[k]) != 0 || q->moment != s->moment ||
            q->shared != s->shared || !same_names(q->to, q->n_to, s->to, s->n_to) ||
            !same_names(q->from, q->n_from, s->from, s->n_from) ||
            !own_params(plan, first, whole->n_part, k))
            return false;
    }
    return true;
}

size_t fusion_find(const struct plan *plan, size_t first, const struct entry **whole)
{
    size_t most = 0;
    for (size_t i = 0; plan->scene->scheme.fuse && i < plan->registry->n_entry; i++) {
        const struct entry *x = &plan->registry->entry[i];
        if (x->n_part > most && fits(plan, first, x)) {
            *whole = x;
            most = x->n_part;
        }
    }
    return most;
}
