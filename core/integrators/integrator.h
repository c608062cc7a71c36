/* integrators/integrator.h -- time integrators as tables of operations on the columns that the plan's rate
 * table names. y: a property that is kicked (velocity, density, energy, ...), r its rate; x: one that
 * drifts, v its rate. README says what each is good for. */
#ifndef INTEGRATORS_INTEGRATOR_H
#define INTEGRATORS_INTEGRATOR_H

#include <sph/function.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum op_kind {
    OP_COMBINE,    /* slot[to] = sum of weight[k] slot[k] + a dt r + a2 dt^2 (rate of r) */
    OP_SWAP,       /* y <-> y.0 */
    OP_SAVE_RATES, /* r.0 = r of the kicked */
    OP_CORRECT,    /* y += a dt (r - r.0) of the kicked */
    OP_EVALUATE    /* all evaluate passes, at time t + a dt */
};

/* Where values of a property stand: in itself, and in columns "y.0" and "y.1" that are carried along with
 * the particles, also from step to step. */
enum slot { SLOT_NOW, SLOT_0, SLOT_1, SLOT_COUNT };
enum { KICKED = SPH_KICK, DRIFTING = SPH_DRIFT, ALL = SPH_KICK | SPH_DRIFT };

struct op {
    enum op_kind kind;
    uint32_t on; /* KICKED, DRIFTING or ALL */
    enum slot to;
    double weight[SLOT_COUNT]; /* two at most are not 0 */
    double a, a2;              /* a2: only where the rate is itself a kicked property */
};

struct integrator {
    const char *name, *doc, *source;
    int order;       /* on smooth problems */
    int evaluations; /* a step */
    /* The largest time-step number that is of use over that of "kdk": the least knee over shocks and a stirred
     * liquid, as `make check-stability` measures it (README). A scheme's own number is for its own integrator;
     * another one gets it times the ratio of both knees. */
    double knee;
    const struct op *op;
    size_t n_op;
    /* Or NULL. Fits a copy of the table to step number `step`, which is `ratio` times as long as the one before
     * (NaN: there was none). */
    void (*adapt)(struct op *op, uint64_t step, double ratio);
};

#define OPS_MAX 32

/* By name, or NULL. */
const struct integrator *integrator_find(const char *name);
/* Their names, in a static list. */
const char *const *integrator_names(size_t *n);

/* Whether it keeps a slot of what is KICKED or DRIFTING; the rates of the step before. */
bool integrator_keeps(const struct integrator *i, uint32_t on, enum slot slot);
bool integrator_saves_rates(const struct integrator *i);
/* Whether the last evaluation of a step is of its end: all that is derived is right there. */
bool integrator_ends_evaluated(const struct integrator *i);

#endif
