/* sph/pair-references.h -- the reference loops of a sweep, for each precision and dimension; the
 * inside of pair-loop.h. */

#define SPH_F32_WORDS 0
#define SPH_ISA one_f64
#ifndef SPH_LANES_one_f64
#define SPH_LANES_one_f64
#define SPH_REAL double
#include <sph/lanes-scalar.h>
#undef SPH_REAL
#endif
#define DIM 1
#include <sph/pair-reference.h>
#undef DIM
#define DIM 2
#include <sph/pair-reference.h>
#undef DIM
#define DIM 3
#include <sph/pair-reference.h>
#undef DIM
#undef SPH_ISA

#define SPH_ISA one_f80
#ifndef SPH_LANES_one_f80
#define SPH_LANES_one_f80
#define SPH_REAL long double
#include <sph/lanes-scalar.h>
#undef SPH_REAL
#endif
#define DIM 1
#include <sph/pair-reference.h>
#undef DIM
#define DIM 2
#include <sph/pair-reference.h>
#undef DIM
#define DIM 3
#include <sph/pair-reference.h>
#undef DIM
#undef SPH_ISA
#undef SPH_F32_WORDS
