/* sph/point-loop.h -- expands a plugin's body of one particle into a loop over the destinations: what a
 * point function, `before` and `after` of a pair function or an equation of state do, one particle after
 * the other, in doubles, for one, two and three dimensions. The same text runs on devices. Define, then
 * include this (as often as there are loops in a file):
 *
 *   #define SPH_POINT_LOOP my_finish          name of the sph_range_fn that is made (static)
 *   #define SPH_POINT_IN(P) P(scalar, rho, RHO) P(vector, v, 3)
 *                                             what the body reads alone: rho, from declared property
 *                                             RHO; v[DIM]. The types are scalar, vector, matrix
 *                                             (g[DIM * DIM]), sym (s[DIM * (DIM + 1) / 2]) and int32
 *                                             (an int)
 *   #define SPH_POINT_OUT(P) ...              what it sets, in any case, whatever it was
 *   #define SPH_POINT_INOUT(P) ...            what it reads and sets, or leaves as it is
 *   #define SPH_POINT_PARAM(P) P(alpha, 0)    parameter 0 as a number named alpha
 *   #define SPH_POINT_STATE(P) P(own, 0)      number 0 of the use's state, which must begin with
 *                                             doubles then, named own; `create` and `prepare` set it
 *   #define SPH_POINT_H                       optional: h, the smoothing length. In functions of pairs
 *   #define SPH_POINT_FAIL "...", "..."       optional: sentences for sph_fail
 *   #define SPH_POINT_BODY "my.body.h"        the body, found by the include path
 *   #define SPH_POINT_DEVICE my_device        optional: the same body for devices, a static const
 *                                             sph_device_point for device_run, device_before or
 *                                             device_after of sph_function or device of sph_eos
 *   #define SPH_POINT_PRELUDE "my_macros.h"   with it, if the body uses macros of its own: their file,
 *                                             which you include before
 *   #include <sph/point-loop.h>
 *
 * Leave out the lists that are not needed. A property stands in one list at most, and once. No property
 * that is read by the sweep alone (SPH_DST_SWEEP): it is not there.
 *
 * The body is C and OpenCL C at once. It may branch and loop; R and T are double, B is an int; it has
 *   DIM; the names of the lists; h, if asked for; b->time, b->dt, b->step;
 *   the words of lanes.h but for those of pairs: sph_select, sph_min, sph_max, sph_abs, sph_sqrt,
 *   sph_rsqrt, sph_sign, sph_exp, sph_log, sph_pow, sph_ipow; of C's functions those that OpenCL has,
 *   among them fabs, fmin, fmax, sqrt, exp, log, log1p, pow, cbrt, sin, cos, floor, isfinite;
 *   K, the kernel: K->support, sph_w(K, q), sph_dw(K, q), sph_dw_q(K, q);
 *   sph_fail(k), with which the run ends, saying sentence k. It need not return at once on a device:
 *   what the body computes after it goes nowhere, but it must come to its end.
 * No includes, no return, no function of its own (macros in the prelude), no pointers, no array whose size
 * is not a constant; numbers of type double, int, uint32_t; no names that OpenCL C keeps for itself
 * (half, kernel, global, local, constant, private, uint, ...).
 *
 * What is the same for all particles and costs much belongs into `prepare` and SPH_POINT_STATE; what is
 * cheap, such as alpha * alpha, compilers take out of the loop. Where the body is simple and has few
 * branches, several particles are worked on at a time.
 *
 * Embedding needs what pair-loop.h says of SPH_LOOP_DEVICE: the body's folder by -I, each name once in a
 * plugin. */

#include <math.h>
#include <sph/batch.h>
#include <sph/device.h>
#include <sph/function.h>
#include <sph/item.h>
#include <sph/lanes-names.h>

#ifndef SPH_POINT_IN
#define SPH_POINT_IN(P)
#endif
#ifndef SPH_POINT_OUT
#define SPH_POINT_OUT(P)
#endif
#ifndef SPH_POINT_INOUT
#define SPH_POINT_INOUT(P)
#endif
#ifndef SPH_POINT_PARAM
#define SPH_POINT_PARAM(P)
#endif
#ifndef SPH_POINT_STATE
#define SPH_POINT_STATE(P)
#endif

#ifdef SPH_POINT_FAIL
static const char *const SPH_CAT(SPH_POINT_LOOP, sentence)[] = {SPH_POINT_FAIL};
#endif

#define SPH_F32_WORDS 0
#define SPH_ISA one_f64
#ifndef SPH_LANES_one_f64
#define SPH_LANES_one_f64
#define SPH_REAL double
#include <sph/lanes-scalar.h>
#undef SPH_REAL
#endif
#define DIM 1
#include <sph/point-range.h>
#undef DIM
#define DIM 2
#include <sph/point-range.h>
#undef DIM
#define DIM 3
#include <sph/point-range.h>
#undef DIM
#undef SPH_ISA
#undef SPH_F32_WORDS

static sph_status SPH_POINT_LOOP(const sph_batch *b)
{
    if (b->real == SPH_F32)
        return b->host ? b->host->fail(b->host, SPH_E_INVALID, "this loop is for doubles")
                       : SPH_E_INVALID;
    return b->dim == 1   ? SPH_CAT(SPH_POINT_LOOP, 1)(b)
           : b->dim == 2 ? SPH_CAT(SPH_POINT_LOOP, 2)(b)
                         : SPH_CAT(SPH_POINT_LOOP, 3)(b);
}

#ifdef SPH_POINT_DEVICE
#include <sph/point-device.h>
#endif

#undef SPH_POINT_LOOP
#undef SPH_POINT_IN
#undef SPH_POINT_OUT
#undef SPH_POINT_INOUT
#undef SPH_POINT_PARAM
#undef SPH_POINT_STATE
#undef SPH_POINT_H
#undef SPH_POINT_FAIL
#undef SPH_POINT_BODY
#undef SPH_POINT_DEVICE
#undef SPH_POINT_PRELUDE
