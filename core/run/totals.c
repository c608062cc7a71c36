/* run/totals.c -- conserved quantities, summed in the order of the particles: the same bits for any number of
 * threads. */
#include "run/run.h"
#include <math.h>

static void add_array(const struct plan_array *a, int dim, struct totals *t)
{
    const struct particles *p = &a->p;
    const double *m = p->column[a->mass].data;
    double mv[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < p->n; i++) {
        double x[3] = {0.0, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0}, v2 = 0.0, x2 = 0.0;
        for (int c = 0; c < dim; c++) {
            x[c] = ((double *)p->column[a->position]
                        .data)[(size_t)c * p->column[a->position].plane + i];
            if (a->velocity >= 0)
                v[c] = ((double *)p->column[a->velocity]
                            .data)[(size_t)c * p->column[a->velocity].plane + i];
            v2 += v[c] * v[c];
            x2 += x[c] * x[c];
        }
        t->mass += m[i];
        t->kinetic += 0.5 * m[i] * v2;
        for (int c = 0; c < 3; c++)
            mv[c] += m[i] * v[c];
        for (int c = 0; c < 3; c++)
            t->angular[c] +=
                m[i] * (x[(c + 1) % 3] * v[(c + 2) % 3] - x[(c + 2) % 3] * v[(c + 1) % 3]);
        t->momentum_scale += m[i] * sqrt(v2);
        t->angular_scale += m[i] * sqrt(v2 * x2);
    }
    for (int c = 0; c < 3; c++)
        t->momentum[c] += mv[c];
}

void run_totals(const struct run *r, struct totals *t)
{
    *t = (struct totals){0};
    for (size_t a = 0; a < r->plan->n_array; a++)
        add_array(&r->plan->array[a], r->plan->dim, t);
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        const struct plan_array *a = &r->plan->array[d->array];
        double *sum = d->declared->use == SPH_USE_INTERNAL    ? &t->internal
                      : d->declared->use == SPH_USE_POTENTIAL ? &t->potential
                                                              : NULL;
        if (!sum)
            continue;
        const double *value = a->p.column[d->column].data, *m = a->p.column[a->mass].data;
        for (size_t k = 0; k < a->p.n; k++)
            *sum += m[k] * value[k];
        t->has_energy = true;
    }
}
