/* opencl/stages.h -- passes that share a kernel. What a plan's passes do one after the other is cut into
 * stages: in a stage every destination does all of its passes without looking at what others do in it. Where
 * stages allow it pair passes of one array share a sweep, whatever plugins they come from. Plan logic alone;
 * knows no OpenCL. */
#ifndef OPENCL_STAGES_H
#define OPENCL_STAGES_H

#include "plan/plan.h"

/* Within a stage a destination does, in this order: point passes in front of the first pair pass; of each pair
 * pass accumulators to their start, then `before`; the sweeps, source array by source array, all bodies at
 * once; then, in the order of the passes, `after` of pair passes and the point passes behind the first. */
struct stage {
    size_t array; /* of destinations */
    size_t *pass; /* indices into plan.pass, ascending */
    size_t n;
    size_t n_head; /* point passes in front of the first pair pass; n: there is none */
    uint32_t real; /* of its sweeps: SPH_F64 or SPH_F32 */
    size_t frame;  /* of its lists */
    bool iterates; /* one pass with max_sweeps */
    /* One pair pass that writes what its sweeps read of others (!pass.local): reset and `before`, the sweeps,
     * `after` are launched one behind the other, each for all. */
    bool phased;
};

/* Of all passes of a moment, in order. `fuse` false: a pass a stage. */
int stages_plan(const struct plan *plan, enum moment moment, bool fuse, struct stage **out,
                size_t *n, struct error *e);
void stages_free(struct stage *stage, size_t n);

#endif
