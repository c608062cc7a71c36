/* integrators/predictor.c -- predictor-corrector: to mid-step, one evaluation there, then the whole step with
 * it. They differ in the rates that predict. */
#include "integrators/families.h"

/* With the rates of the last evaluation, which was in the middle of the last step. */
static const struct op pec_op[] = {
    SAVE(ALL),       DRIFT(0.5),       KICK(0.5),       EVALUATE(0.5),
    KICK_SAVED(0.5), DRIFT_SAVED(1.0), KICK_SAVED(1.0),
};

const struct integrator integrator_pec = {
    .name = "pec",
    .doc = "predict by the last rates, evaluate and correct at mid-step: dkd in other words",
    .source = "Monaghan (1989), J. Comput. Phys. 82, 1; one evaluation a step",
    .order = 2,
    .evaluations = 1,
    .knee = 1.0,
    OPS(pec_op),
};

/* With those of the beginning: the evaluation at the end is the next step's. */
static const struct op pece_op[] = {
    SAVE(ALL),       DRIFT(0.5),       KICK(0.5),       EVALUATE(0.5),
    KICK_SAVED(0.5), DRIFT_SAVED(1.0), KICK_SAVED(1.0), EVALUATE(1.0),
};

const struct integrator integrator_pece = {
    .name = "pece",
    .doc = "predict by the rates of the beginning, evaluate and correct at mid-step: symplectic "
           "in other words",
    .source = "Monaghan (1989), J. Comput. Phys. 82, 1",
    .order = 2,
    .evaluations = 2,
    .knee = 1.2,
    OPS(pece_op),
};
