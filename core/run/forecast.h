/* run/forecast.h -- what the first cut of the domain among ranks comes to, before any step: shares, ghosts,
 * pairs across, and what steps will send. */
#ifndef RUN_FORECAST_H
#define RUN_FORECAST_H

#include "domain/halo.h"
#include "plan/exchange.h"

struct forecast_rank {
    uint64_t particles, ghosts; /* ghosts: of other ranks' particles */
    uint64_t peers;             /* ranks that it sends to */
    uint64_t across;            /* pairs of its particles with others' */
    double pairs;               /* all of its pairs */
    double cost;                /* pairs times sweeps, and particles (run/domain.h) */
};

struct forecast {
    int ranks;
    struct forecast_rank *of;   /* [ranks] */
    struct exchanges exchanges; /* of a step between the making of lists */
    struct halo_sent *sent;     /* [exchanges.n]: by all ranks together */
    struct halo_sent *by; /* [ranks]: by each in a step, passes that repeat themselves done once */
};

/* All ranks call it, with a plan that has been filled and that is of no use afterwards; all get the same. To be
 * freed in any case. */
int forecast_make(struct forecast *f, struct plan *plan, struct error *e);
void forecast_free(struct forecast *f);

/* Over all ranks. */
struct forecast_rank forecast_sum(const struct forecast *f);
/* The largest cost over the mean. */
double forecast_balance(const struct forecast *f);
/* Of an evaluation, SIZE_MAX: of all of the step. */
struct halo_sent forecast_sent(const struct forecast *f, size_t evaluation);

#endif
