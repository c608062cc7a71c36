/* integrators/predictor.c -- predictor-corrector: to mid-step with the rates of the step before, one
 * evaluation there, then the whole step with it. */
#include "integrators/families.h"

static const struct op pec_op[] = {
    {OP_SAVE_STATE, 0.0},  {OP_DRIFT, 0.5},        {OP_KICK, 0.5},        {OP_EVALUATE, 0.5},
    {OP_FINISH_KICK, 0.5}, {OP_FINISH_DRIFT, 1.0}, {OP_FINISH_KICK, 1.0},
};

const struct integrator integrator_pec = {
    .name = "pec",
    .doc = "predict, evaluate, correct at mid-step",
    .source = "Monaghan (1989), J. Comput. Phys. 82, 1; one evaluation a step",
    .order = 2,
    .evaluations = 1,
    .op = pec_op,
    .n_op = sizeof pec_op / sizeof pec_op[0],
    .saves_state = true,
};
