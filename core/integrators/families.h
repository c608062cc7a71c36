/* integrators/families.h -- the integrators that there are, one file a family, and the words of their
 * tables. Every table starts with rates of the beginning of the step, or, where it says so, of the last
 * evaluation. A velocity drifts positions before it is kicked itself, unless the formula wants the new one. */
#ifndef INTEGRATORS_FAMILIES_H
#define INTEGRATORS_FAMILIES_H

#include "integrators/integrator.h"

extern const struct integrator integrator_euler;      /* euler.c */
extern const struct integrator integrator_kdk;        /* leapfrog.c */
extern const struct integrator integrator_dkd;        /* leapfrog.c */
extern const struct integrator integrator_symplectic; /* symplectic.c */
extern const struct integrator integrator_verlet2;    /* verlet.c */
extern const struct integrator integrator_pec;        /* predictor.c */
extern const struct integrator integrator_pece;       /* predictor.c */
extern const struct integrator integrator_rk2;        /* runge_kutta.c */
extern const struct integrator integrator_ssp_rk3;    /* runge_kutta.c */
extern const struct integrator integrator_rk4;        /* runge_kutta.c */

/* clang-format off */
#define OP_MAKE(kind_, on_, to_, w, w0, w1, a_, a2_)                                               \
    {.kind = (kind_), .on = (on_), .to = (to_), .weight = {(w), (w0), (w1)}, .a = (a_), .a2 = (a2_)}
/* clang-format on */
#define KICK(a) OP_MAKE(OP_COMBINE, KICKED, SLOT_NOW, 1.0, 0.0, 0.0, a, 0.0)    /* y += a dt r */
#define DRIFT(a) OP_MAKE(OP_COMBINE, DRIFTING, SLOT_NOW, 1.0, 0.0, 0.0, a, 0.0) /* x += a dt v */
#define KICK_SAVED(a)                                                                              \
    OP_MAKE(OP_COMBINE, KICKED, SLOT_NOW, 0.0, 1.0, 0.0, a, 0.0) /* y = y.0 + a dt r */
#define DRIFT_SAVED(a)                                                                             \
    OP_MAKE(OP_COMBINE, DRIFTING, SLOT_NOW, 0.0, 1.0, 0.0, a, 0.0)         /* x = x.0 + a dt v */
#define SAVE(on) OP_MAKE(OP_COMBINE, on, SLOT_0, 1.0, 0.0, 0.0, 0.0, 0.0)  /* y.0 = y */
#define SAVE_RATES OP_MAKE(OP_SAVE_RATES, KICKED, SLOT_NOW, 0, 0, 0, 0, 0) /* r.0 = r */
#define CORRECT(a) OP_MAKE(OP_CORRECT, KICKED, SLOT_NOW, 0, 0, 0, a, 0)    /* y += a dt (r - r.0) */
#define EVALUATE(a) OP_MAKE(OP_EVALUATE, ALL, SLOT_NOW, 0, 0, 0, a, 0)     /* r, v at t + a dt */

#define OPS(table) .op = (table), .n_op = sizeof(table) / sizeof(table)[0]

#endif
