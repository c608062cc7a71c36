/* domain/wire.h -- what ranks say to each other in the course of a run: messages, sums, and the alarm by which
 * one that has failed ends the waiting of all. On communicators of its own, and every byte is counted. (How the
 * domain is cut, ranks agree on in partition.c and slab.c, and on an end in ranks.c: outside of this.)
 *
 * Whatever waits here returns -1 with an empty sentence when another rank has raised the alarm: its caller goes
 * home as from any failure, to where ranks agree (ranks.h). One thread only. Without MPI in the build, or on
 * one rank, there is nobody to talk to: all calls return at once. */
#ifndef DOMAIN_WIRE_H
#define DOMAIN_WIRE_H

#include "base/error.h"
#include "base/exact_sum.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct wire;

/* All ranks call it. */
int wire_open(struct wire **w, struct error *e);
void wire_close(struct wire *w);
int wire_rank(const struct wire *w);
int wire_size(const struct wire *w);
/* This rank among those of its machine, and how many they are. */
void wire_host(const struct wire *w, int *rank, int *ranks);
/* This rank has failed: the others stop waiting. Once is enough. */
void wire_alarm(struct wire *w);
/* After an alarm, when all have heard of it (ranks_agree): all ranks call it. What was under way is given up, and
 * the wire is as new. */
void wire_renew(struct wire *w);

/* What this rank has sent to others so far: in messages, and for collective calls what it put in. Seconds: spent
 * waiting. */
struct wire_count {
    uint64_t messages, bytes, collectives, collective_bytes;
    double seconds;
};
struct wire_count wire_count(const struct wire *w);

/* -- Messages -------- */

/* To or from a rank, which may be this one. */
struct parcel {
    int rank;
    void *data;
    size_t bytes;
};

/* Sends and receives; whose sizes both sides know. None of the data is touched until wire_finish, which must
 * follow before the next wire_begin. Parcels of no bytes are not sent. */
int wire_begin(struct wire *w, const struct parcel *send, size_t n_send,
               const struct parcel *receive, size_t n_receive, struct error *e);
/* Lets messages go on while something else is done. */
void wire_poke(struct wire *w);
int wire_finish(struct wire *w, struct error *e);

/* -- Of all ranks -------- */

/* n numbers, each with an SPH_REDUCE_... of its own; a NaN comes through. Sums: in no order that is promised. */
int wire_reduce(struct wire *w, double *value, const uint32_t *op, size_t n, struct error *e);
int wire_exact(struct wire *w, struct exact_sum *sum, size_t n, struct error *e);
int wire_sum(struct wire *w, uint64_t *value, size_t n, struct error *e);
/* Sums of the ranks before this one. */
int wire_before(struct wire *w, uint64_t *value, size_t n, struct error *e);
/* `bytes` of each rank, by rank, into `all`. */
int wire_gather(struct wire *w, const void *mine, size_t bytes, void *all, struct error *e);
/* mine[rank] to each rank; theirs[rank] from each. */
int wire_trade(struct wire *w, const uint64_t *mine, uint64_t *theirs, size_t each,
               struct error *e);
/* Of rank 0 to all. */
int wire_tell(struct wire *w, void *data, size_t bytes, struct error *e);

#endif
