/* run/domain.h -- a run on several ranks: who holds which particles, ghosts of others', values that all ranks share.
 * On one rank there is none of it: r->domain is NULL, and all calls do nothing. All ranks make the same calls in
 * the same order. */
#ifndef RUN_DOMAIN_H
#define RUN_DOMAIN_H

#include "domain/halo.h"
#include "domain/partition.h"
#include "run/run.h"

struct run_domain {
    struct wire *wire;
    struct partition *partition;
    struct halo halo;
    struct halo_want *want;
    size_t n_want;
    struct cloud *cloud; /* [frame * n_array + array] */
    struct halo_column *column;
    size_t n_column;  /* of the exchange under way */
    struct skin *met; /* [frame * n_array + array]: other frames' places when the halo was made */
    bool waits;       /* it has begun */
    bool **far;       /* [list][group] */
    size_t *far_capacity;
    int *owner; /* room for as many particles as one asks for at once */
    float *weight;
    double *place;
    size_t capacity;
    double pace; /* time a cost of this rank's, over that of all; 1 unless the scene wants time */
    /* Of a clock that stands while this rank waits: how long no step was on, when the last one ended, and what steps
     * had taken when particles were last weighed. */
    double idle, ended, busy;
    bool timed;       /* particles have been weighed so */
    double imbalance; /* of the cost, when particles were last sorted */
    uint64_t moved,
        cuts;       /* particles that have left this rank; how often the domain was cut anew */
    uint64_t halos; /* how often ghosts were made anew */
    struct halo_sent for_ghosts,
        for_moves; /* of what was sent: while that was done; to move particles */
};

static inline bool run_shared(const struct run *r)
{
    return r->domain != NULL;
}

/* Every rank has been given all particles: cuts the domain and keeps this rank's. */
int run_domain_open(struct run *r, struct error *e);
void run_domain_close(struct run *r);
/* A part of it: the first cuts, by places alone. domain_cuts.c, as all until particles move. */
int run_domain_cut(struct run *r, struct error *e);
/* After lists have been made for the first time, by what is known of their length: whether the particles had
 * better be moved at once. */
int run_domain_uneven(struct run *r, bool *uneven, struct error *e);
/* A step begins, or has ended: what comes in between takes no part in what particles cost. */
void run_domain_step(struct run *r, bool begins);
/* Particles go to where their places belong. */
int run_domain_move(struct run *r, struct error *e);
/* Ghosts of what this rank's lists may reach: room for them, and who they are; of their columns positions and
 * smoothing lengths are right. sorts: particles have just been put in order, and may be put in another. */
int run_domain_ghosts(struct run *r, bool sorts, struct error *e);
/* The first half of it, of what the host's columns hold: who needs whom. */
int run_domain_meet(struct run *r, struct error *e);
/* What this rank's share costs, in pairs: those of its lists for each sweep of an evaluation that walks them, and
 * something for each particle. */
int run_domain_cost(struct run *r, double *cost, struct error *e);
/* After ghosts have been made: keeps where particles stood in other frames than that of positions. */
int run_domain_keep(struct run *r, struct error *e);
/* Columns that ghosts need anew, of any arrays: asked for one by one, then exchanged at once; this rank's own images
 * get theirs when the messages are on their way. */
int run_domain_ask(struct run *r, size_t array, int column, struct error *e);
int run_domain_begin(struct run *r, struct error *e);
int run_domain_finish(struct run *r, struct error *e);
/* Between the two; messages go on while something else is done. */
bool run_domain_waits(const struct run *r);
void run_domain_poke(const struct run *r);
/* A list of this rank's has been made; whether a pass's sources of a group are not all this rank's own. */
int run_domain_list(struct run *r, size_t list, struct error *e);
bool run_domain_far(const struct run *r, const struct pass *p, size_t group);

/* Bytes held for ghosts of others' particles; what goes with lists and places is added there. */
size_t run_domain_bytes(const struct run *r, size_t *lists, size_t *places);

/* Copies of all arrays on rank 0, with every column; elsewhere arrays of nothing. all: [n_array], to be freed by
 * run_domain_scatter in any case. */
int run_domain_collect(struct run *r, struct particles *all, struct error *e);
void run_domain_scatter(const struct run *r, struct particles *all);
/* Whether this rank is the one that writes and talks. */
bool run_speaks(const struct run *r);
/* status of a whole run: others stop waiting if it is not 0, and all end alike. */
int run_domain_agree(struct run *r, int status, struct error *e);

/* Of all ranks. */
int run_share_change(const struct run *r, struct skin_change *c, struct error *e);
int run_share_numbers(const struct run *r, double *value, const uint32_t *op, size_t n,
                      struct error *e);
int run_share_exact(const struct run *r, struct exact_sum *sum, size_t n, struct error *e);
int run_share_count(const struct run *r, uint64_t *n, struct error *e);

#endif
