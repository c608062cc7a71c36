/* opencl/stages_tell.h -- how a plan would run on a device: its stages, what goes to and fro, its kernels' source. For
 * `sph plan`; needs no device. */
#ifndef OPENCL_STAGES_TELL_H
#define OPENCL_STAGES_TELL_H

#include "plan/plan.h"

/* For people (80 columns), behind plan_print; for machines, into the object that plan_json made. */
int stages_print(const struct plan *plan, FILE *out, struct error *e);
int stages_json(const struct plan *plan, cJSON *into, struct error *e);
/* The OpenCL C of all stages as `sph SCENE --device opencl` builds it: for a processor, else for a GPU. */
int stages_print_kernels(struct plan *plan, bool vectors, FILE *out, struct error *e);

#endif
