/* opencl/point_body.h -- a plugin's body of one particle built for an OpenCL device, and run there on a
 * batch: what pair_body.h is to bodies of pairs. Each run carries the columns over and back. */
#ifndef OPENCL_POINT_BODY_H
#define OPENCL_POINT_BODY_H

#include "opencl/device.h"
#include <sph/batch.h>
#include <sph/device.h>

struct point_body;

/* Builds it for a dimension; the body and the device must outlive it. Fails (EXIT_REFUSED) if the text
 * does not compile, naming its file and line; (EXIT_RUN) if the device fails. */
int point_body_build(struct point_body **out, struct device *d, const sph_device_point *point,
                     int dim, struct error *e);
void point_body_free(struct point_body *p);

/* Runs it on a batch of doubles, in place of the native function. *failed: 0, or 1 + the number of the
 * sentence that a particle has ended with. [main] */
int point_body_run(struct point_body *p, const sph_batch *b, uint32_t *failed, struct error *e);

#endif
