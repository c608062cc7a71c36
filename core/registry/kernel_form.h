/* registry/kernel_form.h -- compiles a kernel's descriptor for one dimension into the form that
 * loops evaluate: its terms gathered by knot, with the derivative in the same form. */
#ifndef REGISTRY_KERNEL_FORM_H
#define REGISTRY_KERNEL_FORM_H

#include "base/error.h"
#include <sph/batch.h>
#include <sph/kernel.h>

/* Cells of the table of a kernel that is given as a function: its cubics are right to 1e-12 (value) and
 * 1e-9 (slope) for a function whose fourth derivative is of order 1. */
#define KERNEL_FORM_CELLS 1024u

/* k: a registered kernel, or one with lists of today's stride. Pieces are ordered by knot, the
 * outermost first. Fails (EXIT_USAGE) if the kernel does not work in that dimension, or
 * (EXIT_REFUSED) has more knots or powers than the form holds. Then and afterwards: fini. */
int kernel_form_make(sph_kernel_form *out, const sph_kernel *k, int dim, struct error *e);

void kernel_form_fini(sph_kernel_form *f);

/* W h^dim and dW/dr h^(dim+1) at q = r / h. */
double kernel_form_w(const sph_kernel_form *f, double q);
double kernel_form_dw(const sph_kernel_form *f, double q);

#endif
