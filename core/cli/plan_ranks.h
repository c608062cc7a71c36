/* cli/plan_ranks.h -- what `sph plan` tells under mpirun: how the ranks would share the domain, by the scene's way to
 * cut it and by the others, and what they would send. */
#ifndef CLI_PLAN_RANKS_H
#define CLI_PLAN_RANKS_H

#include "cli/scene_options.h"
#include "domain/partition.h"
#include "run/forecast.h"

struct plan_ranks {
    size_t chosen; /* enum partitioner */
    struct forecast by[PARTITIONERS];
};

/* All ranks call it; each way is tried with particles made anew. To be freed in any case. */
int plan_ranks_make(struct plan_ranks *r, const struct scene_options *o, size_t chosen,
                    struct error *e);
void plan_ranks_free(struct plan_ranks *r);
void plan_ranks_print(const struct plan_ranks *r, const struct plan *plan, FILE *out);
/* NULL: no memory. */
cJSON *plan_ranks_json(const struct plan_ranks *r, const struct plan *plan);

#endif
