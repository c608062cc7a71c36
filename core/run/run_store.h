/* run/run_store.h -- what the files *store.c of a run's state share. On several ranks each puts its particles into
 * one file, in a group of its own ("rank1/", ...; rank 0 at the root), and any number of ranks can go on from it. */
#ifndef RUN_RUN_STORE_H
#define RUN_RUN_STORE_H

#include "run/run.h"

/* run_store.c. Times, counters, tables: all but particles and what is made from them. */
int run_store_numbers(struct run *r, struct store *s, struct error *e);
/* Plugins' own states. */
int run_store_states(struct run *r, struct store *s, struct error *e);

/* ranks_store.c. This rank's share, into its group, which has been entered; failed: what there is to look at. */
int ranks_store(struct run *r, struct store *s, bool failed, struct error *e);
/* Out of a file of so many ranks, by all that there are now. Where nothing of the places was rounded (skin.h:
 * `exactly`) lists are made as they were, at the places where particles stood then; else anew. So with a strict
 * order of sums the run goes on with the same bits on any number of ranks. */
int ranks_restore(struct run *r, struct store *s, size_t ranks, struct error *e);

/* lists.c. Lists of where particles stood at was[array], columns "x" and "h", for those who stand elsewhere by now
 * and stay there. counted: true pairs, as when particles are sorted. */
int run_lists_again(struct run *r, const struct particles *was, bool counted, struct error *e);

#endif
