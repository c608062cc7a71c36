/* run/loop_state.h -- what the files loop*.c share: the state of a run of the loop. loop.c steps;
 * loop_files.c writes rows of the log and snapshots on the way; loop_report.c tells at the end. */
#ifndef RUN_LOOP_STATE_H
#define RUN_LOOP_STATE_H

#include "io/log.h"
#include "io/summary.h"
#include "run/earlier.h"
#include "run/loop.h"
#include "run/loop_ranks.h"
#include "run/measures.h"

/* A run of the loop. */
struct loop {
    struct run run;
    const struct loop_options *options;
    const struct output *out;
    const struct scene *scene;
    struct log log;
    struct measures measures;
    struct loop_ranks ranks;
    struct progress progress;
    struct earlier earlier; /* of this folder */
    struct totals first, last;
    double energy_drift, momentum_drift[3], angular_drift[3];
    double begin, end, started;
    double full; /* the last step's dt before it was cut to end on time */
    uint64_t max_steps, snapshots, next_output;
    double next_log;
    double was_every, was_log_every; /* output.every and output.log.every of the run that goes on */
    double loop_begun, loop_io; /* what cost.loop is measured from: the clock, and cost.io then */
    bool stopped;               /* some rank has been asked to stop */
    bool apart, worth; /* of a run that failed: there is no state to keep; there is a reason to */
    bool ended;        /* by what was known after the last step: a signal may come at any time */
    bool refused;      /* nothing was begun: nothing is to be kept of it */
    uint64_t checkpointed; /* the step of the last checkpoint; UINT64_MAX: none yet */
    double checkpoints;    /* moments of output.checkpoint.every that have been passed */
    bool momentum_free;    /* nothing bounds the domain, so momentum is conserved */
    char *picture, *scene_text;
};

static inline double totals_energy(const struct totals *t)
{
    return t->kinetic + t->internal + t->potential;
}

static inline uint64_t particles_total(const struct plan *plan)
{
    uint64_t n = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += plan->array[a].p.n;
    return n;
}

/* Seconds in the loop so far, what was written aside. */
double loop_seconds(const struct loop *l);

/* loop_files.c */
int loop_log(struct loop *l, struct error *e);
int loop_snapshot(struct loop *l, struct error *e);

/* loop_checkpoint.c. Leaves a checkpoint of the state right after a step, settled or not; nothing if there is
 * one of this step. Not in the midst of a step. */
int loop_checkpoint(struct loop *l, struct error *e);
/* Leaves the state in which the run failed, in the midst of a step maybe: to be looked at, not gone on from. */
int loop_checkpoint_failed(struct loop *l, const char *reason, struct error *e);
/* After every step, before anything else is done with it. */
int loop_checkpoint_if_due(struct loop *l, struct error *e);
/* Takes the state out of options->resume, into a loop whose run has just been initialised, and takes away what
 * the output folder holds of later. */
int loop_resume(struct loop *l, struct error *e);

/* loop_report.c. Bytes that this rank holds, item by item. */
struct summary_memory loop_memory(const struct loop *l);
/* The picture of the last snapshot, if the scene wants one. */
int loop_draw(struct loop *l, struct error *e);
/* summary.json, and the table. reason: of a failure, or NULL. */
int loop_summarise(struct loop *l, const char *status, const char *reason, struct error *e);

#endif
