/* sph/pair-loop.h -- expands a plugin's pair body into the loops of a sweep: for one, two and three
 * dimensions, for each instruction set and precision, and without vectors at all (SPH_PATH_... in
 * batch.h): over the destinations of a group, the sources broadcast (pair-group.h), or where vectors
 * are short over the sources of one destination (pair-list.h). Define, then include this (as often as
 * there are sweeps in a file):
 *
 *   #define SPH_LOOP my_sweep                 name of the sph_range_fn that is made (static)
 *   #define SPH_LOOP_I(S, V, M) S(rho, 2)     destination values: rho_i from declared property 2;
 *                                             V: vectors v_i[DIM]; M: matrices g_i[DIM * DIM]
 *   #define SPH_LOOP_J(S, V, M) S(m, 3)       source values: m_j
 *   #define SPH_LOOP_SUM(S, V, M) S(s, 4)     accumulators s (scalar), a[DIM], g[DIM * DIM]: they
 *                                             start at 0 and are added to declared property 4
 *   #define SPH_LOOP_MIN(S) S(dt, 5)          likewise by minimum; SPH_LOOP_MAX by maximum
 *   #define SPH_LOOP_PARAM(P) P(alpha, 0)     parameter 0 as a T named alpha
 *   #define SPH_LOOP_REACH SPH_SYMMETRIC      or SPH_GATHER
 *   #define SPH_LOOP_SELF 1                   1: the body also gets the self pair (r = 0)
 *   #define SPH_LOOP_BODY "my_sweep.body.h"   the body, found by the include path
 *   #define SPH_LOOP_BODY_2 "other.body.h"    optional, as _3 and _4: more bodies of the same pair,
 *                                             in one sweep (fusion.h)
 *   #define SPH_LOOP_F32                      optional: floats too (say so in sph_function.reals)
 *   #define SPH_LOOP_UNIFORM_H                optional: loops of their own for smoothing lengths that
 *                                             are all the same, where h_j is h_i
 *   #define SPH_LOOP_ANY_KERNEL               optional, for sweeps that are seldom run: no kernels
 *                                             are compiled in, a third of the code
 *   #define SPH_LOOP_DEVICE my_device         optional: the same body for devices, see below
 *   #include <sph/pair-loop.h>
 *
 * Leave out the lists that are not needed. Within the body there are besides:
 *   DIM; dx[DIM] = x_i - x_j; r2, r, rinv (1 / r, 0 for the self pair); h_i, hinv_i, h_j, hinv_j;
 *   K, the kernel; in, the mask of lanes that are within reach; sph_add(acc, value),
 *   sph_sub(acc, value), sph_take_min(acc, value), sph_take_max(acc, value), which touch those lanes only: a body may
 *   give NaN in the others; b, the batch (b->time, b->dt). See lanes.h for the words.
 * The kernel's argument is r * hinv; W(r, h) = sph_ipow(hinv, DIM) * sph_w(K, r * hinv) and
 * dW/dr = sph_ipow(hinv, DIM + 1) * sph_dw(K, r * hinv).
 *
 * With SPH_LOOP_DEVICE there is besides a `static const sph_device_body my_device`, for the member
 * `device` of sph_function: these lists, and the text of the very file SPH_LOOP_BODY, which the
 * assembler embeds (.incbin). For that the body's folder must be given by -I: gcc hands -iquote to
 * its preprocessor alone, and the assembler says "file not found". (With -flto, also by -Wa,-I: it
 * is run as the plugin is linked.) Each such name may stand once in a plugin, or the linker finds a
 * multiple definition.
 * device.h says what a body for a device may hold. If it uses macros, put them into a file that you
 * include before, and embed that too:
 *   #define SPH_LOOP_PRELUDE "my_macros.h" */

#include <math.h>
#include <sph/batch.h>
#include <sph/device.h>
#include <sph/function.h>
#include <sph/item.h>
#include <sph/kernel-value.h>

#ifndef SPH_LOOP_I
#define SPH_LOOP_I(S, V, M)
#endif
#ifndef SPH_LOOP_J
#define SPH_LOOP_J(S, V, M)
#endif
#ifndef SPH_LOOP_SUM
#define SPH_LOOP_SUM(S, V, M)
#endif
#ifndef SPH_LOOP_MIN
#define SPH_LOOP_MIN(S)
#endif
#ifndef SPH_LOOP_MAX
#define SPH_LOOP_MAX(S)
#endif
#ifndef SPH_LOOP_PARAM
#define SPH_LOOP_PARAM(P)
#endif
#ifndef SPH_LOOP_REACH
#define SPH_LOOP_REACH SPH_SYMMETRIC
#endif
#ifndef SPH_LOOP_SELF
#define SPH_LOOP_SELF 0
#endif

#ifdef SPH_LOOP_F32
#define SPH_EACH_F32
#endif
#define SPH_EACH_ISA <sph/pair-dims.h>
#include <sph/each-isa.h>
#undef SPH_EACH_ISA
#undef SPH_EACH_F32
#include <sph/pair-references.h>

/* Of one instruction set and precision, by dimension and shape of the kernel. */
#define SPH_LOOP_OF(isa, dim, shape) SPH_CAT(SPH_CAT(SPH_CAT(SPH_LOOP, isa), dim), shape)
#define SPH_LOOPS_ANY(isa, dim)                                                                    \
    {                                                                                              \
        SPH_LOOP_OF(isa, dim, 0), SPH_LOOP_OF(isa, dim, 0), SPH_LOOP_OF(isa, dim, 0),              \
            SPH_LOOP_OF(isa, dim, 0), SPH_LOOP_OF(isa, dim, 0)                                     \
    }
#if defined(SPH_LOOP_ANY_KERNEL)
#define SPH_LOOPS_SHAPED(isa, dim) SPH_LOOPS_ANY(isa, dim)
#elif defined(SPH_LOOP_UNIFORM_H)
#define SPH_LOOPS_SHAPED(isa, dim)                                                                 \
    {                                                                                              \
        SPH_LOOP_OF(isa, dim, 0), SPH_LOOP_OF(isa, dim, 1), SPH_LOOP_OF(isa, dim, 2),              \
            SPH_LOOP_OF(isa, dim, 3), SPH_LOOP_OF(isa, dim, 4)                                     \
    }
#else
#define SPH_LOOPS_SHAPED(isa, dim)                                                                 \
    {                                                                                              \
        SPH_LOOP_OF(isa, dim, 0), SPH_LOOP_OF(isa, dim, 1), SPH_LOOP_OF(isa, dim, 2),              \
            SPH_LOOP_OF(isa, dim, 1), SPH_LOOP_OF(isa, dim, 2)                                     \
    }
#endif
#define SPH_LOOPS(isa)                                                                             \
    {                                                                                              \
        {0, 0, 0, 0, 0}, SPH_LOOPS_ANY(isa, 1), SPH_LOOPS_SHAPED(isa, 2), SPH_LOOPS_SHAPED(isa, 3) \
    }

static sph_status SPH_LOOP(const sph_batch *b)
{
    static const sph_range_fn reference[2][4] = {
        {0, SPH_CAT(SPH_CAT(SPH_LOOP, one_f64), 1), SPH_CAT(SPH_CAT(SPH_LOOP, one_f64), 2),
         SPH_CAT(SPH_CAT(SPH_LOOP, one_f64), 3)},
        {0, SPH_CAT(SPH_CAT(SPH_LOOP, one_f80), 1), SPH_CAT(SPH_CAT(SPH_LOOP, one_f80), 2),
         SPH_CAT(SPH_CAT(SPH_LOOP, one_f80), 3)}};
    static const sph_range_fn loop[3][2][4][5] = {
#ifdef SPH_LOOP_F32
        {SPH_LOOPS(base_f64), SPH_LOOPS(base_f32)},
#else
        {SPH_LOOPS(base_f64)},
#endif
#if defined(__x86_64__) && !defined(SPH_NO_MULTIVERSION)
#ifdef SPH_LOOP_F32
        {SPH_LOOPS(avx2_f64), SPH_LOOPS(avx2_f32)},
        {SPH_LOOPS(avx512_f64), SPH_LOOPS(avx512_f32)},
#else
        {SPH_LOOPS(avx2_f64)},
        {SPH_LOOPS(avx512_f64)},
#endif
#endif
    };
    const uint32_t path = b->path % SPH_PATH_ANY_KERNEL;
    const int known = b->path < SPH_PATH_ANY_KERNEL ? sph_kernel_shape(b->kernel) : SPH_SHAPE_ANY;
    const int shape = known && b->uniform_h ? known + 2 : known;
    const int f32 = b->real == SPH_F32;
    int isa = 0;
#if defined(__x86_64__) && !defined(SPH_NO_MULTIVERSION)
    if (SPH_HAS_AVX2 && path != SPH_PATH_BASE)
        isa = SPH_HAS_AVX512 && path != SPH_PATH_AVX2 ? 2 : 1;
#endif
    if (!f32 && (path == SPH_PATH_REFERENCE || path == SPH_PATH_EXTENDED))
        return reference[path == SPH_PATH_EXTENDED][b->dim](b);
    if (!loop[isa][f32][b->dim][shape])
        return b->host ? b->host->fail(b->host, SPH_E_INVALID, "this loop is for doubles")
                       : SPH_E_INVALID;
    return loop[isa][f32][b->dim][shape](b);
}
#undef SPH_LOOP_OF
#undef SPH_LOOPS_ANY
#undef SPH_LOOPS_SHAPED
#undef SPH_LOOPS_LIST
#undef SPH_LOOPS

#ifdef SPH_LOOP_DEVICE
#include <sph/pair-device.h>
#endif

#undef SPH_LOOP
#undef SPH_LOOP_I
#undef SPH_LOOP_J
#undef SPH_LOOP_SUM
#undef SPH_LOOP_MIN
#undef SPH_LOOP_MAX
#undef SPH_LOOP_PARAM
#undef SPH_LOOP_REACH
#undef SPH_LOOP_SELF
#undef SPH_LOOP_BODY
#undef SPH_LOOP_BODY_2
#undef SPH_LOOP_BODY_3
#undef SPH_LOOP_BODY_4
#undef SPH_LOOP_F32
#undef SPH_LOOP_ANY_KERNEL
#undef SPH_LOOP_UNIFORM_H
#undef SPH_LOOP_DEVICE
#undef SPH_LOOP_PRELUDE
