/* opencl/pair_source.h -- writes the OpenCL C of a sweep: a plugin's pair body (sph/device.h)
 * between the words that it is written in and the loop over a group's sources. Text alone; needs
 * no OpenCL. */
#ifndef OPENCL_PAIR_SOURCE_H
#define OPENCL_PAIR_SOURCE_H

#include "base/error.h"
#include <sph/batch.h>
#include <sph/device.h>
#include <stdbool.h>
#include <stddef.h>

#define PAIR_KERNEL "sph_sweep"

/* A declared property that the kernel is handed, of the destinations or of the sources. */
struct pair_column {
    uint32_t index, type;
    bool source, written;
};

/* All of them, each once, in the order of the kernel's arguments; the caller frees *out. */
int pair_columns(struct pair_column **out, size_t *n, const sph_device_body *d, struct error *e);

/* The whole source for one dimension; the caller frees it. NULL: no memory. The kernel's arguments
 * are
 *   ulong count, n_src, first, base; uint same, absolute; double time, dt; ulong step;
 *   begin, list, kernel form, kernel table, parameters; x and h of destinations, of sources;
 *   the columns of pair_columns, packed: component c of the destination first + k is element
 *   c * count + k, of the source j element c * n_src + j.
 * list[begin[g] - base] is the first source of the range's group g.
 * `measured`: with the argument `absolute` at 1, sums are of the terms' absolute values, which tell
 * what rounding may do to them; without, that argument means nothing. */
char *pair_source(const sph_device_body *d, int dim, bool measured, struct error *e);

#endif
