/* domain/halo.h -- ghosts of particles that live on other ranks, images across the domain's sides included: who
 * needs whom, and columns brought up to date.
 *
 * Each rank tells those near it, in a few boxes, where its destinations stand and how far they reach. Whoever
 * holds sources picks those that lie within reach of such a box, or reach it themselves, as they stand or
 * as an image. So it does not matter how the domain was cut, nor whether particles have left their part
 * since. Behind an array's real particles stand its own images first (struct ghosts), then what has come from
 * other ranks, rank by rank. */
#ifndef DOMAIN_HALO_H
#define DOMAIN_HALO_H

#include "domain/sides.h"
#include "domain/wire.h"
#include "neighbours/neighbours.h"

/* Sources of one array for the destinations of another, by places of a frame; symmetric: within reach of
 * either. */
struct halo_want {
    size_t dst, src, frame;
    bool symmetric;
};

/* What a halo is made for. All ranks have the same but for the clouds. */
struct halo_job {
    const struct box *box;
    size_t n_array, n_frame;
    const struct cloud
        *cloud; /* [frame * n_array + array]: of real particles; n as in the array, or 0 */
    const struct halo_want *want;
    size_t n_want;
    double factor; /* that reaches are enlarged by */
};

/* Of an array what goes to a rank, and comes from it. */
struct halo_part {
    uint32_t *send; /* [n_send]: real particles */
    uint8_t *image; /* [n_send]: as which image; 0: as it stands */
    size_t n_send, send_capacity;
    size_t first, n_receive; /* ghosts, counted from the array's first */
};

struct halo_peer {
    int rank;
    struct halo_part *part; /* [array] */
    char *out, *in;         /* of the exchange under way */
    size_t out_capacity, in_capacity;
};

/* Of columns, so far. */
struct halo_sent {
    uint64_t messages, bytes;
};

struct halo {
    struct wire *wire;
    size_t n_array, n_peer, peer_capacity;
    struct halo_peer *peer;
    uint8_t **image; /* [array][ghost]: of all ghosts */
    size_t *n_ghost, *image_capacity;
    struct parcel *parcel; /* [2 * n_peer] */
    struct halo_sent sent;
};

int halo_open(struct halo *h, struct wire *w, size_t n_array, struct error *e);
void halo_close(struct halo *h);
/* Finds out who needs whom. own[array]: becomes the images that this rank needs of its own particles. Then
 * h->n_ghost says how much room each array is to have behind its real particles; nothing is in it yet. */
int halo_make(struct halo *h, const struct halo_job *job, struct ghosts *own, struct error *e);

/* A column that is to be brought up to date in ghosts from other ranks. */
struct halo_column {
    struct particles *p;
    size_t array;
    int column;
};
/* Adds what was sent since then. */
static inline void halo_count(const struct wire *w, struct halo_sent *to,
                              const struct wire_count *before)
{
    const struct wire_count now = wire_count(w);
    to->messages += now.messages - before->messages;
    to->bytes += now.bytes - before->bytes;
}
/* Room for the messages to and from a peer, whatever is in them. */
int halo_room(struct halo_peer *q, size_t out, size_t in, struct error *e);
/* Bytes that an exchange of these sends. */
size_t halo_bytes(const struct halo *h, const struct halo_column *c, size_t n);
/* All of them in one message to each rank. Between the two, neither the columns nor the halo may change. */
int halo_begin(struct halo *h, const struct box *box, const struct halo_column *c, size_t n,
               struct error *e);
int halo_finish(struct halo *h, const struct halo_column *c, size_t n, struct error *e);

/* -- Columns that stand elsewhere -------- */

/* Of an array: what goes to all peers, one after the other, and what comes from them, behind its own images. */
size_t halo_sent(const struct halo *h, size_t array);
size_t halo_received(const struct halo *h, size_t array);
/* Numbers of `size` bytes that are packed already. */
struct halo_plane {
    size_t array, size;
    const char *out; /* [halo_sent] */
    char *in;        /* [halo_received] */
};
/* As halo_begin and halo_finish. All ranks give planes of the same arrays and sizes. halo_planes.c */
int halo_trade(struct halo *h, const struct halo_plane *p, size_t n, struct error *e);

#endif
