/* run/device_totals.c -- conserved quantities of a run on a device: of what is there each array's sums come back,
 * and of several ranks those of all. */
#include "run/device.h"
#include "run/domain.h"

#include <string.h>

static void add_totals(struct totals *t, const struct look_totals *a)
{
    t->mass += a->mass;
    t->kinetic += a->kinetic;
    t->momentum_scale += a->momentum_scale;
    t->angular_scale += a->angular_scale;
    for (int c = 0; c < 3; c++) {
        t->momentum[c] += a->momentum[c];
        t->angular[c] += a->angular[c];
    }
}

static int share_totals(const struct run *r, struct totals *t, struct error *e)
{
    double *const one[] = {&t->mass,      &t->kinetic,        &t->internal,
                           &t->potential, &t->momentum_scale, &t->angular_scale};
    enum { ONES = sizeof(one) / sizeof(one[0]), SUMS = ONES + 6 };
    double sum[SUMS];
    uint32_t op[SUMS];

    for (int k = 0; k < SUMS; k++) {
        sum[k] = k < ONES       ? *one[k]
                 : k < ONES + 3 ? t->momentum[k - ONES]
                                : t->angular[k - ONES - 3];
        op[k] = SPH_REDUCE_SUM;
    }
    if (run_share_numbers(r, sum, op, SUMS, e))
        return -1;
    for (int k = 0; k < ONES; k++)
        *one[k] = sum[k];
    memcpy(t->momentum, sum + ONES, sizeof(t->momentum));
    memcpy(t->angular, sum + ONES + 3, sizeof(t->angular));
    return 0;
}

int run_device_totals(struct run *r, struct totals *t, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        struct arena *arena = &r->device->arena[a];
        struct look_totals here;
        if (arena_put(arena, pa->mass, e) || arena_put(arena, pa->position, e) ||
            (pa->velocity >= 0 && arena_put(arena, pa->velocity, e)) ||
            look_totals(r->device->look, arena, pa->mass, pa->position, pa->velocity, &here, e))
            return -1;
        add_totals(t, &here);
    }
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *q = &r->plan->reduction[i];
        struct arena *arena = &r->device->arena[q->array];
        const int mass = r->plan->array[q->array].mass;
        double *sum = totals_of(t, q->declared->use), here = 0.0;
        if (!sum)
            continue;
        if (arena_put(arena, mass, e) || arena_put(arena, q->column, e) ||
            (arena->n &&
             ops_reduce(r->device->ops, arena, q->column, 0, mass, q->declared->op, &here, e)))
            return -1;
        *sum += here;
        t->has_energy = true;
    }
    return share_totals(r, t, e);
}
