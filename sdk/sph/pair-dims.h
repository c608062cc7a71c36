/* sph/pair-dims.h -- one instruction set's loops of a sweep, for each dimension and for the kernels
 * that are compiled in; the inside of pair-loop.h. */

#include <sph/pair-words.h>

#ifdef SPH_FORM_LIST
#define SPH_LOOP_FORM <sph/pair-list.h>
#else
#define SPH_LOOP_FORM <sph/pair-group.h>
#endif
/* sweep_avx2_f64_3_0: the function's name; the last is the kernel's shape. */
#define SPH_LOOP_NAME SPH_LOOP_NAMED(DIM, SPH_SHAPE)
#define SPH_LOOP_NAMED(dim, shape) SPH_CAT(SPH_CAT(SPH_CAT(SPH_LOOP, SPH_ISA), dim), shape)

#define SPH_SHAPE 0
#define DIM 1
#include SPH_LOOP_FORM
#undef DIM
#define DIM 2
#include SPH_LOOP_FORM
#undef DIM
#define DIM 3
#include SPH_LOOP_FORM
#undef DIM
#undef SPH_SHAPE

#if !defined(SPH_LOOP_ANY_KERNEL)
#define SPH_SHAPE 1
#define DIM 2
#include SPH_LOOP_FORM
#undef DIM
#define DIM 3
#include SPH_LOOP_FORM
#undef DIM
#undef SPH_SHAPE
#define SPH_SHAPE 2
#define DIM 2
#include SPH_LOOP_FORM
#undef DIM
#define DIM 3
#include SPH_LOOP_FORM
#undef DIM
#undef SPH_SHAPE
#ifdef SPH_LOOP_UNIFORM_H
#define SPH_SHAPE 3
#define DIM 2
#include SPH_LOOP_FORM
#undef DIM
#define DIM 3
#include SPH_LOOP_FORM
#undef DIM
#undef SPH_SHAPE
#define SPH_SHAPE 4
#define DIM 2
#include SPH_LOOP_FORM
#undef DIM
#define DIM 3
#include SPH_LOOP_FORM
#undef DIM
#undef SPH_SHAPE
#endif
#endif

#undef SPH_LOOP_NAME
#undef SPH_LOOP_NAMED
#undef SPH_LOOP_FORM
#include <sph/pair-words.h>
