/* run/run.c -- makes and frees a run's working memory. */
#include "run/device.h"
#include "run/domain.h"
#include "run/watch.h"
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

/* Columns as they are held from here on (plan/precision.c); until now all were in doubles. */
static int hold(struct plan *plan, struct error *e)
{
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        for (size_t c = 0; c < pa->p.n_column; c++)
            if ((pa->in_floats[c] &&
                 particles_hold(&pa->p, (int)c, sizeof(float), pa->in_two[c], e)) ||
                (pa->mirrored[c] && particles_mirror(&pa->p, (int)c, e)))
                return -1;
    }
    return 0;
}

static bool changes_h(const struct plan *plan)
{
    for (size_t a = 0; a < plan->n_array; a++)
        if (plan_changes(plan, a, plan->array[a].smoothing))
            return true;
    return false;
}

static int room_for(struct run *r, struct plan *plan, int threads, uint32_t path, struct error *e)
{
    const size_t n = plan->n_array;
    *r = (struct run){.plan = plan, .threads = threads, .path = path, .skin = plan->skin};
    r->time = plan->scene->time.begin;
    r->h_fixed = !changes_h(plan);
    r->hooks = (struct sph_run){r, hook_reduction, hook_propose};
    r->proposed = INFINITY;
    r->suspect = true;
    r->ghosts = calloc(n + 1, sizeof *r->ghosts);
    r->list = calloc(plan->n_list + 1, sizeof *r->list);
    r->visits = calloc(n + 1, sizeof *r->visits);
    r->kept = calloc(n * plan->n_frame + 1, sizeof *r->kept);
    r->cloud = calloc(n + 1, sizeof *r->cloud);
    r->change = calloc(n + 1, sizeof *r->change);
    r->has_change = calloc(n + 1, sizeof *r->has_change);
    r->frame_made = calloc(plan->n_frame + 1, sizeof *r->frame_made);
    r->frozen = calloc(plan->n_frame + 1, sizeof *r->frozen);
    r->stale = calloc(n + 1, sizeof *r->stale);
    r->mirror_old = calloc(n + 1, sizeof *r->mirror_old);
    r->wide_h = calloc(n + 1, sizeof *r->wide_h);
    r->h_low = calloc(2 * n + 1, sizeof *r->h_low);
    r->h_high = r->h_low + n;
    r->reduced = calloc(plan->n_reduction + 1, sizeof *r->reduced);
    if (!r->ghosts || !r->list || !r->visits || !r->kept || !r->cloud || !r->change ||
        !r->has_change || !r->frame_made || !r->frozen || !r->stale || !r->mirror_old ||
        !r->wide_h || !r->h_low || !r->reduced)
        return error_memory(e, "the run", n * n * sizeof *r->list);
    for (size_t i = 0; i < plan->n_reduction; i++)
        r->reduced[i] = NAN;
    for (size_t a = 0; a < n; a++) {
        const size_t columns = plan->array[a].p.n_column;
        r->stale[a] = calloc(columns + 1, sizeof *r->stale[a]);
        r->mirror_old[a] = malloc((columns + 1) * sizeof *r->mirror_old[a]);
        if (!r->stale[a] || !r->mirror_old[a])
            return error_memory(e, "the run", columns);
        memset(r->mirror_old[a], MIRROR_OLD, columns);
    }
    return 0;
}

/* Loops for vectors that hold several destinations sum over sources in the order of the list; "base" holds several
 * sources, and what it sums first is chance. The plain loop does not. */
static int keep_order(const struct plan *plan, uint32_t *path, struct error *e)
{
    bool in_order = *path != SPH_PATH_BASE, floats = false;
#if defined(__x86_64__)
    in_order = in_order && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    in_order = false;
#endif
    if (!plan->strict || in_order || *path == SPH_PATH_REFERENCE || *path == SPH_PATH_EXTENDED)
        return 0;
    for (size_t i = 0; i < plan->n_pass; i++)
        floats = floats || plan->pass[i].real == SPH_F32;
    if (floats)
        return error_set(e, EXIT_USAGE,
                         "--strict with sums in floats needs a processor with AVX2, or other than "
                         "--path base; take \"precision\": \"double\"");
    *path = SPH_PATH_REFERENCE;
    return 0;
}

int run_init(struct run *r, struct plan *plan, int threads, uint32_t path, bool audit,
             struct error *e)
{
    /* Until there is a domain nobody would hear an alarm. */
    const int status = keep_order(plan, &path, e) || room_for(r, plan, threads, path, e) ? -1 : 0;
    if (run_domain_agree(r, status, e))
        return -1;
    if (run_domain_open(r, e) || hold(plan, e) || watch_open(r, e))
        return -1;
    if (run_check(plan, path, audit, e) || (plan->on_device && run_device_open(r, e)))
        return -1;
    return audit ? audit_open(r, e) : 0;
}

int run_fetch(struct run *r, struct error *e)
{
    return r->device ? run_device_fetch(r, e) : 0;
}

int run_look(struct run *r, struct error *e)
{
    return run_settle(r, e) || run_fetch(r, e) ? -1 : 0;
}

void run_free(struct run *r)
{
    size_t n = r->plan ? r->plan->n_array : 0;
    audit_close(r);
    watch_close(r);
    run_device_close(r);
    run_domain_close(r);
    for (size_t a = 0; a < n; a++) {
        if (r->ghosts)
            ghosts_fini(&r->ghosts[a]);
        if (r->visits)
            visits_fini(&r->visits[a]);
        if (r->stale)
            free(r->stale[a]);
        if (r->mirror_old)
            free(r->mirror_old[a]);
        if (r->wide_h)
            free(r->wide_h[a]);
    }
    for (size_t k = 0; r->kept && k < n * r->plan->n_frame; k++)
        skin_fini(&r->kept[k]);
    for (size_t k = 0; r->list && k < r->plan->n_list; k++)
        group_list_fini(&r->list[k]);
    free(r->ghosts);
    free(r->list);
    free(r->visits);
    free(r->kept);
    free(r->cloud);
    free(r->change);
    free(r->has_change);
    free(r->frame_made);
    free(r->frozen);
    free(r->stale);
    free(r->mirror_old);
    free(r->wide_h);
    free(r->h_low);
    free(r->reduced);
    *r = (struct run){0};
}
