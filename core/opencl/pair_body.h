/* opencl/pair_body.h -- a plugin's pair body built for one OpenCL device, and run there on a batch:
 * the reference for what a device makes of it. Each run carries the columns over and back. */
#ifndef OPENCL_PAIR_BODY_H
#define OPENCL_PAIR_BODY_H

#include "base/error.h"
#include <sph/batch.h>
#include <sph/function.h>
#include <stdbool.h>
#include <stddef.h>

struct pair_body;

/* The first device that has double precision, as opencl_devices numbers them. Fails with the
 * sentence why there is none: built without OpenCL, no device, no double. */
int pair_body_device(size_t *device, struct error *e);

/* Builds the body of f->device (a registered function's, which must outlive it) for a dimension.
 * `measured`: it can be asked for the sums of absolute terms, too. Fails (EXIT_REFUSED) if the text
 * does not compile, naming its file and line; (EXIT_RUN) if the device fails.
 *
 * Built with no option that relaxes IEEE arithmetic: division and square root are exact to half an
 * ulp, NaN and infinity are kept. a * b + c may become one fused operation, which rounds once
 * instead of twice, as it may in the native build: the two differ by that. */
int pair_body_build(struct pair_body **out, size_t device, const sph_function *f, int dim,
                    bool measured, struct error *e);
void pair_body_free(struct pair_body *p);

/* Of the device. */
const char *pair_body_device_name(const struct pair_body *p);

/* Runs it on a batch of doubles, in place of f->run: adds to the accumulators of its range. Reads
 * and writes what the body names, x and h. `absolute`: adds the terms' absolute values, by which
 * rounding is measured. [one thread at a time] */
int pair_body_run(struct pair_body *p, const sph_batch *b, bool absolute, struct error *e);

#endif
