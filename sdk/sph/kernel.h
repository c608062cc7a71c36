/* sph/kernel.h -- a smoothing kernel as data: a sum of clamped powers of q = r / h.
 *   W(r, h) = norm[dim] h^-dim  sum_k coef_k max(0, knot_k - q)^power_k
 * Every spline and Wendland function has this form. The host checks that it integrates to 1, to
 * 1e-10. At most SPH_KERNEL_KNOTS (4) different knots, each with powers that span at most
 * SPH_KERNEL_COEFS (6). */
#ifndef SPH_KERNEL_H
#define SPH_KERNEL_H

#include <sph/item.h>

SPH_BEGIN_DECLS

#define SPH_KIND_KERNEL "sph.kernel/0"
typedef struct sph_kernel_term {
    double coef;    /* a pure number */
    double knot;    /* in units of h, > 0 */
    uint32_t power; /* >= 2: the derivative must not jump */
    uint32_t reserved;
} sph_kernel_term;
#define SPH_KERNEL_TERM(coef, knot, power)                                                         \
    {                                                                                              \
        (coef), (knot), (power), 0u                                                                \
    }

/* What register_item takes for SPH_KIND_KERNEL. */
typedef struct sph_kernel {
    uint32_t size, reserved;
    const sph_item *item; /* params: none; props: none */
    double support;       /* in units of h; the largest knot */
    double norm[4];       /* norm[dim]; norm[0] unused; 0 where a dimension is not supported */
    sph_list terms[4];    /* of sph_kernel_term, by dimension (they may be one list); [0] unused */
    /* For a kernel of another form, slower: leave the terms empty and give W(q) and dW/dq in units
     * of norm[dim] h^-dim and norm[dim] h^-(dim+1), for 0 <= q <= support. Both smooth there; the
     * host takes 0 beyond and tabulates them once. NULL: not given. [any] */
    double (*value)(double q, uint32_t dim);
    double (*slope)(double q, uint32_t dim);
} sph_kernel;

SPH_END_DECLS
#endif
