/* border_sweep.h -- the sweep that is measured on both sides of the border (border.c): included by
 * the plugin and by the program, compiled with the same flags. */
#ifndef BORDER_SWEEP_H
#define BORDER_SWEEP_H

#include <sph/plugin.h>

enum { BORDER_M, BORDER_RHO, BORDER_P, BORDER_V, BORDER_DRHO, BORDER_A };

#define SPH_LOOP border_sweep
#define SPH_LOOP_I(S, V, M) S(rho, BORDER_RHO) S(p, BORDER_P) V(v, BORDER_V)
#define SPH_LOOP_J(S, V, M) S(m, BORDER_M) S(rho, BORDER_RHO) S(p, BORDER_P) V(v, BORDER_V)
#define SPH_LOOP_SUM(S, V, M) S(drho, BORDER_DRHO) V(acc, BORDER_A)
#define SPH_LOOP_PARAM(P) P(alpha, 0)
#define SPH_LOOP_REACH SPH_SYMMETRIC
#define SPH_LOOP_BODY "border.body.h"
#include <sph/pair-loop.h>

#endif
