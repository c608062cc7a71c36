/* domain/ranks.h -- MPI begun and ended. This version runs on one rank: more are refused, by every rank, with
 * one sentence. Without MPI in the build there is one rank, always. */
#ifndef DOMAIN_RANKS_H
#define DOMAIN_RANKS_H

#include "base/error.h"

/* Starts MPI if the program was started by mpirun (alone it needs none, and starts faster without). */
int ranks_begin(int *argc, char ***argv, struct error *e);
void ranks_end(void);

#endif
