/* paths.c -- see paths.h. */
#include "paths.h"

#define PATHS_SUMS(S, V, M)                                                                        \
    S(sum, PATHS_SUM) S(sum_abs, PATHS_SUM_ABS) V(flow, PATHS_FLOW) V(flow_abs, PATHS_FLOW_ABS)

#define PATHS_Q(i, j) (i)
#define SPH_LOOP gathers
#define SPH_LOOP_I(S, V, M) S(m, PATHS_M) V(v, PATHS_V)
#define SPH_LOOP_J(S, V, M) SPH_LOOP_I(S, V, M)
#define SPH_LOOP_SUM PATHS_SUMS
#define SPH_LOOP_MIN(S) S(least, PATHS_LEAST)
#define SPH_LOOP_MAX(S) S(most, PATHS_MOST)
#define SPH_LOOP_PARAM(P) P(share, 0)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "paths.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_UNIFORM_H
#include <sph/pair-loop.h>
#undef PATHS_Q

/* In reach of either the root in the body is a number. */
#define PATHS_Q(i, j) sph_min((i), (j))
#define SPH_LOOP both
#define SPH_LOOP_I(S, V, M) S(m, PATHS_M) V(v, PATHS_V)
#define SPH_LOOP_J(S, V, M) SPH_LOOP_I(S, V, M)
#define SPH_LOOP_SUM PATHS_SUMS
#define SPH_LOOP_MIN(S) S(least, PATHS_LEAST)
#define SPH_LOOP_MAX(S) S(most, PATHS_MOST)
#define SPH_LOOP_PARAM(P) P(share, 0)
#define SPH_LOOP_BODY "paths.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_ANY_KERNEL
#include <sph/pair-loop.h>

#define SPH_LOOP seldom
#define SPH_LOOP_I(S, V, M) S(m, PATHS_M) V(v, PATHS_V) M(g, PATHS_G)
#define SPH_LOOP_J(S, V, M) SPH_LOOP_I(S, V, M)
#define SPH_LOOP_SUM(S, V, M)                                                                      \
    PATHS_SUMS(S, V, M)                                                                            \
    S(mixed, PATHS_MIXED)                                                                          \
    S(mixed_abs, PATHS_MIXED_ABS) M(shear, PATHS_SHEAR) M(shear_abs, PATHS_SHEAR_ABS)
#define SPH_LOOP_MIN(S) S(least, PATHS_LEAST)
#define SPH_LOOP_MAX(S) S(most, PATHS_MOST)
#define SPH_LOOP_PARAM(P) P(share, 0)
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "paths.body.h"
#define SPH_LOOP_BODY_2 "paths2.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_ANY_KERNEL
#include <sph/pair-loop.h>

#define SPH_LOOP doubles
#define SPH_LOOP_J(S, V, M) S(m, PATHS_M)
#define SPH_LOOP_SUM(S, V, M) S(sum, PATHS_SUM)
#define SPH_LOOP_BODY "paths3.body.h"
#define SPH_LOOP_ANY_KERNEL
#include <sph/pair-loop.h>

sph_status paths_doubles(const sph_batch *b)
{
    return doubles(b);
}

const struct paths_sweep paths_sweeps[PATHS_SWEEPS] = {
    {"gathers", gathers, SPH_GATHER, 1, 0},
    {"both", both, SPH_SYMMETRIC, 0, 0},
    {"seldom", seldom, SPH_SYMMETRIC, 1, 1},
};

int paths_shape(const sph_kernel_form *form)
{
    return sph_kernel_shape(form);
}
