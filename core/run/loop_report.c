/* run/loop_report.c -- what the loop tells at the end: the picture, summary.json, the table. */
#include "base/text.h"
#include "io/render.h"
#include "io/snapshot.h"
#include "io/summary.h"
#include "run/device.h"
#include "run/loop_state.h"
#include "run/watch.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* Particles of an array, on all ranks. */
static uint64_t particles_of(const struct loop *l, size_t array)
{
    return l->ranks.of ? (uint64_t)l->ranks.array_n[array] : l->run.plan->array[array].p.n;
}

/* Particles in the picture: they may all have been removed, and the run is good all the same. */
static uint64_t particles_drawn(const struct loop *l)
{
    const struct plan *plan = l->run.plan;
    const char *only = l->scene->output.picture.array;
    uint64_t n = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += only && strcmp(only, plan->array[a].p.name) != 0 ? 0 : particles_of(l, a);
    return n;
}

int loop_draw(struct loop *l, struct error *e)
{
    if (!l->scene->output.picture.wanted || l->snapshots == 0 || particles_drawn(l) == 0)
        return 0;
    char name[64];
    snprintf(name, sizeof name, "snapshot_%04llu.vtkhdf", (unsigned long long)l->snapshots - 1);
    char *path = output_path(l->out, name);
    struct render_options o;
    render_defaults(&o);
    o.field = l->scene->output.picture.of;
    o.array = l->scene->output.picture.array;
    o.map = l->scene->output.picture.map;
    if (l->scene->output.picture.range) {
        o.min = l->scene->output.picture.min;
        o.max = l->scene->output.picture.max;
    }
    char *png = text_format("%s.png", o.field ? o.field : "picture");
    char *temporary = png ? output_begin(l->out, png) : NULL;
    struct snapshot s = {0};
    int status = path && temporary ? 0 : error_memory(e, "a picture", 1);
    if (!status)
        status = snapshot_read(&s, path, e);
    if (!status)
        status = render_png(temporary, &s, &o, e);
    if (!status)
        status = output_commit(l->out, temporary, png, e);
    if (!status)
        l->picture = output_path(l->out, png);
    snapshot_free(&s);
    free(path);
    free(png);
    free(temporary);
    return status;
}

/* What the summary points into; filled from the run. */
struct summary_parts {
    const char **name;
    uint64_t *count;
    struct summary_pass *pass;
    struct summary_plugin *plugin;
    struct summary_watch watch[WATCH_CAUSES], failure;
    size_t n_watch;
    cJSON *plan, *device, *shared; /* of a run on a device, or NULL */
    cJSON *on_ranks;               /* on several ranks, or NULL */
};

static void parts_free(struct summary_parts *q)
{
    free(q->name);
    free(q->count);
    free(q->pass);
    free(q->plugin);
    cJSON_Delete(q->plan);
    cJSON_Delete(q->device);
    cJSON_Delete(q->shared);
    cJSON_Delete(q->on_ranks);
}

static int parts_make(struct loop *l, struct summary_parts *q, struct error *e)
{
    const struct plan *plan = l->run.plan;
    if (l->run.device) {
        run_device_costs(&l->run);
        q->device = run_device_report(&l->run);
        q->shared = run_device_shared(&l->run);
    }
    q->on_ranks = l->ranks.of ? loop_ranks_json(&l->ranks) : NULL;
    q->name = calloc(plan->n_array + 1, sizeof *q->name);
    q->count = calloc(plan->n_array + 1, sizeof *q->count);
    q->pass = calloc(plan->n_pass + 1, sizeof *q->pass);
    q->plugin = calloc(plan->registry->n_plugin + 1, sizeof *q->plugin);
    q->plan = plan_json(plan);
    if (!q->name || !q->count || !q->pass || !q->plugin || !q->plan ||
        (l->ranks.of && !q->on_ranks))
        return error_memory(e, "the summary", 1);
    for (size_t a = 0; a < plan->n_array; a++) {
        q->name[a] = plan->array[a].p.name;
        q->count[a] = particles_of(l, a);
    }
    for (size_t i = 0; i < plan->n_pass; i++) {
        q->pass[i] = (struct summary_pass){plan->pass[i].name, plan->pass[i].seconds,
                                           plan->pass[i].pairs, plan->pass[i].sweeps};
        if (!l->ranks.of)
            continue;
        q->pass[i].seconds = l->ranks.pass_s[i] / (double)wire_size(l->run.domain->wire);
        q->pass[i].pairs = (uint64_t)l->ranks.pass_pairs[i];
    }
    for (size_t i = 0; i < plan->registry->n_plugin; i++) {
        const struct plugin *p = &plan->registry->plugin[i];
        q->plugin[i] =
            (struct summary_plugin){p->name, p->version, p->path, p->abi_major, p->abi_minor};
    }
    return 0;
}

static struct summary_watch watch_of(enum watch_cause cause, const struct failure *f, uint64_t n)
{
    struct summary_watch w = {.cause = watch_keys[cause],
                              .n = n,
                              .happened = f->happened,
                              .array = f->array ? f->array->p.name : NULL,
                              .pass = f->pass[0] ? f->pass : NULL,
                              .particle = f->particle,
                              .step = f->step,
                              .time = f->time};
    memcpy(w.x, f->x, sizeof w.x);
    return w;
}

/* What the scene wants counted, and what stopped the run. */
static void watch_make(const struct loop *l, struct summary_parts *q)
{
    const struct watch *w = l->run.watch;
    for (size_t c = 0; w && c < WATCH_CAUSES; c++)
        if (w->scene[c].action == WATCH_COUNT)
            q->watch[q->n_watch++] =
                watch_of((enum watch_cause)c, &w->count[c].first, w->count[c].n);
    if (w)
        q->failure = watch_of(w->failure.cause, &w->failure, 1);
}

struct summary_memory loop_memory(const struct loop *l)
{
    const struct plan *plan = l->run.plan;
    const struct run_memory m = run_memory(&l->run);
    struct summary_memory out = {.lists = (double)m.lists,
                                 .places = (double)m.places,
                                 .ghosts = (double)m.ghosts,
                                 .search = (double)m.search};
    for (size_t a = 0; a < plan->n_array; a++) {
        const struct particles *p = &plan->array[a].p;
        for (size_t c = 0; c < p->n_column; c++) {
            const struct column *k = &p->column[c];
            out.columns += (double)(k->ncomp * (k->size + (k->low ? sizeof(float) : 0)) * p->n);
            out.mirrors += k->mirror ? (double)(k->ncomp * 4 * p->n) : 0.0;
        }
    }
    return out;
}

/* Bytes for a particle, item by item. */
static struct summary_memory memory_of(const struct loop *l, const struct rank_figures *all)
{
    const struct summary_memory m =
        all ? (struct summary_memory){all->columns_held, all->mirrors_held, all->lists_held,
                                      all->places_held,  all->ghosts_held,  all->search_held}
            : loop_memory(l);
    const double n = (double)(all ? all->particles : particles_total(l->run.plan));
    return n > 0.0 ? (struct summary_memory){m.columns / n, m.mirrors / n, m.lists / n,
                                             m.places / n,  m.ghosts / n,  m.search / n}
                   : (struct summary_memory){0};
}

/* Counts are sums over the ranks, seconds their means. */
static void cost_of_ranks(const struct loop_ranks *l, const struct rank_figures *all,
                          struct summary_cost *cost)
{
    const double ranks = (double)wire_size(l->run->domain->wire);
    cost->neighbour = all->neighbour_s / ranks;
    cost->integrate = all->integrate_s / ranks;
    cost->io = all->io_s / ranks;
    cost->mpi = all->wait_s / ranks;
    cost->particle_updates = all->updates;
    cost->pairs = all->pairs;
    cost->peak_rss = all->rss;
}

int loop_summarise(struct loop *l, const char *status, const char *reason, struct error *e)
{
    const struct run *r = &l->run;
    struct summary_parts q = {0};
    if (parts_make(l, &q, e)) {
        parts_free(&q);
        return -1;
    }
    if (reason && r->watch)
        watch_step(&l->run); /* one that was broken off counts as well */
    watch_make(l, &q);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    struct summary s = {.status = status,
                        .scene = l->options->scene_path,
                        .title = l->scene->title,
                        .reason = reason,
                        .failure = reason && q.failure.happened ? &q.failure : NULL,
                        .watch = q.watch,
                        .n_watch = q.n_watch,
                        .n_array = r->plan->n_array,
                        .array_name = q.name,
                        .array_n = q.count,
                        .steps = r->step,
                        .time = r->time,
                        .energy_drift = l->energy_drift,
                        .mass_drift =
                            l->first.mass > 0.0 ? l->last.mass / l->first.mass - 1.0 : 0.0,
                        .dim = r->plan->dim,
                        .pass = q.pass,
                        .n_pass = r->plan->n_pass,
                        .plan = q.plan,
                        .device = q.device,
                        .shared = q.shared,
                        .plugin = q.plugin,
                        .n_plugin = r->plan->registry->n_plugin,
                        .threads = r->threads,
                        .ranks = l->run.domain ? wire_size(l->run.domain->wire) : 1,
                        .on_ranks = q.on_ranks,
                        .picture = l->picture};
    if (strcmp(status, "failed") != 0)
        measures_summary(&l->measures, &s);
    memcpy(s.momentum_drift, l->momentum_drift, sizeof s.momentum_drift);
    memcpy(s.angular_drift, l->angular_drift, sizeof s.angular_drift);
    s.cost.wall = omp_get_wtime() - l->started;
    s.cost.loop = r->cost.loop;
    s.cost.neighbour = r->cost.neighbour;
    s.cost.integrate = r->cost.integrate;
    s.cost.io = r->cost.io;
    s.cost.particle_updates = r->cost.particle_updates;
    s.cost.pairs = r->cost.pairs;
    s.cost.list_builds = r->cost.list_builds;
    for (size_t i = 0; i < r->plan->n_pass; i++)
        s.cost.h_sweeps += r->plan->pass[i].max_sweeps ? r->plan->pass[i].sweeps : 0;
    s.cost.peak_rss = (uint64_t)usage.ru_maxrss * 1024u;
    s.cost.sorts = r->cost.sorts;
    const struct rank_figures all = loop_ranks_sum(&l->ranks);
    if (l->ranks.of)
        cost_of_ranks(&l->ranks, &all, &s.cost);
    s.cost.memory = memory_of(l, l->ranks.of ? &all : NULL);
    s.cost.bytes_per_particle = s.cost.memory.columns + s.cost.memory.mirrors +
                                s.cost.memory.lists + s.cost.memory.places + s.cost.memory.ghosts;
    int result = summary_write(&s, l->out, e);
    if (!result && l->options->table)
        summary_table(&s, stdout);
    parts_free(&q);
    return result;
}
