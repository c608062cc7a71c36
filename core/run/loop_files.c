/* run/loop_files.c -- what the loop writes on its way: rows of log.csv, snapshots. */
#include "base/text.h"
#include "config.h"
#include "io/snapshot.h"
#include "run/domain.h"
#include "run/loop_state.h"
#include "run/shared_file.h"
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

/* All ranks into one file, a partition each. */
static int write_together(struct run *r, const char *path, const struct snapshot_meta *meta,
                          struct error *e)
{
    const size_t n = r->plan->n_array, ranks = (size_t)wire_size(r->domain->wire);
    struct particles *own = calloc(n + 1, sizeof *own);
    uint64_t *count = calloc(n + ranks + 1, sizeof *count);
    struct snapshot_parts parts = {ranks, (size_t)wire_rank(r->domain->wire), count, count + ranks};
    uint64_t mine = 0;
    int status =
        run_domain_agree(r, own && count ? 0 : error_memory(e, "a snapshot", n * sizeof *own), e);
    for (size_t a = 0; !status && a < n; a++) {
        own[a] = r->plan->array[a].p;
        mine += count[ranks + a] = own[a].n;
    }
    if (!status)
        status = wire_sum(r->domain->wire, count + ranks, n, e) ||
                         wire_gather(r->domain->wire, &mine, sizeof mine, count, e)
                     ? -1
                     : 0;
    if (!status && run_speaks(r))
        status = snapshot_prepare(path, own, n, &parts, meta, e);
    if (!run_domain_agree(r, status, e))
        status = snapshot_fill(path, own, n, &parts, e);
    else
        status = -1;
    free(own);
    free(count);
    return status;
}

/* Rank 0 alone, of all ranks' particles. */
static int write_gathered(struct run *r, const char *path, const struct snapshot_meta *meta,
                          struct error *e)
{
    const size_t n = r->plan->n_array;
    struct particles *all = calloc(n + 1, sizeof *all);
    int status = run_domain_agree(r, all ? 0 : error_memory(e, "a snapshot", n * sizeof *all), e);
    if (!status)
        status = run_domain_collect(r, all, e);
    if (!status && run_speaks(r))
        status = snapshot_write(path, all, n, meta, e);
    if (all)
        run_domain_scatter(r, all);
    free(all);
    return status;
}

static int write_own(const struct run *r, const char *path, const struct snapshot_meta *meta,
                     struct error *e)
{
    const size_t n = r->plan->n_array;
    struct particles *own = calloc(n + 1, sizeof *own);
    if (!own)
        return error_memory(e, "a snapshot", n * sizeof *own);
    for (size_t a = 0; a < n; a++)
        own[a] = r->plan->array[a].p;
    const int status = snapshot_write(path, own, n, meta, e);
    free(own);
    return status;
}

int loop_snapshot(struct loop *l, struct error *e)
{
    const double begin = omp_get_wtime();
    struct run *r = &l->run;
    char name[64], *temporary;
    snprintf(name, sizeof name, "snapshot_%04llu.vtkhdf", (unsigned long long)l->snapshots);
    if (run_look(r, e) || shared_file_begin(r, l->out, name, &temporary, e))
        return -1;
    const struct snapshot_meta meta = {.scene_path = l->options->scene_path,
                                       .scene_text = l->scene_text,
                                       .title = l->scene->title,
                                       .units = l->scene->units,
                                       .version = PACKAGE_VERSION,
                                       .time = r->time,
                                       .step = r->step};
    int status = !r->domain            ? write_own(r, temporary, &meta, e)
                 : snapshot_can_fill() ? write_together(r, temporary, &meta, e)
                                       : write_gathered(r, temporary, &meta, e);
    status = shared_file_end(r, l->out, temporary, name, status, e);
    l->snapshots += !status;
    r->cost.io += omp_get_wtime() - begin;
    return status;
}
