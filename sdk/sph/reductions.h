/* sph/reductions.h -- extension: the global sums, minima and maxima that functions declare
 * (sph_function.reductions), for other functions to use: the largest signal speed, the force on a
 * body. Taken over all particles of all arrays that the function acts on, on all ranks. */
#ifndef SPH_REDUCTIONS_H
#define SPH_REDUCTIONS_H

#include <sph/batch.h>

SPH_BEGIN_DECLS

#define SPH_EXT_REDUCTIONS "sph.reductions/0"

typedef struct sph_reductions {
    uint32_t size, reserved;
    /* What reduction `name` of `function` came to when its pass last ran, in the property's unit; a
     * step that stands later in the recipe gets this evaluation's value, an earlier one the last
     * evaluation's. Over no particles a sum is 0, a minimum inf, a maximum -inf. NaN before the first, where there is no such reduction in this run, and without
     * a run (batch->run NULL). [any] */
    double (*value)(const sph_batch *, const char *function, const char *name);
} sph_reductions;

SPH_END_DECLS
#endif
