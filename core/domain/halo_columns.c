/* domain/halo_columns.c -- columns brought up to date in ghosts from other ranks (see halo.h): packed once for
 * each peer, column by column, component by component, as they are held. */
#include "domain/halo.h"
#include <stdlib.h>
#include <string.h>

/* Bytes of n elements of a column in a message: whole words, so that the next one stands as it must. */
static size_t block(const struct column *c, size_t n)
{
    return (n * c->ncomp * (c->size + (c->low ? sizeof(float) : 0)) + 7) / 8 * 8;
}

size_t halo_bytes(const struct halo *h, const struct halo_column *c, size_t n)
{
    size_t bytes = 0;
    for (size_t k = 0; k < h->n_peer; k++)
        for (size_t i = 0; i < n; i++) {
            const struct column *column = &c[i].p->column[c[i].column];
            bytes += block(column, h->peer[k].part[c[i].array].n_send);
        }
    return bytes;
}

/* The column as if its elements stood in a message: its planes one after the other, rests behind them. */
static struct column in_message(const struct column *c, char *at, size_t n)
{
    struct column to = *c;
    to.data = at;
    to.plane = n;
    to.low = c->low ? (float *)(void *)(at + c->ncomp * n * c->size) : NULL;
    to.mirror = NULL;
    return to;
}

static void copy(char *to, const char *from, size_t size, const uint32_t *index, size_t n)
{
    if (size == 8)
        for (size_t k = 0; k < n; k++)
            memcpy(to + 8 * k, from + 8 * (size_t)index[k], 8);
    else
        for (size_t k = 0; k < n; k++)
            memcpy(to + 4 * k, from + 4 * (size_t)index[k], 4);
}

static void pack_column(const struct halo_part *p, const struct box *box, int dim,
                        const struct column *c, char *at)
{
    const size_t n = p->n_send;
    const struct column to = in_message(c, at, n);
    for (uint32_t q = 0; n > 0 && q < c->ncomp; q++) {
        copy((char *)to.data + q * n * c->size, (const char *)c->data + q * c->plane * c->size,
             c->size, p->send, n);
        if (c->low)
            copy((char *)(to.low + q * n), (const char *)(c->low + q * c->plane), sizeof(float),
                 p->send, n);
        const unsigned changing = column_is_real(c) ? sides_changing(box, dim, c, q) : 0;
        for (size_t k = 0; changing && k < n; k++)
            if (p->image[k] & changing)
                column_set(&to, q, k,
                           sides_value(box, dim, c, q, p->image[k], column_get(c, q, p->send[k])));
    }
}

static void unpack_column(const struct halo_part *p, size_t n_real, const struct column *c,
                          const char *at)
{
    const size_t n = p->n_receive, first = n_real + p->first;
    for (uint32_t q = 0; n > 0 && q < c->ncomp; q++) {
        memcpy((char *)c->data + (q * c->plane + first) * c->size, at + q * n * c->size,
               n * c->size);
        if (c->low)
            memcpy(c->low + q * c->plane + first,
                   at + c->ncomp * n * c->size + q * n * sizeof(float), n * sizeof(float));
    }
}

static int room(char **data, size_t *capacity, size_t bytes, struct error *e)
{
    if (bytes <= *capacity)
        return 0;
    free(*data);
    *capacity = bytes + bytes / 8;
    *data = malloc(*capacity);
    if (*data)
        return 0;
    *capacity = 0;
    return error_memory(e, "messages", bytes);
}

int halo_room(struct halo_peer *q, size_t out, size_t in, struct error *e)
{
    return room(&q->out, &q->out_capacity, out, e) || room(&q->in, &q->in_capacity, in, e) ? -1 : 0;
}

int halo_begin(struct halo *h, const struct box *box, const struct halo_column *c, size_t n,
               struct error *e)
{
    struct parcel *receive = h->parcel + h->n_peer;
    for (size_t k = 0; k < h->n_peer; k++) {
        struct halo_peer *q = &h->peer[k];
        size_t out = 0, in = 0;
        for (size_t i = 0; i < n; i++) {
            const struct column *column = &c[i].p->column[c[i].column];
            out += block(column, q->part[c[i].array].n_send);
            in += block(column, q->part[c[i].array].n_receive);
        }
        if (halo_room(q, out, in, e))
            return -1;
        char *at = q->out;
        for (size_t i = 0; i < n; i++) {
            const struct column *column = &c[i].p->column[c[i].column];
            const struct halo_part *part = &q->part[c[i].array];
            pack_column(part, box, c[i].p->dim, column, at);
            at += block(column, part->n_send);
        }
        h->parcel[k] = (struct parcel){q->rank, q->out, out};
        receive[k] = (struct parcel){q->rank, q->in, in};
    }
    const struct wire_count before = wire_count(h->wire);
    const int status = wire_begin(h->wire, h->parcel, h->n_peer, receive, h->n_peer, e);
    halo_count(h->wire, &h->sent, &before);
    return status;
}

int halo_finish(struct halo *h, const struct halo_column *c, size_t n, struct error *e)
{
    if (wire_finish(h->wire, e))
        return -1;
    for (size_t k = 0; k < h->n_peer; k++) {
        const char *at = h->peer[k].in;
        for (size_t i = 0; i < n; i++) {
            const struct column *column = &c[i].p->column[c[i].column];
            const struct halo_part *part = &h->peer[k].part[c[i].array];
            unpack_column(part, c[i].p->n, column, at);
            at += block(column, part->n_receive);
        }
    }
    return 0;
}
