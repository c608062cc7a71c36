/* run/sample.h -- values at points, interpolated from the particles by the run's kernel:
 *   f(x) = sum_j V_j f_j W(|x - x_j|, h_j) / sum_j V_j W,  V = m / rho,
 * or without the division (Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551, eq. 2.5; the division:
 * Shepard 1968, doi:10.1145/800186.810616). Images behind periodic and mirror sides count like particles. */
#ifndef RUN_SAMPLE_H
#define RUN_SAMPLE_H

#include "run/run.h"

/* Below this sum of V W a point has too few neighbours for a value: NaN, unless the division is left out. */
#define SAMPLE_LEAST 0.1

/* value[n_point][n_of + 1]: the values asked for, then the sum of V W. The sums are over particles of all ranks
 * (sums.h), of a rank in their order: the same bits for any number of threads. Particles out of reach are left out in blocks by their bounds,
 * so that a point costs about a look at each block. */
int sample_take(const struct run *r, const struct scene_sample *s, double *value, struct error *e);

#endif
