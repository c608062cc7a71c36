/* domain/ranks.h -- MPI begun and ended, and errors that all ranks share. Without MPI in the build there is one
 * rank, always. */
#ifndef DOMAIN_RANKS_H
#define DOMAIN_RANKS_H

#include "base/error.h"

/* Starts MPI if the program was started by mpirun (alone it needs none, and starts faster
 * without). */
int ranks_begin(int *argc, char ***argv, struct error *e);
void ranks_end(void);
/* What mpirun says in the environment, before MPI is begun: this rank and how many there are, 0 of 1 without
 * mpirun. */
void ranks_launched(int *rank, int *size);

/* This rank and how many there are: 0 of 1 where MPI was not begun. */
void ranks_count(int *rank, int *size);
/* All ranks call it. If `status` is not 0 on any, every rank fails, with exit code and sentence of the
 * lowest that has something to say, its rank before it unless all do. */
int ranks_agree(int status, struct error *e);

#endif
