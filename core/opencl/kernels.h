/* opencl/kernels.h -- stages as kernels: their OpenCL C out of the plugins' bodies, and their launch. */
#ifndef OPENCL_KERNELS_H
#define OPENCL_KERNELS_H

#include "opencl/arena.h"
#include "opencl/lists.h"
#include "opencl/stages.h"

/* What bodies may ask of the moment, beside particles. */
struct kernel_now {
    double time, dt, quantum;
    uint64_t step;
    bool uniform_h; /* one smoothing length for all */
    uint32_t
        sweep; /* of a stage that iterates, from 0: from 1 on only groups with an unfinished one */
};

struct kernels;

/* Builds all stages into one program for this device: vectors of SPH_LANES where facts->cpu, a work item a
 * destination elsewhere. arena: [plan->n_array]. A body that does not build fails with EXIT_REFUSED and
 * its own file and line. */
int kernels_make(struct kernels **out, struct device *d, const struct plan *plan,
                 const struct arena *arena, const struct stage *stage, size_t n_stage,
                 struct error *e);
/* The same in the form that is asked for. */
int kernels_make_as(struct kernels **out, struct device *d, const struct plan *plan,
                    const struct arena *arena, const struct stage *stage, size_t n_stage,
                    bool vectors, struct error *e);
void kernels_free(struct kernels *k);
/* What the stage's time is told under: the names of its passes with "+" between them. The caller frees it. */
char *stage_label(const struct plan *plan, const struct stage *s);

/* Parameters and numbers of states as they are now go to the device, if they have changed. */
int kernels_update(struct kernels *k, struct error *e);
/* Stage s on all its destinations. list: [plan->n_list]. Ghosts and mirrors are right. Of a stage that iterates:
 * one sweep. */
int kernels_launch(struct kernels *k, size_t s, const struct arena *arena,
                   const struct device_list *list, const struct kernel_now *now, struct error *e);
/* Whether a body has said sph_fail since last asked: then *failed is true, and e says so as of the plugin (EXIT_RUN),
 * though 0 is returned; -1 is the device's own failure. Waits. */
int kernels_failed(struct kernels *k, bool *failed, struct error *e);
/* The whole source, for people; the caller frees it. */
char *kernels_source(const struct plan *plan, const struct arena *arena, const struct stage *stage,
                     size_t n_stage, bool vectors, struct error *e);

#endif
