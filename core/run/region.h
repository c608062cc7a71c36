/* run/region.h -- which particles a comparison or a probe looks at. */
#ifndef RUN_REGION_H
#define RUN_REGION_H

#include "plan/plan.h"

/* inside[i]: particle i lies in the region `where`, an expression of x, y, z, r (NULL: everywhere). */
int region_select(const struct plan_array *a, const char *where, bool *inside, struct error *e);

#endif
