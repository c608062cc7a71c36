/* registry/kernel_form.h -- compiles a kernel's descriptor for one dimension into the form that
 * loops evaluate: its terms gathered by knot, with the derivative in the same form. */
#ifndef REGISTRY_KERNEL_FORM_H
#define REGISTRY_KERNEL_FORM_H

#include "base/error.h"
#include <sph/batch.h>
#include <sph/kernel.h>

/* k: a registered kernel, or one with lists of today's stride. Pieces are ordered by knot, the
 * outermost first. Fails (EXIT_USAGE) if the kernel does not work in that dimension, or
 * (EXIT_REFUSED) has more knots or powers than the form holds. */
int kernel_form_make(sph_kernel_form *out, const sph_kernel *k, int dim, struct error *e);

/* W h^dim and dW/dr h^(dim+1) at q = r / h. */
double kernel_form_w(const sph_kernel_form *f, double q);
double kernel_form_dw(const sph_kernel_form *f, double q);

#endif
