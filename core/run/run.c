/* run/run.c -- makes and frees a run's working memory. */
#include "run/run.h"
#include <stdlib.h>

int run_init(struct run *r, struct plan *plan, int threads, bool audit, struct error *e)
{
    size_t n = plan->n_array;
    *r = (struct run){.plan = plan, .threads = threads, .skin = plan->scene->neighbours.skin};
    r->time = plan->scene->time.begin;
    r->ghosts = calloc(n, sizeof *r->ghosts);
    r->list = calloc(n * n, sizeof *r->list);
    r->reference = calloc(n, sizeof *r->reference);
    r->reference_n = calloc(n, sizeof *r->reference_n);
    r->stale = calloc(n, sizeof *r->stale);
    r->reduced = calloc(plan->n_reduction + 1, sizeof *r->reduced);
    if (!r->ghosts || !r->list || !r->reference || !r->reference_n || !r->stale || !r->reduced)
        return error_memory(e, "the run", n * n * sizeof *r->list);
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
