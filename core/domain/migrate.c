/* domain/migrate.c -- see migrate.h. To each rank one message an array: column by column, component by component,
 * as they are held. */
#include "domain/migrate.h"
#include <stdlib.h>
#include <string.h>

/* What goes to one rank, or comes from it. */
struct stream {
    size_t n; /* particles */
    char *data;
};

struct move {
    struct wire *w;
    struct particles *p;
    int ranks, me;
    uint32_t *index; /* those that stay, then by rank those that go */
    size_t n_stay;
    struct stream *out, *in; /* [ranks] */
    uint64_t *count;         /* [2 * ranks]: to, from */
    struct parcel *parcel;   /* [2 * ranks] */
};

static size_t bytes_of(const struct particles *p)
{
    size_t bytes = 0;
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];
        bytes += c->state ? c->ncomp * (c->size + (c->low ? sizeof(float) : 0)) : 0;
    }
    return bytes;
}

static void pack(char **to, const char *from, size_t size, const uint32_t *index, size_t n)
{
    for (size_t k = 0; k < n; k++)
        memcpy(*to + k * size, from + index[k] * size, size);
    *to += n * size;
}

static void pack_all(const struct particles *p, char *to, const uint32_t *index, size_t n)
{
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];
        for (uint32_t q = 0; c->state && q < c->ncomp; q++) {
            pack(&to, (const char *)c->data + q * c->plane * c->size, c->size, index, n);
            if (c->low)
                pack(&to, (const char *)(c->low + q * c->plane), sizeof(float), index, n);
        }
    }
}

static void unpack_all(struct particles *p, const char *from, size_t first, size_t n)
{
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];
        for (uint32_t q = 0; c->state && q < c->ncomp; q++) {
            memcpy((char *)c->data + (q * c->plane + first) * c->size, from, n * c->size);
            from += n * c->size;
            if (c->low) {
                memcpy(c->low + q * c->plane + first, from, n * sizeof(float));
                from += n * sizeof(float);
            }
        }
    }
}

/* Sorts particles by owner. */
static int sort(struct move *m, const int *owner, struct error *e)
{
    const size_t n = m->p->n;
    size_t *at = calloc((size_t)m->ranks + 1, sizeof *at), sum;
    m->index = malloc((n + 1) * sizeof *m->index);
    if (!at || !m->index) {
        free(at);
        return error_memory(e, "particles that move", n * sizeof *m->index);
    }
    for (size_t i = 0; i < n; i++) {
        m->n_stay += owner[i] == m->me;
        m->out[owner[i]].n += owner[i] != m->me;
    }
    sum = m->n_stay;
    for (int to = 0; to < m->ranks; to++) {
        at[to] = to == m->me ? 0 : sum;
        sum += m->out[to].n;
    }
    for (size_t i = 0; i < n; i++)
        m->index[at[owner[i]]++] = (uint32_t)i;
    free(at);
    return 0;
}

static int room(struct stream *s, size_t bytes, struct error *e)
{
    s->data = malloc(s->n * bytes + 1);
    return s->data ? 0 : error_memory(e, "particles that move", s->n * bytes);
}

static int begin(struct move *m, struct error *e)
{
    const size_t bytes = bytes_of(m->p);
    const uint32_t *index = m->index + m->n_stay;
    size_t n_send = 0, n_receive = 0;
    struct parcel *receive = m->parcel + m->ranks;
    for (int to = 0; to < m->ranks; to++)
        m->count[to] = m->out[to].n;
    if (wire_trade(m->w, m->count, m->count + m->ranks, 1, e))
        return -1;
    for (int r = 0; r < m->ranks; r++) {
        struct stream *out = &m->out[r], *in = &m->in[r];
        in->n = m->count[m->ranks + r];
        if (r == m->me || (!in->n && !out->n))
            continue;
        if (room(out, bytes, e) || room(in, bytes, e))
            return -1;
        pack_all(m->p, out->data, index, out->n);
        index += out->n;
        m->parcel[n_send++] = (struct parcel){r, out->data, out->n * bytes};
        receive[n_receive++] = (struct parcel){r, in->data, in->n * bytes};
    }
    return wire_begin(m->w, m->parcel, n_send, receive, n_receive, e);
}

/* The others fill the gaps while messages are under way; then come those that arrive. */
static int finish(struct move *m, struct error *e)
{
    struct particles *p = m->p;
    size_t n = m->n_stay;
    int status = particles_gather(p, m->index, m->n_stay, e);
    if (wire_finish(m->w, status ? &(struct error){0} : e) || status)
        return -1;
    for (int r = 0; r < m->ranks; r++)
        n += r == m->me ? 0 : m->in[r].n;
    if (particles_resize(p, n, 0, e))
        return -1;
    n = m->n_stay;
    for (int r = 0; r < m->ranks; r++) {
        if (r == m->me || !m->in[r].n)
            continue;
        unpack_all(p, m->in[r].data, n, m->in[r].n);
        n += m->in[r].n;
    }
    return 0;
}

int migrate(struct wire *w, struct particles *p, const int *owner, size_t *sent, struct error *e)
{
    struct move m = {.w = w, .p = p, .ranks = wire_size(w), .me = wire_rank(w)};
    const size_t ranks = (size_t)m.ranks;
    m.out = calloc(2 * ranks, sizeof *m.out);
    m.count = calloc(2 * ranks, sizeof *m.count);
    m.parcel = calloc(2 * ranks, sizeof *m.parcel);
    int status = m.out && m.count && m.parcel ? 0 : error_memory(e, "particles that move", ranks);
    if (!status) {
        m.in = m.out + ranks;
        status = sort(&m, owner, e) || begin(&m, e) || finish(&m, e) ? -1 : 0;
    }
    *sent = 0;
    for (size_t r = 0; !status && r < ranks; r++)
        *sent += m.out[r].n;
    /* After a failure somebody may still write to what was to arrive. */
    for (size_t r = 0; m.out && !status && r < 2 * ranks; r++)
        free(m.out[r].data);
    free(m.out);
    free(m.index);
    free(m.count);
    free(m.parcel);
    return status;
}
