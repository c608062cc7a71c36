/* check/lanes.h -- a kernel as the vector loops of the SDK evaluate it. */
#ifndef CHECK_LANES_H
#define CHECK_LANES_H

#include <sph/batch.h>
#include <stddef.h>

/* Instruction sets that this processor has. */
size_t lanes_count(void);
const char *lanes_name(size_t set);
/* W h^dim and dW/dr h^(dim+1) at n points (a multiple of 8) with set `set`. */
void lanes_kernel(size_t set, const sph_kernel_form *form, const double *q, double *w, double *dw,
                  size_t n);

#endif
