/* integrators/euler.c -- the explicit Euler method: for comparison, and where a first order is enough. */
#include "integrators/families.h"

/* x by the old v: not the symplectic method of the same name. */
static const struct op euler_op[] = {DRIFT(1.0), KICK(1.0), EVALUATE(1.0)};

const struct integrator integrator_euler = {
    .name = "euler",
    .doc = "explicit Euler: any oscillation grows, by w^2 / 2",
    .source =
        "Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), section I.7",
    .order = 1,
    .evaluations = 1,
    .knee = 0.1,
    OPS(euler_op),
};
