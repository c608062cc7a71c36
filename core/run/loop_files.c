/* run/loop_files.c -- what the loop writes on its way: rows of log.csv, snapshots. */
#include "base/text.h"
#include "config.h"
#include "io/snapshot.h"
#include "run/domain.h"
#include "run/loop_state.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Arrays share a function, and with it the names of its reductions: one column of the log for all. */
static void merge(const sph_reduction *d, double value, const char **name, double *all, size_t *n)
{
    size_t k = 0;
    while (k < *n && strcmp(name[k], d->name) != 0)
        k++;
    if (k == *n) {
        name[k] = d->name;
        all[(*n)++] = value;
    } else {
        all[k] = reduction_merge(d->op, all[k], value);
    }
}

int loop_log(struct loop *l, struct error *e)
{
    const struct run *r = &l->run;
    size_t n = r->plan->n_reduction;
    if (!run_speaks(r))
        return 0;
    const char **name = calloc(n + 1, sizeof *name);
    double *value = calloc(n + 1, sizeof *value);
    if (!name || !value) {
        free(name);
        free(value);
        return error_memory(e, "a row of the log", n * sizeof *value);
    }
    size_t used = 0;
    for (size_t i = 0; i < n; i++)
        if (r->plan->reduction[i].declared->use == SPH_USE_NONE)
            merge(r->plan->reduction[i].declared, r->reduced[i], name, value, &used);
    const struct totals *t = &l->last;
    struct log_row row = {.step = r->step,
                          .time = r->time,
                          .dt = r->dt,
                          .kinetic = t->kinetic,
                          .internal = t->internal,
                          .potential = t->potential,
                          .mass = t->mass,
                          .extra_name = name,
                          .extra = value,
                          .n_extra = used,
                          .wall = omp_get_wtime() - l->started};
    memcpy(row.momentum, t->momentum, sizeof row.momentum);
    memcpy(row.angular, t->angular, sizeof row.angular);
    int status = log_write(&l->log, &row, e);
    free(name);
    free(value);
    return status;
}

int loop_snapshot(struct loop *l, struct error *e)
{
    double t = omp_get_wtime();
    const struct plan *plan = l->run.plan;
    char name[64];
    snprintf(name, sizeof name, "snapshot_%04llu.vtkhdf", (unsigned long long)l->snapshots);
    struct particles *all = calloc(plan->n_array, sizeof *all);
    char *temporary = run_speaks(&l->run) ? output_begin(l->out, name) : strdup("");
    int status = all && temporary ? 0 : error_memory(e, "a snapshot", plan->n_array * sizeof *all);
    if (!status)
        status = run_look(&l->run, e);
    if (!status && l->run.domain)
        status = run_domain_collect(&l->run, all, e);
    if (!status && run_speaks(&l->run)) {
        for (size_t a = 0; !l->run.domain && a < plan->n_array; a++)
            all[a] = plan->array[a].p;
        struct snapshot_meta meta = {.scene_path = l->options->scene_path,
                                     .scene_text = l->scene_text,
                                     .title = l->scene->title,
                                     .units = l->scene->units,
                                     .version = PACKAGE_VERSION,
                                     .time = l->run.time,
                                     .step = l->run.step};
        status = snapshot_write(temporary, all, plan->n_array, &meta, e);
        if (!status)
            status = output_commit(l->out, temporary, name, e);
    }
    l->snapshots += !status;
    if (all && l->run.domain)
        run_domain_scatter(&l->run, all);
    free(all);
    free(temporary);
    l->run.cost.io += omp_get_wtime() - t;
    return status;
}
