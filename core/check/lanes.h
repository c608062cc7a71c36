/* check/lanes.h -- a kernel as the vector loops of the SDK evaluate it. */
#ifndef CHECK_LANES_H
#define CHECK_LANES_H

#include <sph/batch.h>
#include <stdbool.h>
#include <stddef.h>

/* Instruction sets that this processor has, each in doubles and in floats. */
size_t lanes_count(void);
const char *lanes_name(size_t set);
bool lanes_of_floats(size_t set);

/* W h^dim, dW/dr h^(dim+1), and the latter over q. */
struct lanes_out {
    double *w, *dw, *dw_q;
};

/* At n points (a multiple of 8; floats where the set is of those) with set `set`; as loops do that
 * have the kernel compiled in, if there are such for it, or as all others. */
void lanes_kernel(size_t set, const sph_kernel_form *form, const double *q, bool compiled_in,
                  const struct lanes_out *out, size_t n);

#endif
