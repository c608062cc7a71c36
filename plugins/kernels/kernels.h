/* kernels.h -- the kernels of this plugin, by family. */
#ifndef KERNELS_H
#define KERNELS_H

#include <sph/kernel.h>

#define PI 3.14159265358979323846

#define N_BSPLINES 3
#define N_WENDLANDS 3
extern const sph_kernel bspline[N_BSPLINES];
extern const sph_kernel wendland[N_WENDLANDS];
extern const sph_kernel gaussian;

#endif
