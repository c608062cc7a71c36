/* paths.h -- sweeps with a bit of everything, compiled as a plugin's are: what test_pair_paths.c
 * runs by all paths. */
#ifndef PATHS_H
#define PATHS_H

#include <sph/function.h>

/* Declared properties. Each sum is followed by the sum of its absolute terms. */
enum {
    PATHS_M,
    PATHS_V,
    PATHS_G,
    PATHS_SUM,
    PATHS_SUM_ABS,
    PATHS_MIXED,
    PATHS_MIXED_ABS,
    PATHS_FLOW,
    PATHS_FLOW_ABS,
    PATHS_SHEAR,
    PATHS_SHEAR_ABS,
    PATHS_LEAST,
    PATHS_MOST,
    PATHS_COUNT
};

struct paths_sweep {
    const char *name;
    sph_range_fn run;
    uint32_t reach;
    int self;   /* the self pair too */
    int second; /* the second body too */
};
#define PATHS_SWEEPS 3
extern const struct paths_sweep paths_sweeps[PATHS_SWEEPS];

/* A loop that is for doubles alone. */
sph_status paths_doubles(const sph_batch *b);

/* SPH_SHAPE_...: for which kernels loops are compiled. */
int paths_shape(const sph_kernel_form *form);

#endif
