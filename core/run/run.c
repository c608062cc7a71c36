/* run/run.c -- makes and frees a run's working memory. */
#include "run/run.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The value over all arrays that a function's passes reduce; NaN if there is none. */
static double hook_reduction(const struct sph_run *hooks, const char *function, const char *name)
{
    const struct run *r = hooks->context;
    double all = NAN;
    bool first = true;
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        if (strcmp(d->declared->name, name) != 0 ||
            strcmp(r->plan->pass[d->pass].use.item->name, function) != 0)
            continue;
        all = first ? r->reduced[i] : reduction_merge(d->declared->op, all, r->reduced[i]);
        first = false;
    }
    return all;
}

/* A minimum does not depend on who comes first. */
static void hook_propose(const struct sph_run *hooks, double dt)
{
    struct run *r = hooks->context;
#pragma omp critical(propose)
    {
        if (dt < r->proposed)
            r->proposed = dt;
    }
}

int run_init(struct run *r, struct plan *plan, int threads, bool audit, struct error *e)
{
    size_t n = plan->n_array;
    *r = (struct run){.plan = plan, .threads = threads, .skin = plan->scene->neighbours.skin};
    r->time = plan->scene->time.begin;
    r->hooks = (struct sph_run){r, hook_reduction, hook_propose};
    r->proposed = INFINITY;
    r->ghosts = calloc(n, sizeof *r->ghosts);
    r->list = calloc(n * n, sizeof *r->list);
    r->reference = calloc(n, sizeof *r->reference);
    r->reference_n = calloc(n, sizeof *r->reference_n);
    r->stale = calloc(n, sizeof *r->stale);
    r->reduced = calloc(plan->n_reduction + 1, sizeof *r->reduced);
    if (!r->ghosts || !r->list || !r->reference || !r->reference_n || !r->stale || !r->reduced)
        return error_memory(e, "the run", n * n * sizeof *r->list);
    for (size_t i = 0; i < plan->n_reduction; i++)
        r->reduced[i] = NAN;
    for (size_t a = 0; a < n; a++) {
        r->stale[a] = calloc(plan->array[a].p.n_column, sizeof *r->stale[a]);
        if (!r->stale[a])
            return error_memory(e, "the run", plan->array[a].p.n_column);
    }
    return audit ? audit_open(r, e) : 0;
}

void run_free(struct run *r)
{
    size_t n = r->plan ? r->plan->n_array : 0;
    audit_close(r);
    for (size_t a = 0; a < n; a++) {
        if (r->ghosts)
            ghosts_fini(&r->ghosts[a]);
        if (r->reference)
            free(r->reference[a]);
        if (r->stale)
            free(r->stale[a]);
    }
    for (size_t k = 0; r->list && k < n * n; k++)
        group_list_fini(&r->list[k]);
    free(r->ghosts);
    free(r->list);
    free(r->reference);
    free(r->reference_n);
    free(r->stale);
    free(r->reduced);
    *r = (struct run){0};
}
