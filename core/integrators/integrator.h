/* integrators/integrator.h -- time integrators as tables of operations on the columns that the plan's rate
 * table names. y: a property that is kicked (velocity, energy, ...); x: one that drifts. */
#ifndef INTEGRATORS_INTEGRATOR_H
#define INTEGRATORS_INTEGRATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum op_kind {
    OP_KICK,         /* y += a dt r */
    OP_DRIFT,        /* x += a dt v */
    OP_SAVE_STATE,   /* y0 = y, x0 = x */
    OP_SAVE_RATES,   /* r0 = r of the kicked */
    OP_CORRECT,      /* y += a dt (r - r0) */
    OP_FINISH_DRIFT, /* x = x0 + a dt v */
    OP_FINISH_KICK,  /* y = y0 + a dt r */
    OP_EVALUATE      /* all evaluate passes, at time t + a dt */
};

struct op {
    enum op_kind kind;
    double a;
};

struct integrator {
    const char *name, *doc, *source;
    int order;       /* on smooth problems */
    int evaluations; /* a step */
    const struct op *op;
    size_t n_op;
    bool saves_state, saves_rates;
};

/* By name, or NULL. */
const struct integrator *integrator_find(const char *name);
/* Their names, in a static list. */
const char *const *integrator_names(size_t *n);

#endif
