/* run/loop.c -- the step loop: choose dt, advance, log, snapshot; then the summary. */
#include "run/loop.h"
#include "base/text.h"
#include "config.h"
#include "io/log.h"
#include "io/render.h"
#include "io/snapshot.h"
#include "io/summary.h"
#include "run/report.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

struct loop {
    struct run run;
    const struct loop_options *options;
    const struct output *out;
    const struct scene *scene;
    struct log log;
    struct progress progress;
    struct totals first, last;
    double energy_drift, momentum_drift[3], angular_drift[3];
    double begin, end, started;
    double full; /* the last step's dt before it was cut to end on time */
    uint64_t max_steps, snapshots, next_output;
    double next_log;
    bool momentum_free; /* nothing bounds the domain, so momentum is conserved */
    char *picture, *scene_text;
};

static double energy(const struct totals *t)
{
    return t->kinetic + t->internal + t->potential;
}

/* Drifts are the largest over the logged steps: energy relative to the first total (or its parts, where they cancel);
 * momentum relative to sum m |v|. */
static int watch(struct loop *l, struct error *e)
{
    if (run_settle(&l->run, e))
        return -1;
    run_totals(&l->run, &l->last);
    const struct totals *a = &l->first, *b = &l->last;
    double scale = fmax(fabs(energy(a)), fabs(a->kinetic) + fabs(a->internal));
    double drift = scale > 0.0 ? (energy(b) - energy(a)) / scale : energy(b) - energy(a);
    if (!(fabs(drift) <= fabs(l->energy_drift)))
        l->energy_drift = drift;
    for (int c = 0; c < 3; c++) {
        double p = fmax(a->momentum_scale, b->momentum_scale);
        double q = fmax(a->angular_scale, b->angular_scale);
        double dp = p > 0.0 ? (b->momentum[c] - a->momentum[c]) / p : 0.0;
        double dq = q > 0.0 ? (b->angular[c] - a->angular[c]) / q : 0.0;
        if (!(fabs(dp) <= fabs(l->momentum_drift[c])))
            l->momentum_drift[c] = dp;
        if (!(fabs(dq) <= fabs(l->angular_drift[c])))
            l->angular_drift[c] = dq;
    }
    return 0;
}

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

static int write_log(struct loop *l, struct error *e)
{
    const struct run *r = &l->run;
    size_t n = r->plan->n_reduction;
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

static int write_snapshot(struct loop *l, struct error *e)
{
    double t = omp_get_wtime();
    const struct plan *plan = l->run.plan;
    char name[64];
    snprintf(name, sizeof name, "snapshot_%04llu.vtkhdf", (unsigned long long)l->snapshots);
    struct particles *all = calloc(plan->n_array, sizeof *all);
    char *temporary = output_begin(l->out, name);
    int status = all && temporary ? 0 : error_memory(e, "a snapshot", plan->n_array * sizeof *all);
    if (!status)
        status = run_settle(&l->run, e);
    if (!status) {
        for (size_t a = 0; a < plan->n_array; a++)
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
        l->snapshots += !status;
    }
    free(all);
    free(temporary);
    l->run.cost.io += omp_get_wtime() - t;
    return status;
}

/* The next moment at which a step must end. */
static double target(const struct loop *l)
{
    double every = l->scene->output.every;
    double next = isfinite(every) ? l->begin + (double)l->next_output * every : INFINITY;
    /* 3 * 0.3 is a rounding short of 0.9: that is the end, not a step of its own before it. */
    return next < l->end - 1e-9 * every ? next : l->end;
}

/* From one step to the next dt grows by no more than GROWTH, and the first is a part of what the bound allows: the
 * bound is an estimate from the state before the step, and at the start nothing has moved yet. */
#define GROWTH 1.2
#define FIRST 0.1

/* Full steps until near the target, then the rest in one or two equal steps: never a sliver. */
static int choose_dt(struct loop *l, double *dt, struct error *e)
{
    struct run *r = &l->run;
    double full = isnan(l->scene->time.dt) ? r->plan->cfl * r->dt_bound : l->scene->time.dt;
    if (isnan(full) && finite_trace(r, e))
        return -1;
    if (isnan(full))
        return error_set(e, EXIT_RUN, "the time step is no longer a number at step %llu, t = %g",
                         (unsigned long long)r->step, r->time);
    full = fmin(fmin(full, l->scene->time.dt_max), r->proposed);
    r->proposed = INFINITY;
    /* Later on nothing may be left that bounds it, as when the last particle has gone: it grows on. */
    if (!(full < INFINITY) && r->step == 0)
        return error_set(
            e, EXIT_USAGE,
            "no function of the scene bounds the time step: give \"dt\" or \"dt_max\" in \"time\"");
    if (isnan(l->scene->time.dt))
        full = r->step == 0 ? FIRST * full : fmin(full, GROWTH * l->full);
    l->full = full;
    double left = target(l) - r->time;
    double tiny = 1e-12 * fmax(fabs(r->time), l->end - l->begin);
    if (!(full > tiny * 1e-3))
        return error_set(e, EXIT_RUN, "the time step collapsed to %g at step %llu, t = %g", full,
                         (unsigned long long)r->step, r->time);
    *dt = left <= full * (1.0 + 1e-9) ? left : left < 2.0 * full ? 0.5 * left : full;
    return 0;
}

static bool finished(const struct loop *l)
{
    return !(l->run.time < l->end) || l->run.step >= l->max_steps ||
           (l->options->stop && *l->options->stop);
}

static uint64_t particles_total(const struct plan *plan)
{
    uint64_t n = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += plan->array[a].p.n;
    return n;
}

/* "every" takes the place of "steps", whose default stands beside it. */
static bool is_logged(const struct loop *l, uint64_t step, double time)
{
    const uint64_t steps = l->scene->output.log_steps;
    return time >= l->next_log ||
           (!isfinite(l->scene->output.log_every) && steps && step % steps == 0);
}

static int one_step(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    double dt = 0.0;
    if (choose_dt(l, &dt, e))
        return -1;
    r->dt = dt;
    double goal = target(l);
    bool reaches = !(r->time + dt < goal);
    r->look = is_logged(l, r->step + 1, r->time + dt);
    r->defer = !r->look && !reaches;
    if (run_advance(r, e))
        return -1;
    if (reaches)
        r->time = goal; /* not a rounding beside it */
    r->step++;
    r->cost.particle_updates += particles_total(r->plan);
    return 0;
}

static int after_step(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    bool last = finished(l);
    bool by_time = r->time >= l->next_log;
    const bool logged = last || is_logged(l, r->step, r->time);
    /* Sums over all particles: where they are written. Rates are looked at in every evaluation. */
    if (logged && watch(l, e))
        return -1;
    if (!isfinite(energy(&l->last)) && finite_trace(r, e))
        return -1;
    if (!isfinite(energy(&l->last)))
        return error_set(e, EXIT_RUN, "the energy is no longer a number at step %llu, t = %g",
                         (unsigned long long)r->step, r->time);
    if (logged && write_log(l, e))
        return -1;
    while (by_time && l->next_log <= r->time)
        l->next_log += l->scene->output.log_every;
    if (!last && r->time >= target(l)) {
        l->next_output++;
        if (write_snapshot(l, e))
            return -1;
    }
    progress_show(&l->progress, r->step, r->time, r->dt, l->energy_drift);
    return 0;
}

static int steps(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    double begin = omp_get_wtime(), io = r->cost.io;
    r->look = true;
    if (run_passes(r, MOMENT_START, e) || run_passes(r, MOMENT_EVALUATE, e))
        return -1;
    run_totals(r, &l->first);
    if (watch(l, e))
        return -1;
    l->next_output = 1;
    l->next_log =
        isfinite(l->scene->output.log_every) ? l->begin + l->scene->output.log_every : INFINITY;
    if (write_log(l, e) || write_snapshot(l, e))
        return -1;
    while (!finished(l))
        if (one_step(l, e) || after_step(l, e))
            return -1;
    if (run_settle(r, e))
        return -1;
    if (r->step && !integrator_ends_evaluated(r->plan->integrator)) {
        /* The last evaluation was in mid-step: bring what is derived up to the end. */
        if (run_passes(r, MOMENT_EVALUATE, e))
            return -1;
    }
    r->cost.loop = omp_get_wtime() - begin - (r->cost.io - io);
    return write_snapshot(l, e);
}

/* Particles in the picture: they may all have been removed, and the run is good all the same. */
static uint64_t particles_drawn(const struct loop *l)
{
    const struct plan *plan = l->run.plan;
    const char *only = l->scene->output.picture.array;
    uint64_t n = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += only && strcmp(only, plan->array[a].p.name) != 0 ? 0 : plan->array[a].p.n;
    return n;
}

static int draw(struct loop *l, struct error *e)
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
    struct summary_error *error;
    struct summary_probe *probe;
    size_t n_error, n_probe;
    cJSON *plan;
};

static void parts_free(struct summary_parts *q)
{
    free(q->name);
    free(q->count);
    free(q->pass);
    free(q->plugin);
    report_errors_free(q->error, q->n_error);
    free(q->probe);
    cJSON_Delete(q->plan);
}

static int parts_make(const struct loop *l, struct summary_parts *q, bool good, struct error *e)
{
    const struct plan *plan = l->run.plan;
    q->name = calloc(plan->n_array + 1, sizeof *q->name);
    q->count = calloc(plan->n_array + 1, sizeof *q->count);
    q->pass = calloc(plan->n_pass + 1, sizeof *q->pass);
    q->plugin = calloc(plan->registry->n_plugin + 1, sizeof *q->plugin);
    q->plan = plan_json(plan);
    if (!q->name || !q->count || !q->pass || !q->plugin || !q->plan)
        return error_memory(e, "the summary", 1);
    for (size_t a = 0; a < plan->n_array; a++) {
        q->name[a] = plan->array[a].p.name;
        q->count[a] = plan->array[a].p.n;
    }
    for (size_t i = 0; i < plan->n_pass; i++)
        q->pass[i] = (struct summary_pass){plan->pass[i].name, plan->pass[i].seconds,
                                           plan->pass[i].pairs, plan->pass[i].sweeps};
    for (size_t i = 0; i < plan->registry->n_plugin; i++) {
        const struct plugin *p = &plan->registry->plugin[i];
        q->plugin[i] =
            (struct summary_plugin){p->name, p->version, p->path, p->abi_major, p->abi_minor};
    }
    if (!good)
        return 0;
    return report_errors(&l->run, &q->error, &q->n_error, e) ||
                   report_probes(&l->run, &q->probe, &q->n_probe, e)
               ? -1
               : 0;
}

/* Bytes for a particle, item by item. */
static struct summary_memory memory_of(const struct loop *l)
{
    const struct plan *plan = l->run.plan;
    const struct run_memory m = run_memory(&l->run);
    const double n = (double)particles_total(plan);
    struct summary_memory out = {0};
    if (!(n > 0.0))
        return out;
    for (size_t a = 0; a < plan->n_array; a++) {
        const struct particles *p = &plan->array[a].p;
        for (size_t c = 0; c < p->n_column; c++) {
            const struct column *k = &p->column[c];
            out.columns += (double)(k->ncomp * (k->size + (k->low ? sizeof(float) : 0)) * p->n) / n;
            out.mirrors += k->mirror ? (double)(k->ncomp * 4 * p->n) / n : 0.0;
        }
    }
    out.lists = (double)m.lists / n;
    out.places = (double)m.places / n;
    out.ghosts = (double)m.ghosts / n;
    out.search = (double)m.search / n;
    return out;
}

static int summarise(struct loop *l, const char *status, const char *reason, struct error *e)
{
    const struct run *r = &l->run;
    struct summary_parts q = {0};
    if (parts_make(l, &q, strcmp(status, "failed") != 0, e)) {
        parts_free(&q);
        return -1;
    }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    struct summary s = {.status = status,
                        .scene = l->options->scene_path,
                        .title = l->scene->title,
                        .reason = reason,
                        .n_array = r->plan->n_array,
                        .array_name = q.name,
                        .array_n = q.count,
                        .steps = r->step,
                        .time = r->time,
                        .error = q.error,
                        .n_error = q.n_error,
                        .probe = q.probe,
                        .n_probe = q.n_probe,
                        .energy_drift = l->energy_drift,
                        .mass_drift =
                            l->first.mass > 0.0 ? l->last.mass / l->first.mass - 1.0 : 0.0,
                        .dim = r->plan->dim,
                        .pass = q.pass,
                        .n_pass = r->plan->n_pass,
                        .plan = q.plan,
                        .plugin = q.plugin,
                        .n_plugin = r->plan->registry->n_plugin,
                        .threads = r->threads,
                        .ranks = 1,
                        .picture = l->picture};
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
    s.cost.memory = memory_of(l);
    s.cost.bytes_per_particle = s.cost.memory.columns + s.cost.memory.mirrors +
                                s.cost.memory.lists + s.cost.memory.places + s.cost.memory.ghosts;
    int result = summary_write(&s, l->out, e);
    if (!result && l->options->table)
        summary_table(&s, stdout);
    parts_free(&q);
    return result;
}

static int loop_begin(struct loop *l, struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    l->started = omp_get_wtime();
    l->begin = s->time.begin;
    l->end = isnan(l->options->until) ? s->time.end : l->options->until;
    l->max_steps = l->options->steps < s->time.steps ? l->options->steps : s->time.steps;
    l->scene_text = cJSON_Print(s->doc->root);
    if (!l->scene_text)
        return error_memory(e, "the scene's text", s->doc->length);
    if (run_init(&l->run, plan, l->options->threads, l->options->path, l->options->audit, e))
        return -1;
    char *path = output_path(l->out, "log.csv");
    int status = path ? log_open(&l->log, path, plan->dim, e) : error_memory(e, "a path", 1);
    free(path);
    progress_start(&l->progress, l->options->progress, l->begin, l->end);
    return status;
}

/* Keeps the state in which the run failed; its own failure is not worth a second sentence. */
static void keep_failed(struct loop *l, const struct error *e)
{
    struct error ignored = {0};
    if (l->run.step > 0 && write_snapshot(l, &ignored))
        ignored.text[0] = '\0';
    summarise(l, "failed", e->text, &ignored);
}

int loop_run(struct plan *plan, const struct output *out, const struct loop_options *o,
             struct error *e)
{
    struct loop l = {.options = o, .out = out, .scene = plan->scene};
    int status = loop_begin(&l, plan, e);
    if (!status)
        status = steps(&l, e);
    progress_end(&l.progress);
    if (!status)
        status = log_close(&l.log, e);
    if (!status)
        status = draw(&l, e);
    if (!status)
        status = summarise(&l, o->stop && *o->stop ? "stopped" : "done", NULL, e);
    else if (l.run.plan)
        keep_failed(&l, e);
    struct error ignored = {0};
    log_close(&l.log, &ignored);
    run_free(&l.run);
    free(l.picture);
    cJSON_free(l.scene_text);
    return status;
}
