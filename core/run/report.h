/* run/report.h -- what a run says of itself at the end: errors against exact solutions, probes, conservation,
 * cost. */
#ifndef RUN_REPORT_H
#define RUN_REPORT_H

#include "io/summary.h"
#include "run/run.h"

/* Errors of every comparison of the scene; *out is freed with report_errors_free. Norms over the particles of
 * the region: l1 = sum V |f - f*| / sum V, l1_rel = sum V |f - f*| / sum V |f*|, l2 = sqrt(sum V |f - f*|^2 /
 * sum V), linf the maximum; V = m / rho; of a vector, | | is its length. */
int report_errors(const struct run *r, struct summary_error **out, size_t *n, struct error *e);
void report_errors_free(struct summary_error *errors, size_t n);
/* Values of the scene's probes; NaN where nothing is found. */
int report_probes(const struct run *r, struct summary_probe **out, size_t *n, struct error *e);

#endif
