/* plan/closing.c -- which rates need no copy, and which need no copying. An integrator that corrects what it
 * has predicted (y += dt / 2 (r - r0)) needs the rate of the step before beside the new one. Where one
 * pass makes the rate, and nothing later in the evaluation has to do with the property, that pass has
 * both in its hands for every chunk of particles: it closes the step there, and r0 is kept nowhere.
 * Where a copy is kept, columns are traded if the next evaluation overwrites what it gets. */
#include "plan/inside.h"

#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* All that a pass declares of a column, in either role. */
static uint32_t access_of(const struct pass *p, size_t array, int column)
{
    uint32_t access = 0;
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (p->dst.array == array && p->dst.column[k] == column)
            access |= prop->access & (WRITES | SPH_DST_READ);
        for (size_t s = 0; s < p->n_src; s++)
            if (p->src[s].array == array && p->src[s].column[k] == column)
                access |= prop->access & SPH_SRC_READ;
    }
    return access;
}

/* A reduction that is looked at for itself; an energy is summed anew where it is written. */
static bool is_reduced(const struct plan *plan, size_t pass, size_t array, int column)
{
    for (size_t i = 0; i < plan->n_reduction; i++) {
        const struct reduction *d = &plan->reduction[i];
        if (d->pass == pass && d->array == array && d->column == column &&
            d->declared->use != SPH_USE_INTERNAL && d->declared->use != SPH_USE_POTENTIAL)
            return true;
    }
    return false;
}

/* How many passes of an evaluation write the column, and the last of them. */
static size_t writers(const struct plan *plan, size_t array, int column, size_t *last)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->n_pass; i++)
        if (plan->pass[i].moment == MOMENT_EVALUATE &&
            (access_of(&plan->pass[i], array, column) & WRITES)) {
            *last = i;
            n++;
        }
    return n;
}

/* After it lists and ghosts may be made anew in the midst of an evaluation. */
static bool moves(const struct plan *plan, const struct pass *p)
{
    const struct plan_array *a = &plan->array[p->dst.array];
    return pass_writes(p, p->dst.array, a->position) || pass_writes(p, p->dst.array, a->smoothing);
}

/* Extremes of the pass itself are taken before the property is corrected (run/closing.c); a sum is not. */
static bool sums(const struct plan *plan, size_t pass, size_t array, int column)
{
    for (size_t i = 0; i < plan->n_reduction; i++)
        if (plan->reduction[i].pass == pass && plan->reduction[i].declared->op == SPH_REDUCE_SUM &&
            is_reduced(plan, pass, array, column))
            return true;
    return false;
}

/* Sweeps go on reading the first of two floats while others are corrected; so there must be a second, and
 * nobody may look at both later on. */
static size_t closing_pass(const struct plan *plan, size_t array, const struct rate *r)
{
    const struct plan_array *a = &plan->array[array];
    size_t pass = NO_PASS, other;
    if (!integrator_saves_rates(plan->integrator) || r->kind != SPH_KICK ||
        !a->in_two[r->property] || !a->in_floats[r->rate] ||
        writers(plan, array, r->rate, &pass) != 1 || writers(plan, array, r->property, &other) ||
        !plan->pass[pass].local || plan->pass[pass].max_sweeps ||
        sums(plan, pass, array, r->property))
        return NO_PASS;
    for (size_t i = pass; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        if (p->moment != MOMENT_EVALUATE)
            continue;
        if (moves(plan, p) ||
            (i > pass && ((access_of(p, array, r->property) & ~(uint32_t)SPH_SRC_READ) ||
                          is_reduced(plan, i, array, r->property))))
            return NO_PASS;
    }
    return pass;
}

/* The first pass of an evaluation that has to do with the rate sets all of it. */
static bool made_anew(const struct plan *plan, size_t array, int rate)
{
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        const uint32_t access = access_of(p, array, rate);
        if (p->moment != MOMENT_EVALUATE || !access)
            continue;
        return !p->max_sweeps &&
               ((access & (WRITES & ~SPH_DST_WRITE)) ||
                ((access & SPH_DST_WRITE) && !(access & (SPH_DST_READ | SPH_SRC_READ))));
    }
    return false;
}

void closing_find(struct plan *plan)
{
    for (size_t a = 0; a < plan->n_array; a++)
        for (size_t k = 0; k < plan->array[a].n_rate; k++) {
            struct rate *r = &plan->array[a].rate[k];
            r->closed = closing_pass(plan, a, r);
            r->anew = made_anew(plan, a, r->rate);
        }
}
