/* run/loop_checkpoint.c -- checkpoints of a loop: when one is due, what of the loop is in it, and how a loop goes
 * on from one. It is taken right after a step, before anything is settled, logged or written of it, and that
 * is where a loop goes on: so a run with checkpoints, one without, and one that has been resumed are the
 * same to the last bit. */
#include "run/domain.h"
#include "run/loop_state.h"
#include "run/run_store.h"
#include "run/shared_file.h"
#include "run/watch.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* -- What is in it ------------------------------------------------------------------------------ */

static int totals_store(struct totals *t, const char *name, struct store *s, struct error *e)
{
    double v[14] = {t->mass,           t->kinetic,
                    t->internal,       t->potential,
                    t->momentum[0],    t->momentum[1],
                    t->momentum[2],    t->angular[0],
                    t->angular[1],     t->angular[2],
                    t->momentum_scale, t->angular_scale,
                    t->has_energy,     0.0};
    if (store_block(s, name, STORE_F64, v, 14, e))
        return -1;
    *t = (struct totals){.mass = v[0],
                         .kinetic = v[1],
                         .internal = v[2],
                         .potential = v[3],
                         .momentum = {v[4], v[5], v[6]},
                         .angular = {v[7], v[8], v[9]},
                         .momentum_scale = v[10],
                         .angular_scale = v[11],
                         .has_energy = v[12] > 0.0};
    return 0;
}

/* Moments are counted from the beginning; where the scene now asks for others, from this step on. */
static void count_anew(struct loop *l)
{
    const double every = l->was_every, log_every = l->was_log_every;
    const double now = l->run.time - l->begin;
    const double next = l->scene->output.every, log = l->scene->output.log_every;
    if (isfinite(next) && !(every <= next && every >= next))
        l->next_output = (uint64_t)floor(now / next) + 1;
    if (!(log_every <= log && log_every >= log))
        l->next_log = isfinite(log) ? l->begin + log * (floor(now / log) + 1.0) : INFINITY;
    /* An end that was a rounding beside a moment of output has become that moment. */
    const double goal = l->begin + (double)l->next_output * next;
    if (isfinite(next) && l->run.time < goal && l->run.time > goal - 1e-9 * next &&
        goal < l->end - 1e-9 * next)
        l->run.time = goal;
}

/* What ranks share: of the loop itself. elapsed: of an earlier run, when reading. */
static int loop_store(struct loop *l, struct store *s, struct error *e)
{
    double every = l->scene->output.every, log_every = l->scene->output.log_every;
    double elapsed = omp_get_wtime() - l->started;
    if (!s->reading)
        l->run.cost.loop = loop_seconds(l);
    store_enter(s, "loop", 0);
    int status =
        totals_store(&l->first, "first", s, e) || totals_store(&l->last, "last", s, e) ||
                store_f64(s, "energy_drift", &l->energy_drift, e) ||
                store_block(s, "momentum_drift", STORE_F64, l->momentum_drift, 3, e) ||
                store_block(s, "angular_drift", STORE_F64, l->angular_drift, 3, e) ||
                store_f64(s, "full", &l->full, e) || store_f64(s, "next_log", &l->next_log, e) ||
                store_u64(s, "next_output", &l->next_output, e) ||
                store_u64(s, "snapshots", &l->snapshots, e) || store_f64(s, "every", &every, e) ||
                store_f64(s, "log_every", &log_every, e) || store_f64(s, "wall_s", &elapsed, e)
            ? -1
            : 0;
    store_leave(s);
    if (!status && s->reading) {
        l->started = omp_get_wtime() - elapsed;
        l->was_every = every;
        l->was_log_every = log_every;
    }
    return status;
}

/* -- Writing ------------------------------------------------------------------------------------ */

/* By this a file is known to be of a failure; the watch's words for it stand there where it was the one. */
static int mark_failed(const struct run *r, const char *reason, struct store *s, struct error *e)
{
    const struct failure *f = r->watch && r->watch->failure.happened ? &r->watch->failure : NULL;
    struct resume_failure q = {.step = r->step, .time = r->time};
    q.reason = strdup(reason);
    q.cause = f ? strdup(watch_keys[f->cause]) : NULL;
    const int status = q.reason && (q.cause || !f) ? resume_failure_store(&q, s, e)
                                                   : error_memory(e, "a text", strlen(reason));
    resume_failure_free(&q);
    return status;
}

/* The file, what it tells of itself, and what this rank has. reason: of a failure, or NULL: then what may be half
 * made is left out. */
static int write_first(struct loop *l, const char *temporary, const char *reason, struct error *e)
{
    struct run *r = &l->run;
    struct origin origin;
    struct checkpoint file;
    const size_t ranks = r->domain ? (size_t)wire_size(r->domain->wire) : 1;
    if (origin_make(&origin, r->plan, r->path, ranks, l->options->scene_path, e))
        return -1;
    int status = checkpoint_create(&file, temporary, e);
    if (!status) {
        struct store *s = &file.store;
        status = (reason && mark_failed(r, reason, s, e)) || origin_store(&origin, s, e) ||
                         loop_store(l, s, e) ||
                         (r->domain ? ranks_store(r, s, reason != NULL, e)
                          : reason  ? run_store_failed(r, s, e)
                                    : run_store(r, s, e))
                     ? -1
                     : 0;
        status = checkpoint_finish(&file, status, e);
    }
    origin_free(&origin);
    return status;
}

/* What another rank has, in a group of its own. */
static int write_next(struct loop *l, size_t rank, const char *temporary, bool failed,
                      struct error *e)
{
    struct checkpoint file;
    if (checkpoint_append(&file, temporary, e))
        return -1;
    store_enter(&file.store, "rank", rank);
    const int status = ranks_store(&l->run, &file.store, failed, e);
    store_leave(&file.store);
    return checkpoint_finish(&file, status, e);
}

/* Ranks write one after the other: so no more than one rank's particles are anywhere at a time, and a rank that
 * cannot write is known to all before the next begins. */
static int write_file(struct loop *l, const char *temporary, const char *reason, struct error *e)
{
    const struct run_domain *d = l->run.domain;
    const int ranks = d ? wire_size(d->wire) : 1, me = d ? wire_rank(d->wire) : 0;
    int status = 0;
    for (int k = 0; !status && k < ranks; k++) {
        if (k == me)
            status = k == 0 ? write_first(l, temporary, reason, e)
                            : write_next(l, (size_t)k, temporary, reason != NULL, e);
        status = run_domain_agree(&l->run, status, e);
    }
    return status;
}

int loop_checkpoint(struct loop *l, struct error *e)
{
    const double begin = omp_get_wtime();
    char name[64];
    if (l->checkpointed == l->run.step)
        return 0;
    output_checkpoint_name(name, sizeof name, (unsigned long long)l->run.step);
    char *temporary;
    /* Rows before this step are not written again. */
    if (run_fetch(&l->run, e) || csv_sync(&l->log.csv, e) || measures_sync(&l->measures, e) ||
        loop_ranks_sync(&l->ranks, e) || shared_file_begin(&l->run, l->out, name, &temporary, e))
        return -1;
    int status = write_file(l, temporary, NULL, e);
    status = shared_file_end(&l->run, l->out, temporary, name, status, e);
    if (!status) {
        l->checkpointed = l->run.step;
        if (run_speaks(&l->run)) {
            checkpoint_prune(l->out, l->scene->output.checkpoint.keep);
            earlier_pass(&l->earlier, l->out, l->run.step);
        }
    }
    l->run.cost.io += omp_get_wtime() - begin;
    return status;
}

int loop_checkpoint_failed(struct loop *l, const char *reason, struct error *e)
{
    char *temporary;
    if (shared_file_begin(&l->run, l->out, OUTPUT_FAILED, &temporary, e))
        return -1;
    const int status = write_file(l, temporary, reason, e);
    return shared_file_end(&l->run, l->out, temporary, OUTPUT_FAILED, status, e);
}

int loop_checkpoint_if_due(struct loop *l, struct error *e)
{
    const struct run *r = &l->run;
    const uint64_t steps = l->scene->output.checkpoint.steps;
    const double every = l->scene->output.checkpoint.every;
    if (!l->scene->output.checkpoint.wanted)
        return 0;
    const double moments = isfinite(every) ? floor((r->time - l->begin) / every) : 0.0;
    const bool due = l->ended || (steps && r->step % steps == 0) || moments > l->checkpoints;
    l->checkpoints = moments;
    return due && r->step ? loop_checkpoint(l, e) : 0;
}

/* -- Going on ----------------------------------------------------------------------------------- */

/* The command line asks for less than there is. */
static int check_end(const struct loop *l, struct error *e)
{
    const struct run *r = &l->run;
    const char *path = l->options->resume->path;
    if (r->time > l->end)
        return error_set(e, EXIT_USAGE, "%s is at t = %.15g, behind the end %.15g", path, r->time,
                         l->end);
    if (r->step > l->max_steps)
        return error_set(e, EXIT_USAGE, "%s is at step %llu, behind the last one, %llu", path,
                         (unsigned long long)r->step, (unsigned long long)l->max_steps);
    return 0;
}

static int read_file(struct loop *l, struct error *e)
{
    struct run *r = &l->run;
    struct resume *from = l->options->resume;
    struct store *s = &from->file.store;
    const size_t ranks = (size_t)from->origin.ranks;
    const int status = resume_check(from, r->plan, r->path, e) || loop_store(l, s, e) ? -1 : 0;
    if (run_domain_agree(r, status, e) ||
        (r->domain || ranks > 1 ? ranks_restore(r, s, ranks, e) : run_store(r, s, e)))
        return -1;
    count_anew(l);
    return check_end(l, e);
}

int loop_resume(struct loop *l, struct error *e)
{
    const struct resume *from = l->options->resume;
    if (read_file(l, e))
        return -1;
    const double every = l->scene->output.checkpoint.every;
    l->checkpoints = isfinite(every) ? floor((l->run.time - l->begin) / every) : 0.0;
    uint64_t here = run_speaks(&l->run) && resume_is_in(from, l->out->dir);
    if (run_share_count(&l->run, &here, e))
        return -1;
    if (here)
        l->checkpointed = l->run.step;
    if (!run_speaks(&l->run))
        return 0;
    if (!here)
        return earlier_clear(&l->earlier, l->out, e);
    earlier_find(&l->earlier, l->out);
    /* Whatever stands there of later is made again. */
    char *log = output_path(l->out, "log.csv");
    int status =
        log ? output_cut(l->out, l->snapshots, l->run.step, e) : error_memory(e, "a path", 1);
    if (!status)
        status = csv_cut_from(log, l->run.step, e);
    free(log);
    return status;
}
