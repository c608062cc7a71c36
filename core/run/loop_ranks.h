/* run/loop_ranks.h -- what a run on several ranks tells of itself: ranks.csv on its way, "ranks" of summary.json at
 * its end; what is sent in a step beside what the plan says. On one rank all calls do nothing. */
#ifndef RUN_LOOP_RANKS_H
#define RUN_LOOP_RANKS_H

#include "io/csv.h"
#include "io/output.h"
#include "plan/exchange.h"
#include "run/domain.h"

/* What one rank has at the end. */
struct rank_figures {
    uint64_t particles, ghosts, pairs, updates, created, unfinished, rss, moved;
    struct halo_sent all, columns, ghosts_made, moves;
    uint64_t collectives, collective_bytes;
    struct halo_sent steady, planned; /* in steps between the making of lists */
    double pass_s, wait_s, loop_s, neighbour_s, integrate_s, io_s;
    double columns_held, mirrors_held, lists_held, places_held, ghosts_held,
        search_held; /* bytes */
};

struct loop_ranks {
    struct run *run; /* NULL: on one rank */
    struct csv csv;
    struct exchanges plan;
    /* When the step began, and the one before. */
    uint64_t halos, halos_before;
    struct halo_sent sent;
    uint64_t *sweeps; /* [pass] */
    size_t *n;        /* [array]: room */
    /* Since then. */
    uint64_t steady_steps;
    struct halo_sent steady, planned;
    /* Rows so far. */
    uint64_t rows, pairs;
    double first, last, most; /* imbalance */
    /* Of all ranks at the end; of arrays and passes sums. */
    struct rank_figures *of; /* [ranks]; NULL: not known */
    double *array_n, *pass_s, *pass_pairs;
};

int loop_ranks_open(struct loop_ranks *l, struct run *r, const struct output *out, bool resumed,
                    struct error *e);
void loop_ranks_free(struct loop_ranks *l);
void loop_ranks_step_begins(struct loop_ranks *l);
void loop_ranks_step_ends(struct loop_ranks *l);
/* A row of ranks.csv, of what has been since the one before. All ranks call it. */
int loop_ranks_row(struct loop_ranks *l, struct error *e);
int loop_ranks_sync(struct loop_ranks *l, struct error *e);
int loop_ranks_close(struct loop_ranks *l, struct error *e);
/* What all ranks have; held: of this one in bytes. All ranks call it, at the end. */
struct summary_memory;
int loop_ranks_gather(struct loop_ranks *l, const struct summary_memory *held, struct error *e);
/* Sums over ranks. */
struct rank_figures loop_ranks_sum(const struct loop_ranks *l);
/* "ranks" of summary.json; NULL: no memory. */
cJSON *loop_ranks_json(const struct loop_ranks *l);

#endif
