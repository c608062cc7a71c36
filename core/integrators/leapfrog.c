/* integrators/leapfrog.c -- kick-drift-kick leapfrog with predicted velocities: one evaluation a step. */
#include "integrators/families.h"

/* The kicked columns are predicted to the end of the step, where the rates are evaluated, then corrected
 * to the mean of both rates. With rates that do not depend on what is kicked this is the symplectic
 * velocity Verlet; with viscosity it is Springel (2005, MNRAS 364, 1105)'s predicted form. */
static const struct op kdk_op[] = {
    {OP_KICK, 0.5},       {OP_DRIFT, 1.0},    {OP_KICK, 0.5},
    {OP_SAVE_RATES, 0.0}, {OP_EVALUATE, 1.0}, {OP_CORRECT, 0.5},
};

const struct integrator integrator_kdk = {
    .name = "kdk",
    .doc = "kick-drift-kick leapfrog, velocities predicted for the evaluation",
    .source = "Springel (2005), MNRAS 364, 1105, eq. 27-28, with predicted velocities",
    .order = 2,
    .evaluations = 1,
    .op = kdk_op,
    .n_op = sizeof kdk_op / sizeof kdk_op[0],
    .saves_rates = true,
};
