/* sph/lanes-names.h -- how the words of lanes.h and lanes-scalar.h are named for each instruction set, and
 * what they know of kernels. */
#ifndef SPH_LANES_NAMES_H
#define SPH_LANES_NAMES_H

#include <sph/kernel-value.h>

#define SPH_CAT2(a, b) a##_##b
#define SPH_CAT(a, b) SPH_CAT2(a, b)
#define SPH_OF_ISA(name) SPH_CAT(name, SPH_ISA)
#define SPH_INLINE static inline __attribute__((always_inline, unused))

/* What a kernel's form has in common with many: a loop that is compiled for it needs no branches on
 * powers. Wendland's C2 and C4 in two and three dimensions; anything else. */
#define SPH_SHAPE_ANY 0
#define SPH_SHAPE_C2 1
#define SPH_SHAPE_C4 2

static inline int sph_kernel_shape(const sph_kernel_form *k)
{
    const sph_kernel_piece *p = &k->piece[0];
    double e[SPH_KERNEL_COEFS];
    if (k->n_table || k->n_pieces != 1 || !sph_kernel_over_q(p, e))
        return SPH_SHAPE_ANY;
    if (p->power == 4 && p->n_coef == 2 && p->dpower == 3 && p->dn_coef == 2)
        return SPH_SHAPE_C2;
    if (p->power == 6 && p->n_coef == 3 && p->dpower == 5 && p->dn_coef == 3)
        return SPH_SHAPE_C4;
    return SPH_SHAPE_ANY;
}

#endif
