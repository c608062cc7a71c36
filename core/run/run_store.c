/* run/run_store.c -- a run's working state goes into a checkpoint and comes back with every bit: particles and
 * ghosts, lists and what they were made from, what the integrator has left to do, plugins' own states. Nothing
 * is settled or made anew for it, since that would change the run. */
#include "run/device.h"
#include "run/run_store.h"
#include "run/watch.h"
#include <stdlib.h>
#include <string.h>

/* -- Numbers ------------------------------------------------------------------------------------ */

static int numbers_store(struct run *r, struct store *s, struct error *e)
{
    const struct {
        const char *name;
        double *value;
    } real[] = {{"time", &r->time},
                {"dt", &r->dt},
                {"dt_bound", &r->dt_bound},
                {"proposed", &r->proposed},
                {"left_dt", &r->left_dt},
                {"dt_last", &r->dt_last},
                {"quantum", &r->quantum},
                {"loop_s", &r->cost.loop},
                {"neighbour_s", &r->cost.neighbour},
                {"integrate_s", &r->cost.integrate},
                {"io_s", &r->cost.io}};
    const struct {
        const char *name;
        uint64_t *value;
    } whole[] = {{"step", &r->step},
                 {"builds_since_sort", &r->builds_since_sort},
                 {"particle_updates", &r->cost.particle_updates},
                 {"pairs", &r->cost.pairs},
                 {"list_builds", &r->cost.list_builds},
                 {"sorts", &r->cost.sorts},
                 {"unfinished", &r->cost.unfinished},
                 {"created", &r->cost.created}};
    const struct {
        const char *name;
        bool *value;
    } flag[] = {{"lists_made", &r->lists_made},
                {"lists_suspect", &r->lists_suspect},
                {"suspect", &r->suspect},
                {"look", &r->look}};
    for (size_t k = 0; k < sizeof real / sizeof real[0]; k++)
        if (store_f64(s, real[k].name, real[k].value, e))
            return -1;
    for (size_t k = 0; k < sizeof whole / sizeof whole[0]; k++)
        if (store_u64(s, whole[k].name, whole[k].value, e))
            return -1;
    for (size_t k = 0; k < sizeof flag / sizeof flag[0]; k++)
        if (store_flags(s, flag[k].name, flag[k].value, 1, e))
            return -1;
    if (store_block(s, "centre", STORE_F64, r->centre, 3, e) ||
        store_count(s, "left", &r->left, e) ||
        store_block(s, "next_id", STORE_I64, &r->plan->next_id, 1, e))
        return -1;
    if (store_block(s, "adapted", STORE_U8, r->adapted, sizeof r->adapted, e))
        return -1;
    if (s->reading) /* what is left goes by the table of its step */
        r->op = r->plan->integrator->adapt ? r->adapted : r->plan->integrator->op;
    if (r->left > r->plan->integrator->n_op)
        return store_broken(s, e, "more operations are left than the integrator has");
    return 0;
}

static int tables_store(struct run *r, struct store *s, struct error *e)
{
    const struct plan *plan = r->plan;
    const size_t n = plan->n_array;
    double *change = calloc(2 * n + 1, sizeof *change);
    if (!change)
        return error_memory(e, "a checkpoint", n * sizeof *change);
    for (size_t a = 0; a < n; a++) {
        change[2 * a] = r->change[a].moved;
        change[2 * a + 1] = r->change[a].room;
    }
    int status = store_block(s, "change", STORE_F64, change, 2 * n, e) ||
                         store_flags(s, "has_change", r->has_change, n, e) ||
                         store_flags(s, "frame_made", r->frame_made, plan->n_frame, e) ||
                         store_flags(s, "frozen", r->frozen, plan->n_frame, e) ||
                         store_block(s, "h_range", STORE_F64, r->h_low, 2 * n, e) ||
                         store_block(s, "reduced", STORE_F64, r->reduced, plan->n_reduction, e)
                     ? -1
                     : 0;
    for (size_t a = 0; !status && a < n; a++)
        r->change[a] = (struct skin_change){change[2 * a], change[2 * a + 1]};
    free(change);
    return status;
}

/* What passes have cost so far, so that a summary tells of the whole run. */
static int costs_store(struct run *r, struct store *s, struct error *e)
{
    const size_t n = r->plan->n_pass;
    int status = 0;
    for (size_t i = 0; !status && i < n; i++) {
        struct pass *p = &r->plan->pass[i];
        store_enter(s, "pass", i);
        status = store_f64(s, "seconds", &p->seconds, e) || store_u64(s, "sweeps", &p->sweeps, e) ||
                         store_u64(s, "pairs", &p->pairs, e)
                     ? -1
                     : 0;
        store_leave(s);
    }
    return status;
}

int run_store_numbers(struct run *r, struct store *s, struct error *e)
{
    return numbers_store(r, s, e) || tables_store(r, s, e) || costs_store(r, s, e) ? -1 : 0;
}

/* -- Particles, lists --------------------------------------------------------------------------- */

static int arrays_store(struct run *r, struct store *s, struct error *e)
{
    int status = 0;
    for (size_t a = 0; !status && a < r->plan->n_array; a++) {
        struct particles *p = &r->plan->array[a].p;
        store_enter(s, "array", a);
        status = particles_store(p, s, e);
        /* Those of lists that are no longer in use tell of particles that may have gone. */
        if (!status)
            status = ghosts_store(&r->ghosts[a], s, r->lists_made ? p->n : SIZE_MAX, e);
        if (!status)
            status = store_flags(s, "stale", r->stale[a], p->n_column, e);
        if (!status && s->reading && r->lists_made && r->ghosts[a].n != p->n_ghost)
            status = store_broken(s, e, "ghosts and what they copy differ in number");
        store_leave(s);
    }
    return status;
}

static int lists_store(struct run *r, struct store *s, struct error *e)
{
    const struct plan *plan = r->plan;
    int status = 0;
    for (size_t k = 0; !status && k < plan->n_list; k++) {
        const struct plan_list *l = &plan->list[k];
        const struct particles *dst = &plan->array[l->dst].p, *src = &plan->array[l->src].p;
        const bool used = r->lists_made && l->frame == 0;
        store_enter(s, "list", k);
        status =
            group_list_store(&r->list[k], s, used ? dst->n : SIZE_MAX, src->n + src->n_ghost, e);
        store_leave(s);
    }
    for (size_t k = 0; !status && k < plan->n_array * plan->n_frame; k++) {
        store_enter(s, "kept", k);
        status = skin_store(&r->kept[k], s, e);
        store_leave(s);
    }
    return status;
}

/* -- Plugins' own states ------------------------------------------------------------------------ */

/* needed: else a state that is not there stays as it was created. */
static int use_store(struct run *r, struct use *u, bool needed, struct store *s, struct error *e)
{
    struct use_state state = {0};
    size_t n;
    uint32_t format;
    if (!use_has_state(u) || (s->reading && !needed && !store_has(s, "state")))
        return 0;
    if (!s->reading && use_save(u, r->plan->registry, &state, e))
        return -1;
    n = (size_t)state.n;
    format = state.format;
    int status = store_block(s, "format", STORE_U32, &format, 1, e) ||
                         store_array(s, "state", STORE_U8, &state.bytes, &n, 0, e)
                     ? -1
                     : 0;
    state.n = n;
    state.format = format;
    if (!status && s->reading)
        status = use_restore(u, r->plan->registry, &state, e);
    free(state.bytes);
    return status;
}

/* A scene may compare with others than before. */
static int exact_store(struct run *r, struct use *u, const char *group, size_t i, struct store *s,
                       struct error *e)
{
    store_enter(s, group, i);
    char *name = s->reading || !u->item ? NULL : strdup(u->item->name);
    int status = store_text(s, "name", &name, e);
    if (!status && name && u->item && strcmp(name, u->item->name) == 0)
        status = use_store(r, u, false, s, e);
    free(name);
    store_leave(s);
    return status;
}

int run_store_states(struct run *r, struct store *s, struct error *e)
{
    struct plan *plan = r->plan;
    int status = 0;
    for (size_t i = 0; !status && i < plan->n_pass; i++) {
        store_enter(s, "pass_use", i);
        status = use_store(r, &plan->pass[i].use, true, s, e);
        store_leave(s);
    }
    for (size_t a = 0; !status && a < plan->n_array; a++) {
        store_enter(s, "eos_use", a);
        status = use_store(r, &plan->array[a].eos, true, s, e);
        store_leave(s);
    }
    for (size_t i = 0; !status && i < plan->scene->n_compare; i++)
        status = exact_store(r, &plan->exact[i], "exact_use", i, s, e);
    for (size_t i = 0; !status && i < plan->scene->n_profile; i++)
        status = exact_store(r, &plan->profile_exact[i], "profile_use", i, s, e);
    return status;
}

int run_store(struct run *r, struct store *s, struct error *e)
{
    if (r->device && !s->reading)
        run_device_costs(r);
    return run_store_numbers(r, s, e) || arrays_store(r, s, e) ||
                   (r->device ? run_device_store : lists_store)(r, s, e) || watch_store(r, s, e) ||
                   run_store_states(r, s, e)
               ? -1
               : 0;
}

int run_store_failed(struct run *r, struct store *s, struct error *e)
{
    if (r->device && !s->reading)
        run_device_costs(r);
    int status = run_store_numbers(r, s, e) || (r->watch && watch_store(r, s, e)) ? -1 : 0;
    for (size_t a = 0; !status && a < r->plan->n_array; a++) {
        store_enter(s, "array", a);
        status = particles_store(&r->plan->array[a].p, s, e);
        store_leave(s);
    }
    return status;
}
