/* run/loop.h -- the step loop: from a filled plan to a folder of results. */
#ifndef RUN_LOOP_H
#define RUN_LOOP_H

#include "io/output.h"
#include "run/resume.h"
#include "run/run.h"

struct loop_options {
    const char *scene_path;
    double until;   /* NaN: the scene's end */
    uint64_t steps; /* UINT64_MAX: no bound but the scene's */
    bool progress;  /* show it if stderr is a terminal */
    bool table;     /* print the table at the end on stdout */
    bool audit;
    int threads;
    uint32_t path;            /* SPH_PATH_... */
    const volatile int *stop; /* set by a signal: end after this step */
    struct resume *resume;    /* a checkpoint to go on from; the plan is not filled; NULL: none */
};

/* Runs to the end and writes everything. What an earlier run left in the claimed folder goes once nothing can
 * refuse this one any longer. On failure what was written stays good, the state is kept as a snapshot
 * and in checkpoint_failed.h5, and summary.json tells the reason. */
int loop_run(struct plan *plan, const struct output *out, const struct loop_options *o,
             struct error *e);

#endif
