/* integrators/runge_kutta.c -- Runge-Kutta methods: each treats all properties alike, whether the rates depend
 * on them or not. The last evaluation of a step is the first of the next. */
#include "integrators/families.h"

static const struct op rk2_op[] = {
    SAVE(ALL),        DRIFT(0.5),      KICK(0.5),     EVALUATE(0.5),
    DRIFT_SAVED(1.0), KICK_SAVED(1.0), EVALUATE(1.0),
};

const struct integrator integrator_rk2 = {
    .name = "rk2",
    .doc = "explicit midpoint rule: any oscillation grows, by w^4 / 8",
    .source =
        "Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), table II.1.1",
    .order = 2,
    .evaluations = 2,
    .knee = 1.2,
    OPS(rk2_op),
};

/* w0 (saved) + w (what is there, and one Euler step a from it) */
#define BLEND(on, w0, w) OP_MAKE(OP_COMBINE, on, SLOT_NOW, w, w0, 0.0, w, 0.0)

static const struct op ssp_rk3_op[] = {
    SAVE(ALL),
    DRIFT(1.0),
    KICK(1.0),
    EVALUATE(1.0),
    BLEND(DRIFTING, 3.0 / 4.0, 1.0 / 4.0),
    BLEND(KICKED, 3.0 / 4.0, 1.0 / 4.0),
    EVALUATE(0.5),
    BLEND(DRIFTING, 1.0 / 3.0, 2.0 / 3.0),
    BLEND(KICKED, 1.0 / 3.0, 2.0 / 3.0),
    EVALUATE(1.0),
};

const struct integrator integrator_ssp_rk3 = {
    .name = "ssp-rk3",
    .doc = "strong-stability-preserving Runge-Kutta of third order: damps oscillations by w^4 / "
           "24, stable to w = sqrt 3",
    .source = "Shu & Osher (1988), J. Comput. Phys. 77, 439, eq. 2.18",
    .order = 3,
    .evaluations = 3,
    .knee = 1.6,
    OPS(ssp_rk3_op),
};

/* In y.1 the step is summed up. */
#define SUM_BEGIN(a) OP_MAKE(OP_COMBINE, ALL, SLOT_1, 1.0, 0.0, 0.0, a, 0.0)
#define SUM(a) OP_MAKE(OP_COMBINE, ALL, SLOT_1, 0.0, 0.0, 1.0, a, 0.0)
#define SUM_END(on, a) OP_MAKE(OP_COMBINE, on, SLOT_NOW, 0.0, 0.0, 1.0, a, 0.0)

static const struct op rk4_op[] = {
    SAVE(ALL),
    SUM_BEGIN(1.0 / 6.0),
    DRIFT(0.5),
    KICK(0.5),
    EVALUATE(0.5),
    SUM(1.0 / 3.0),
    DRIFT_SAVED(0.5),
    KICK_SAVED(0.5),
    EVALUATE(0.5),
    SUM(1.0 / 3.0),
    DRIFT_SAVED(1.0),
    KICK_SAVED(1.0),
    EVALUATE(1.0),
    SUM_END(DRIFTING, 1.0 / 6.0),
    SUM_END(KICKED, 1.0 / 6.0),
    EVALUATE(1.0),
};

const struct integrator integrator_rk4 = {
    .name = "rk4",
    .doc = "classical Runge-Kutta of fourth order: damps oscillations by w^6 / 144, stable to w "
           "= 2 sqrt 2",
    .source = "Kutta (1901), Z. Math. Phys. 46, 435; Hairer, Norsett & Wanner (1993), table II.1.2",
    .order = 4,
    .evaluations = 4,
    .knee = 2.0,
    OPS(rk4_op),
};
