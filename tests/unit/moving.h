/* moving.h -- a plan in motion, begun and moved by hand, for the tests of core/run and of the integrators.
 * Include after cmocka.h. */
#ifndef TESTS_MOVING_H
#define TESTS_MOVING_H

#include "motion.h"

/* A plan and its run. */
struct motion {
    struct rig rig;
    struct run run;
};

static inline void begin(struct motion *m, int threads)
{
    struct error e = {0};
    if (run_init(&m->run, &m->rig.plan, threads, SPH_PATH_BEST, false, &e))
        fail_msg("%s", e.text);
}

static inline void end(struct motion *m)
{
    run_free(&m->run);
    rig_close(&m->rig);
}

static inline void passes(struct motion *m, enum moment moment)
{
    struct error e = {0};
    if (run_passes(&m->run, moment, &e))
        fail_msg("%s", e.text);
}

static inline void steps(struct motion *m, double dt, int n)
{
    struct error e = {0};
    m->run.dt = dt;
    for (int k = 0; k < n; k++) {
        if (run_advance(&m->run, &e))
            fail_msg("%s", e.text);
        m->run.step++;
    }
}

#endif
