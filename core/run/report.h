/* run/report.h -- what is measured of the particles as they are now: errors against references, probes,
 * profiles. When that is, and where it is written: measures.h. */
#ifndef RUN_REPORT_H
#define RUN_REPORT_H

#include "io/summary.h"
#include "run/run.h"

/* Errors of a comparison of the scene (norms.h), added to *out, which is freed with compare_free. */
int compare_take(const struct run *r, size_t index, struct summary_error **out, size_t *n,
                 struct error *e);
void compare_free(struct summary_error *errors, size_t n);
/* The number that a probe of all particles is; NaN where nothing is found. */
int probe_take(const struct run *r, size_t index, double *out, struct error *e);
/* row[bins][2 n_of + 1]: mean and standard deviation of each property, weighted by the particles' volumes, then
 * how many there are. NaN in empty bins. A value at max counts to the last bin. */
int profile_bins(const struct run *r, const struct scene_profile *p, double *row, struct error *e);

#endif
