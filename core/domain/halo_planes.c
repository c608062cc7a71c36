/* domain/halo_planes.c -- columns that do not stand in particles, but were packed by who has them (see halo.h):
 * cut into messages, and put together again. */
#include "domain/halo.h"
#include <stdlib.h>
#include <string.h>

size_t halo_sent(const struct halo *h, size_t array)
{
    size_t n = 0;
    for (size_t k = 0; k < h->n_peer; k++)
        n += h->peer[k].part[array].n_send;
    return n;
}

size_t halo_received(const struct halo *h, size_t array)
{
    size_t n = 0;
    for (size_t k = 0; k < h->n_peer; k++)
        n += h->peer[k].part[array].n_receive;
    return n;
}

/* The message to peer k: of each plane the peer's part. */
static void fill(struct halo *h, size_t k, const struct halo_plane *p, size_t n)
{
    char *at = h->peer[k].out;
    for (size_t i = 0; i < n; i++) {
        size_t before = 0;
        for (size_t q = 0; q < k; q++)
            before += h->peer[q].part[p[i].array].n_send;
        const size_t bytes = h->peer[k].part[p[i].array].n_send * p[i].size;
        if (bytes)
            memcpy(at, p[i].out + before * p[i].size, bytes);
        at += bytes;
    }
}

static void take(const struct halo *h, size_t k, const struct halo_plane *p, size_t n)
{
    const char *at = h->peer[k].in;
    for (size_t i = 0; i < n; i++) {
        const struct halo_part *part = &h->peer[k].part[p[i].array];
        const size_t before = part->first - h->peer[0].part[p[i].array].first;
        const size_t bytes = part->n_receive * p[i].size;
        if (bytes)
            memcpy(p[i].in + before * p[i].size, at, bytes);
        at += bytes;
    }
}

int halo_trade(struct halo *h, const struct halo_plane *p, size_t n, struct error *e)
{
    struct parcel *receive = h->parcel + h->n_peer;
    for (size_t k = 0; k < h->n_peer; k++) {
        struct halo_peer *q = &h->peer[k];
        size_t out = 0, in = 0;
        for (size_t i = 0; i < n; i++) {
            out += q->part[p[i].array].n_send * p[i].size;
            in += q->part[p[i].array].n_receive * p[i].size;
        }
        if (halo_room(q, out, in, e))
            return -1;
        fill(h, k, p, n);
        h->parcel[k] = (struct parcel){q->rank, q->out, out};
        receive[k] = (struct parcel){q->rank, q->in, in};
    }
    const struct wire_count before = wire_count(h->wire);
    if (wire_begin(h->wire, h->parcel, h->n_peer, receive, h->n_peer, e) || wire_finish(h->wire, e))
        return -1;
    halo_count(h->wire, &h->sent, &before);
    for (size_t k = 0; k < h->n_peer; k++)
        take(h, k, p, n);
    return 0;
}
