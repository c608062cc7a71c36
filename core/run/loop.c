/* run/loop.c -- the step loop: choose dt, advance, log, snapshot; then the summary. */
#include "run/domain.h"
#include "run/loop_state.h"
#include "run/watch.h"
#include <cjson/cJSON.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Drifts are the largest over the logged steps: energy relative to the first total (or its parts, where they cancel);
 * momentum relative to sum m |v|. */
static int take_totals(struct loop *l, struct error *e)
{
    if (run_settle(&l->run, e) || run_totals(&l->run, &l->last, e))
        return -1;
    const struct totals *a = &l->first, *b = &l->last;
    double scale = fmax(fabs(totals_energy(a)), fabs(a->kinetic) + fabs(a->internal));
    double drift = scale > 0.0 ? (totals_energy(b) - totals_energy(a)) / scale
                               : totals_energy(b) - totals_energy(a);
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

/* What ranks may see differently, and at different times. */
static int share(struct loop *l, struct error *e)
{
    static const uint32_t op[2] = {SPH_REDUCE_MIN, SPH_REDUCE_MAX};
    double value[2] = {l->run.proposed, l->options->stop && *l->options->stop ? 1.0 : 0.0};
    if (run_share_numbers(&l->run, value, op, 2, e))
        return -1;
    l->run.proposed = value[0];
    l->stopped = value[1] > 0.0;
    return 0;
}

/* Full steps until near the target, then the rest in one or two equal steps: never a sliver. */
static int choose_dt(struct loop *l, double *dt, struct error *e)
{
    struct run *r = &l->run;
    double full = isnan(l->scene->time.dt) ? r->plan->cfl * r->dt_bound : l->scene->time.dt;
    if (isnan(full) && (run_fetch(r, e) || finite_trace(r, e)))
        return -1;
    if (isnan(full))
        return watch_fail(r, &(struct sign){.cause = WATCH_NOT_FINITE}, e,
                          "the time step is no longer a number");
    if (share(l, e))
        return -1;
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
    if (watch_time_step(r, full, l->end - l->begin, e))
        return -1;
    *dt = left <= full * (1.0 + 1e-9) ? left : left < 2.0 * full ? 0.5 * left : full;
    return 0;
}

/* Ranks stop together: by what they have shared. */
static bool was_stopped(const struct loop *l)
{
    return l->run.domain ? l->stopped : l->options->stop && *l->options->stop;
}

static bool finished(const struct loop *l)
{
    return !(l->run.time < l->end) || l->run.step >= l->max_steps || was_stopped(l);
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
    loop_ranks_step_begins(&l->ranks);
    run_domain_step(r, true);
    double goal = target(l);
    bool reaches = !(r->time + dt < goal);
    r->look = is_logged(l, r->step + 1, r->time + dt);
    r->defer = !r->look && !reaches;
    if (run_advance(r, e))
        return -1;
    if (reaches)
        r->time = goal; /* not a rounding beside it */
    r->step++;
    loop_ranks_step_ends(&l->ranks);
    run_domain_step(r, false);
    r->cost.particle_updates += particles_total(r->plan);
    return 0;
}

static int after_step(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    const bool last = l->ended = finished(l);
    if (loop_checkpoint_if_due(l, e))
        return -1;
    bool by_time = r->time >= l->next_log;
    const bool logged = last || is_logged(l, r->step, r->time);
    /* Sums over all particles: where they are written. Rates are looked at in every evaluation. */
    if (logged && take_totals(l, e))
        return -1;
    if (!isfinite(totals_energy(&l->last)) && (run_fetch(r, e) || finite_trace(r, e)))
        return -1;
    if (!isfinite(totals_energy(&l->last)))
        return watch_fail(r, &(struct sign){.cause = WATCH_NOT_FINITE}, e,
                          "the energy is no longer a number");
    if (logged &&
        (watch_energy(r, &l->first, &l->last, e) || loop_log(l, e) || loop_ranks_row(&l->ranks, e)))
        return -1;
    if (!last && measures_due(&l->measures) &&
        (run_look(r, e) || measures_take(&l->measures, MEASURES_ON_THE_WAY, e)))
        return -1;
    watch_step(r);
    while (by_time && l->next_log <= r->time)
        l->next_log += l->scene->output.log_every;
    if (!last && r->time >= target(l)) {
        l->next_output++;
        if (loop_snapshot(l, e))
            return -1;
    }
    progress_show(&l->progress, r->step, r->time, r->dt, l->energy_drift);
    return 0;
}

static int start(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    r->look = true;
    if (run_passes(r, MOMENT_START, e) || run_passes(r, MOMENT_EVALUATE, e))
        return -1;
    if (run_totals(r, &l->first, e) || take_totals(l, e))
        return -1;
    l->next_output = 1;
    l->next_log =
        isfinite(l->scene->output.log_every) ? l->begin + l->scene->output.log_every : INFINITY;
    l->ended = finished(l);
    if (run_fetch(r, e))
        return -1;
    return loop_log(l, e) || loop_ranks_row(&l->ranks, e) || loop_snapshot(l, e) ||
                   measures_take(&l->measures, MEASURES_START, e)
               ? -1
               : 0;
}

double loop_seconds(const struct loop *l)
{
    return omp_get_wtime() - l->loop_begun - (l->run.cost.io - l->loop_io);
}

/* What all ranks have to tell. */
static int gather(struct loop *l, struct error *e)
{
    const struct summary_memory held = loop_memory(l);
    return loop_ranks_gather(&l->ranks, &held, e);
}

/* A checkpoint was taken before its step was looked at. */
static int steps(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    l->loop_begun = omp_get_wtime() - r->cost.loop;
    l->loop_io = r->cost.io;
    if (l->options->resume ? after_step(l, e) : start(l, e))
        return -1;
    while (!l->ended)
        if (one_step(l, e) || after_step(l, e))
            return -1;
    if (run_settle(r, e))
        return -1;
    if (r->step && !integrator_ends_evaluated(r->plan->integrator)) {
        /* The last evaluation was in mid-step: bring what is derived up to the end. */
        if (run_passes(r, MOMENT_EVALUATE, e))
            return -1;
    } else if (run_fetch(r, e) || watch_state(r, e)) {
        return -1;
    }
    if (run_fetch(r, e))
        return -1;
    if (measures_take(&l->measures, MEASURES_END, e))
        return -1;
    r->cost.loop = loop_seconds(l);
    return loop_snapshot(l, e) || gather(l, e) ? -1 : 0;
}

static int loop_begin(struct loop *l, struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    l->loop_begun = l->started = omp_get_wtime();
    l->begin = s->time.begin;
    l->end = isnan(l->options->until) ? s->time.end : l->options->until;
    l->max_steps = l->options->steps < s->time.steps ? l->options->steps : s->time.steps;
    l->scene_text = cJSON_Print(s->doc->root);
    if (run_domain_agree(
            &l->run, l->scene_text ? 0 : error_memory(e, "the scene's text", s->doc->length), e))
        return -1;
    l->checkpointed = UINT64_MAX;
    /* Ranks agree on each part of it: one may fail alone where the others go on. */
    l->refused = run_domain_agree(
        &l->run,
        run_init(&l->run, plan, l->options->threads, l->options->path, l->options->audit, e), e);
    if (!l->refused)
        l->refused = run_domain_agree(&l->run,
                                      l->options->resume    ? loop_resume(l, e)
                                      : run_speaks(&l->run) ? earlier_clear(&l->earlier, l->out, e)
                                                            : 0,
                                      e);
    if (l->refused)
        return -1;
    progress_start(&l->progress, l->options->progress && run_speaks(&l->run), l->begin, l->end);
    l->progress.started -= omp_get_wtime() - l->started; /* a run that goes on has begun earlier */
    char *path = output_path(l->out, "log.csv");
    int status = !path                  ? error_memory(e, "a path", 1)
                 : !run_speaks(&l->run) ? 0
                 : l->options->resume   ? log_append(&l->log, path, plan->dim, e)
                                        : log_open(&l->log, path, plan->dim, e);
    free(path);
    if (!status)
        status = measures_open(&l->measures, &l->run, l->out, l->options->resume != NULL, e);
    if (!status)
        status = loop_ranks_open(&l->ranks, &l->run, l->out, l->options->resume != NULL, e);
    if (!l->run.domain)
        return status;
    l->refused = run_domain_agree(&l->run, status, e);
    return l->refused ? -1 : 0;
}

/* When a device failed, and what is left. */
static void tell_device(const struct loop *l, struct error *e)
{
    bool lost;
    if (!run_device_failed(&l->run, &lost))
        return;
    error_prefix(e, "step %llu, t = %g", (unsigned long long)l->run.step, l->run.time);
    if (l->checkpointed != UINT64_MAX)
        error_set(e, (enum exit_code)e->exit_code,
                  "%s; the last checkpoint is of step %llu: --resume latest goes on from there",
                  e->text, (unsigned long long)l->checkpointed);
}

/* Of several ranks any may fail by itself: what may be gone on from. A run that has gone wrong would do so again. */
static void tell_checkpoint(const struct loop *l, struct error *e)
{
    if (l->run.domain && e->text[0] && l->checkpointed != UINT64_MAX &&
        !(l->run.watch && l->run.watch->failure.happened) && !strstr(e->text, "--resume"))
        error_set(e, (enum exit_code)e->exit_code,
                  "%s; the last checkpoint is of step %llu: --resume latest goes on from there",
                  e->text, (unsigned long long)l->checkpointed);
}

/* Whether all ranks have begun; whether they stand at the same step, with their particles in hand, so that those make
 * a state; and whether one is worth keeping. */
static bool can_keep(struct loop *l)
{
    static const uint32_t op[5] = {SPH_REDUCE_MAX, SPH_REDUCE_MAX, SPH_REDUCE_MIN, SPH_REDUCE_MAX,
                                   SPH_REDUCE_MAX};
    const double step = (double)l->run.step;
    const bool happened = l->run.watch && l->run.watch->failure.happened;
    bool lost;
    run_device_failed(&l->run, &lost);
    double value[5] = {l->refused ? 1.0 : 0.0, step, step, lost ? 1.0 : 0.0, happened ? 1.0 : 0.0};
    struct error ignored = {0};
    if (run_domain_agree(&l->run, run_share_numbers(&l->run, value, op, 5, &ignored), &ignored) ||
        value[0] > 0.0)
        return false;
    l->apart = value[1] > value[2] || value[3] > 0.0;
    l->worth = value[1] > 0.0 || value[4] > 0.0;
    return true;
}

/* Keeps the state in which the run failed; its own failures are not worth a second sentence. */
static void keep_failed(struct loop *l, struct error *e)
{
    struct error ignored = {0};
    run_domain_agree(&l->run, watch_share_failure(&l->run, &ignored), &ignored);
    ignored = (struct error){0};
    tell_checkpoint(l, e);
    if (l->apart) {
        /* The columns here are of different times. */
    } else if (l->worth) {
        run_domain_agree(&l->run, loop_snapshot(l, &ignored), &ignored);
        ignored = (struct error){0};
        run_domain_agree(&l->run, loop_checkpoint_failed(l, e->text, &ignored), &ignored);
    }
    ignored = (struct error){0};
    run_domain_agree(&l->run, gather(l, &ignored), &ignored);
    ignored = (struct error){0};
    if (run_speaks(&l->run))
        loop_summarise(l, "failed", e->text, &ignored);
}

/* What is told at the end. */
static int tell(struct loop *l, struct error *e)
{
    if (log_close(&l->log, e) || measures_close(&l->measures, e) || loop_ranks_close(&l->ranks, e))
        return -1;
    if (!run_speaks(&l->run))
        return 0;
    if (loop_draw(l, e) || loop_summarise(l, was_stopped(l) ? "stopped" : "done", NULL, e))
        return -1;
    if (!was_stopped(l))
        earlier_pass(&l->earlier, l->out, UINT64_MAX);
    return 0;
}

int loop_run(struct plan *plan, const struct output *out, const struct loop_options *o,
             struct error *e)
{
    struct loop l = {.options = o, .out = out, .scene = plan->scene};
    int status = loop_begin(&l, plan, e);
    if (!status)
        status = steps(&l, e);
    if (status && l.run.domain && !l.refused)
        tell_device(&l, e);
    status = run_domain_agree(&l.run, status, e);
    progress_end(&l.progress);
    if (!status)
        status = run_domain_agree(&l.run, tell(&l, e), e);
    if (status && !l.refused && can_keep(&l)) {
        if (!l.run.domain) /* else its rank has said it */
            tell_device(&l, e);
        keep_failed(&l, e);
    }
    struct error ignored = {0};
    log_close(&l.log, &ignored);
    measures_close(&l.measures, &ignored);
    measures_free(&l.measures);
    loop_ranks_free(&l.ranks);
    run_free(&l.run);
    free(l.picture);
    cJSON_free(l.scene_text);
    return status;
}
