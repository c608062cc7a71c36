/* opencl/stage_cost.h -- what a stage costs a device, as far as texts and columns tell it: operations, and bytes that
 * must come and go at least. What is measured is held against this (run/device_report.c). Knows no OpenCL. */
#ifndef OPENCL_STAGE_COST_H
#define OPENCL_STAGE_COST_H

#include "opencl/arena.h"
#include "opencl/stages.h"

struct stage_cost {
    double *pair;                /* [stage->n]: operations of a pair in that pass; 0: it has none */
    double geometry;             /* of a pair, whatever bodies follow: distance, root, is it near */
    double own_flops, own_bytes; /* of a destination */
    double *
        source_bytes; /* [plan->n_array]: of a particle that is a source, beyond what it is read for as a
                           * destination */
};

int stage_cost_make(struct stage_cost *c, const struct plan *plan, const struct arena *arena,
                    const struct stage *s, struct error *e);
void stage_cost_free(struct stage_cost *c);

#endif
