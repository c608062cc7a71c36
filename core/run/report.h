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

/* The middle of bin k. */
static inline double profile_middle(const struct scene_profile *p, size_t k)
{
    return p->min + (p->max - p->min) * (((double)k + 0.5) / (double)p->bins);
}
/* What a profile's reference says now: value[n][n_of] at n places (a bin's: the middle of it on the line through
 * the center along its coordinate; of r, along x, or y where x is the axis). NaN where it says nothing. */
int profile_reference(const struct run *r, size_t index, size_t n, double *value, struct error *e);
/* The fields of an exact solution for a batch of n places, now. */
int exact_run(const struct run *r, const struct use *use, const sph_column *column, size_t n,
              struct error *e);

#endif
