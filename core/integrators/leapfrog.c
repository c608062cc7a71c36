/* integrators/leapfrog.c -- the two forms of the leapfrog, kicked properties predicted for the evaluation:
 * one evaluation a step. */
#include "integrators/families.h"

/* The kicked columns are predicted to the end of the step, where the rates are evaluated, then corrected
 * to the mean of both rates. With rates that do not depend on what is kicked this is the symplectic
 * velocity Verlet; with viscosity it is Springel (2005, MNRAS 364, 1105)'s predicted form. Among kicked
 * properties alone (density by continuity and velocity) the predicted values p advance by
 * dt (3 r(p) - r(p of the step before)) / 2: Adams-Bashforth's second-order method. Heun's would need the
 * rates of the corrected values, another evaluation. */
static const struct op kdk_op[] = {
    KICK(0.5), DRIFT(1.0), KICK(0.5), SAVE_RATES, EVALUATE(1.0), CORRECT(0.5),
};

const struct integrator integrator_kdk = {
    .name = "kdk",
    .doc = "kick-drift-kick leapfrog, kicked properties predicted to the end: symplectic in x "
           "and v, stable to w = 2; among kicked properties it grows by w^4 / 4",
    .source = "Springel (2005), MNRAS 364, 1105, eq. 27-28, with predicted velocities",
    .order = 2,
    .evaluations = 1,
    .knee = 1.0,
    OPS(kdk_op),
};

/* The evaluation is in mid-step, for which the kicked are predicted with the rates of the last one. */
static const struct op dkd_op[] = {
    DRIFT(0.5), SAVE(KICKED), KICK(0.5), EVALUATE(0.5), KICK_SAVED(1.0), DRIFT(0.5),
};

const struct integrator integrator_dkd = {
    .name = "dkd",
    .doc = "drift-kick-drift leapfrog, kicked properties predicted to mid-step: symplectic in x "
           "and v, stable to w = 2; among kicked properties it grows by w^4 / 4",
    .source = "Springel (2005), MNRAS 364, 1105; one evaluation a step",
    .order = 2,
    .evaluations = 1,
    .knee = 1.0,
    OPS(dkd_op),
};
