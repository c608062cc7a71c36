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
#include <stdio.h>

#define PAIR_KERNEL "sph_sweep"

/* A declared property that the kernel is handed, of the destinations or of the sources. */
struct pair_column {
    uint32_t index, type;
    bool source, written;
};

/* All of them, each once, in the order of the kernel's arguments; the caller frees *out. */
int pair_columns(struct pair_column **out, size_t *n, const sph_device_body *d, struct error *e);

/* The kernel W as the device's sph_kernel_form has it, the norm in the coefficients; e is of W' / q,
 * if that is such a sum (en_coef > 0). Written as its counterpart in pair_source.c. */
struct pair_form {
    double support, norm, cells;
    uint32_t n_table, n_pieces, en_coef, reserved;
    struct {
        double knot;
        uint32_t power, n_coef, dpower, dn_coef;
        double c[SPH_KERNEL_COEFS], d[SPH_KERNEL_COEFS], e[SPH_KERNEL_COEFS];
    } piece[SPH_KERNEL_KNOTS];
};
_Static_assert(SPH_KERNEL_COEFS == 6 && SPH_KERNEL_KNOTS == 4 &&
                   sizeof(struct pair_form) == 40 + 4 * 168,
               "sph_kernel_form in pair_source.c is another");
void pair_form(struct pair_form *out, const sph_kernel_form *form);

/* The words of bodies, of one double each, and the form of W; DIM is to be defined behind them. And a
 * text of the plugin, under the name of its file: compilers then speak of that file and its lines. */
void pair_source_words(FILE *out);
void pair_source_text(FILE *out, const char *text, const char *file);

/* The whole source for one dimension; the caller frees it. NULL: no memory. The kernel's arguments
 * are
 *   ulong count, n_src, first, base, least; uint same, absolute; double time, dt; ulong step;
 *   begin, spans, list, kernel form, kernel table, parameters; x and h of destinations, of sources;
 *   the columns of pair_columns, packed: component c of the destination first + k is element
 *   c * count + k, of the source j element c * n_src + j.
 * The lists are the batch's, from the first of the range on: spans[begin[g] - base] is the first of
 * the range's group g, and list[0] is the batch's list[least].
 * `measured`: with the argument `absolute` at 1, sums are of the terms' absolute values, which tell
 * what rounding may do to them; without, that argument means nothing. */
char *pair_source(const sph_device_body *d, int dim, bool measured, struct error *e);

#endif
