/* integrators/symplectic.c -- the symplectic position Verlet of DualSPHysics: to mid-step with the rates of the
 * beginning, then the whole step with those of the middle. */
#include "integrators/families.h"

/* x^{n+1} = x^n + dt / 2 (v^n + v^{n+1}). The source closes the step of the density by the factor
 * (2 - e) / (2 + e), e = -dt R / rho, which is 1 + dt R / rho to second order; here it is kicked as
 * everything else. */
static const struct op symplectic_op[] = {
    SAVE(KICKED), DRIFT(0.5), KICK(0.5), EVALUATE(0.5), KICK_SAVED(1.0), DRIFT(0.5), EVALUATE(1.0),
};

const struct integrator integrator_symplectic = {
    .name = "symplectic",
    .doc = "DualSPHysics' two-step position Verlet: symplectic in x and v, stable to w = 2; "
           "among kicked properties it grows by w^4 / 8",
    .source = "Dominguez et al. (2022), Comput. Part. Mech. 9, 867; density without its factor",
    .order = 2,
    .evaluations = 2,
    .knee = 1.2,
    OPS(symplectic_op),
};
