/* domain/wire_none.c -- wire.h where there is no MPI in the build: one rank, and nobody to talk to. */
#include "domain/wire.h"
#include "config.h"
#include <stdlib.h>
#include <string.h>

#if !SPH_HAVE_MPI

struct wire {
    char nothing;
};

int wire_open(struct wire **out, struct error *e)
{
    *out = calloc(1, sizeof **out);
    return *out ? 0 : error_memory(e, "the domain", sizeof **out);
}

void wire_close(struct wire *w)
{
    free(w);
}

int wire_rank(const struct wire *w)
{
    (void)w;
    return 0;
}

int wire_size(const struct wire *w)
{
    (void)w;
    return 1;
}

void wire_host(const struct wire *w, int *rank, int *ranks)
{
    (void)w;
    *rank = 0;
    *ranks = 1;
}

void wire_alarm(struct wire *w)
{
    (void)w;
}

void wire_renew(struct wire *w)
{
    (void)w;
}

struct wire_count wire_count(const struct wire *w)
{
    (void)w;
    return (struct wire_count){0};
}

int wire_begin(struct wire *w, const struct parcel *send, size_t n_send,
               const struct parcel *receive, size_t n_receive, struct error *e)
{
    (void)w;
    (void)send;
    (void)n_send;
    (void)receive;
    (void)n_receive;
    (void)e;
    return 0;
}

void wire_poke(struct wire *w)
{
    (void)w;
}

int wire_finish(struct wire *w, struct error *e)
{
    (void)w;
    (void)e;
    return 0;
}

int wire_reduce(struct wire *w, double *value, const uint32_t *op, size_t n, struct error *e)
{
    (void)w;
    (void)value;
    (void)op;
    (void)n;
    (void)e;
    return 0;
}

int wire_exact(struct wire *w, struct exact_sum *sum, size_t n, struct error *e)
{
    (void)w;
    (void)sum;
    (void)n;
    (void)e;
    return 0;
}

int wire_sum(struct wire *w, uint64_t *value, size_t n, struct error *e)
{
    (void)w;
    (void)value;
    (void)n;
    (void)e;
    return 0;
}

int wire_before(struct wire *w, uint64_t *value, size_t n, struct error *e)
{
    (void)w;
    (void)e;
    memset(value, 0, n * sizeof *value);
    return 0;
}

int wire_gather(struct wire *w, const void *mine, size_t bytes, void *all, struct error *e)
{
    (void)w;
    (void)e;
    memcpy(all, mine, bytes);
    return 0;
}

int wire_trade(struct wire *w, const uint64_t *mine, uint64_t *theirs, size_t each, struct error *e)
{
    (void)w;
    (void)e;
    memcpy(theirs, mine, each * sizeof *mine);
    return 0;
}

int wire_tell(struct wire *w, void *data, size_t bytes, struct error *e)
{
    (void)w;
    (void)data;
    (void)bytes;
    (void)e;
    return 0;
}

#endif
