/* run/region.h -- which particles a comparison or a probe looks at, and their values. */
#ifndef RUN_REGION_H
#define RUN_REGION_H

#include "plan/plan.h"

/* Component c of particle i. */
static inline double region_value(const struct column *column, uint32_t c, size_t i)
{
    return column_get(column, c, i);
}

/* inside[i]: particle i lies in the region `where`, an expression of x, y, z, r (NULL: everywhere). */
int region_select(const struct plan_array *a, const char *where, bool *inside, struct error *e);

#endif
