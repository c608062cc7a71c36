/* integrators/verlet.c -- the two-step Verlet method of DualSPHysics: over the last step and this one with the
 * rates between them, one evaluation. */
#include "integrators/families.h"
#include <math.h>

/* The even and the odd steps are coupled again every so many, or they drift apart: by a step of first order. As
 * the number is even, the next coupling starts from those that have no part of its error, and the whole is of
 * second order. */
#define COUPLED 40

/* y.0: y of the step before. Where a step is not as long as the last one the two-step formula is that of the same
 * order for steps of a ratio w, y^{n+1} = (1 - w^2) y^n + w^2 y^{n-1} + (1 + w) dt r. */
enum { DRIFTS, STEPS };
static const struct op verlet2_op[] = {
    [DRIFTS] = OP_MAKE(OP_COMBINE, DRIFTING, SLOT_NOW, 1.0, 0.0, 0.0, 1.0, 0.5),
    [STEPS] = OP_MAKE(OP_COMBINE, KICKED, SLOT_0, 0.0, 1.0, 0.0, 2.0, 0.0),
    OP_MAKE(OP_SWAP, KICKED, SLOT_NOW, 0.0, 0.0, 0.0, 0.0, 0.0),
    EVALUATE(1.0),
};

static void verlet2_adapt(struct op *op, uint64_t step, double ratio)
{
    const bool couples = step % COUPLED == 0 || !isfinite(ratio);
    op[STEPS].weight[SLOT_NOW] = couples ? 1.0 : 1.0 - ratio * ratio;
    op[STEPS].weight[SLOT_0] = couples ? 0.0 : ratio * ratio;
    op[STEPS].a = couples ? 1.0 : 1.0 + ratio;
}

const struct integrator integrator_verlet2 = {
    .name = "verlet2",
    .doc =
        "DualSPHysics' two-step Verlet, coupled every 40 steps: among kicked properties it grows "
        "by up to w^2 / 80, above w = 1 without bound; in x and v by w^4 / 16 and more; not for "
        "strong dissipation",
    .source =
        "Verlet (1967), Phys. Rev. 159, 98; Dominguez et al. (2022), Comput. Part. Mech. 9, 867",
    .order = 2,
    .evaluations = 1,
    .knee = 0.2,
    OPS(verlet2_op),
    .adapt = verlet2_adapt,
};
