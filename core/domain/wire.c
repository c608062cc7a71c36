/* domain/wire.c -- see wire.h. Every call is begun without waiting, and then waited for in one place, which looks
 * for the alarm as well. */
#include "domain/wire.h"
#include "config.h"
#include "domain/ranks.h"
#include <math.h>
#include <sph/function.h>
#include <stdlib.h>
#include <string.h>

#if SPH_HAVE_MPI
#include <mpi.h>

#define TAG_PARCEL 1
#define TAG_ALARM 2
#define PIECE_MOST (1 << 30) /* of a message: MPI counts in ints */

struct wire {
    int rank, size, host_rank, host_size;
    MPI_Comm comm, alarm;
    MPI_Datatype term; /* of wire_reduce */
    MPI_Op merge;
    MPI_Request *request; /* of parcels under way */
    size_t n_request, capacity;
    bool alarmed;
    struct wire_count count;
};

struct term {
    double value;
    uint64_t op;
};

/* Two values of one reduction; a NaN comes through. */
static void merge(void *in, void *out, int *n, MPI_Datatype *type)
{
    const struct term *a = in;
    struct term *b = out;
    (void)type;
    for (int k = 0; k < *n; k++) {
        const double p = a[k].value, q = b[k].value;
        if (a[k].op == SPH_REDUCE_SUM || isnan(p) || isnan(q))
            b[k].value = p + q;
        else
            b[k].value = a[k].op == SPH_REDUCE_MIN ? fmin(p, q) : fmax(p, q);
    }
}

static int failed(struct error *e)
{
    return error_set(e, EXIT_RUN, "MPI fails: the ranks no longer hear each other");
}

/* Who shares a machine. */
static int look_around(struct wire *w)
{
    MPI_Comm host;
    if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, w->rank, MPI_INFO_NULL, &host))
        return -1;
    MPI_Comm_rank(host, &w->host_rank);
    MPI_Comm_size(host, &w->host_size);
    return MPI_Comm_free(&host) ? -1 : 0;
}

int wire_open(struct wire **out, struct error *e)
{
    int rank, size;
    struct wire *w = *out = calloc(1, sizeof *w);
    if (!w)
        return error_memory(e, "the domain", sizeof *w);
    ranks_count(&rank, &size);
    w->rank = rank;
    w->size = size;
    w->host_size = 1;
    if (size == 1)
        return 0;
    if (look_around(w) || MPI_Comm_dup(MPI_COMM_WORLD, &w->comm) ||
        MPI_Comm_dup(MPI_COMM_WORLD, &w->alarm) ||
        MPI_Type_contiguous((int)sizeof(struct term), MPI_BYTE, &w->term) ||
        MPI_Type_commit(&w->term) || MPI_Op_create(merge, 1, &w->merge))
        return failed(e);
    return 0;
}

void wire_close(struct wire *w)
{
    if (!w)
        return;
    if (w->size > 1) {
        MPI_Op_free(&w->merge);
        MPI_Type_free(&w->term);
        /* What is still under way after an alarm ends with the program. */
        if (!w->alarmed) {
            MPI_Comm_free(&w->alarm);
            MPI_Comm_free(&w->comm);
        }
    }
    free(w->request);
    free(w);
}

int wire_rank(const struct wire *w)
{
    return w ? w->rank : 0;
}

int wire_size(const struct wire *w)
{
    return w ? w->size : 1;
}

void wire_host(const struct wire *w, int *rank, int *ranks)
{
    *rank = w ? w->host_rank : 0;
    *ranks = w ? w->host_size : 1;
}

struct wire_count wire_count(const struct wire *w)
{
    return w ? w->count : (struct wire_count){0};
}

/* -- Waiting -------- */

void wire_alarm(struct wire *w)
{
    static char nothing;
    if (!w || w->alarmed || w->size == 1)
        return;
    w->alarmed = true;
    for (int to = 0; to < w->size; to++) {
        MPI_Request request;
        if (to != w->rank &&
            MPI_Isend(&nothing, 0, MPI_BYTE, to, TAG_ALARM, w->alarm, &request) == MPI_SUCCESS)
            MPI_Request_free(&request);
    }
}

static bool is_alarmed(struct wire *w)
{
    int any = 0;
    if (!w->alarmed)
        MPI_Iprobe(MPI_ANY_SOURCE, TAG_ALARM, w->alarm, &any, MPI_STATUS_IGNORE);
    w->alarmed = w->alarmed || any;
    return w->alarmed;
}

/* Another has failed, and has the sentence. */
static int give_up(struct error *e)
{
    *e = (struct error){EXIT_RUN, ""};
    return -1;
}

static int wait(struct wire *w, MPI_Request *request, size_t n, struct error *e)
{
    const double begin = MPI_Wtime();
    int done = 0;
    if (is_alarmed(w))
        return give_up(e);
    for (unsigned turn = 0; !done; turn++) {
        if (MPI_Testall((int)n, request, &done, MPI_STATUSES_IGNORE))
            return failed(e);
        if (!done && turn % 64 == 63 && is_alarmed(w))
            return give_up(e);
    }
    w->count.seconds += MPI_Wtime() - begin;
    return 0;
}

/* -- Messages -------- */

static int post(struct wire *w, const struct parcel *p, bool sends, struct error *e)
{
    for (size_t at = 0; at < p->bytes; at += PIECE_MOST) {
        const int n = p->bytes - at < PIECE_MOST ? (int)(p->bytes - at) : PIECE_MOST;
        if (w->n_request == w->capacity) {
            const size_t capacity = 2 * w->capacity + 64;
            MPI_Request *request = realloc(w->request, capacity * sizeof *request);
            if (!request)
                return error_memory(e, "messages", capacity * sizeof *request);
            w->request = request;
            w->capacity = capacity;
        }
        MPI_Request *to = &w->request[w->n_request];
        if (sends ? MPI_Isend((char *)p->data + at, n, MPI_BYTE, p->rank, TAG_PARCEL, w->comm, to)
                  : MPI_Irecv((char *)p->data + at, n, MPI_BYTE, p->rank, TAG_PARCEL, w->comm, to))
            return failed(e);
        w->n_request++;
        if (sends) {
            w->count.messages++;
            w->count.bytes += (uint64_t)n;
        }
    }
    return 0;
}

int wire_begin(struct wire *w, const struct parcel *send, size_t n_send,
               const struct parcel *receive, size_t n_receive, struct error *e)
{
    w->n_request = 0;
    if (w->size == 1)
        return 0;
    for (size_t k = 0; k < n_receive; k++)
        if (post(w, &receive[k], false, e))
            return -1;
    for (size_t k = 0; k < n_send; k++)
        if (post(w, &send[k], true, e))
            return -1;
    return 0;
}

void wire_poke(struct wire *w)
{
    int done;
    if (w->n_request)
        MPI_Testall((int)w->n_request, w->request, &done, MPI_STATUSES_IGNORE);
}

int wire_finish(struct wire *w, struct error *e)
{
    const size_t n = w->n_request;
    w->n_request = 0;
    return n ? wait(w, w->request, n, e) : 0;
}

/* -- Of all ranks -------- */

static int collective(struct wire *w, int status, MPI_Request *request, size_t bytes,
                      struct error *e)
{
    if (status)
        return failed(e);
    w->count.collectives++;
    w->count.collective_bytes += bytes;
    return wait(w, request, 1, e);
}

int wire_reduce(struct wire *w, double *value, const uint32_t *op, size_t n, struct error *e)
{
    if (w->size == 1 || n == 0)
        return 0;
    struct term *term = malloc(n * sizeof *term);
    MPI_Request request;
    if (!term)
        return error_memory(e, "sums", n * sizeof *term);
    for (size_t k = 0; k < n; k++)
        term[k] = (struct term){value[k], op[k]};
    const int status = collective(
        w, MPI_Iallreduce(MPI_IN_PLACE, term, (int)n, w->term, w->merge, w->comm, &request),
        &request, n * sizeof *term, e);
    for (size_t k = 0; !status && k < n; k++)
        value[k] = term[k].value;
    if (!status)
        free(term); /* else somebody may still write to it */
    return status;
}

int wire_exact(struct wire *w, struct exact_sum *sum, size_t n, struct error *e)
{
    MPI_Request request;
    const size_t words = n * sizeof *sum / sizeof(int64_t);
    for (size_t k = 0; k < n; k++)
        exact_carry(&sum[k]);
    if (w->size == 1 || n == 0)
        return 0;
    return collective(
        w, MPI_Iallreduce(MPI_IN_PLACE, sum, (int)words, MPI_INT64_T, MPI_SUM, w->comm, &request),
        &request, n * sizeof *sum, e);
}

int wire_sum(struct wire *w, uint64_t *value, size_t n, struct error *e)
{
    MPI_Request request;
    if (w->size == 1 || n == 0)
        return 0;
    return collective(
        w, MPI_Iallreduce(MPI_IN_PLACE, value, (int)n, MPI_UINT64_T, MPI_SUM, w->comm, &request),
        &request, n * sizeof *value, e);
}

int wire_before(struct wire *w, uint64_t *value, size_t n, struct error *e)
{
    MPI_Request request;
    int status = 0;
    if (w->size > 1 && n > 0)
        status = collective(
            w, MPI_Iexscan(MPI_IN_PLACE, value, (int)n, MPI_UINT64_T, MPI_SUM, w->comm, &request),
            &request, n * sizeof *value, e);
    if (w->rank == 0)
        memset(value, 0, n * sizeof *value);
    return status;
}

int wire_gather(struct wire *w, const void *mine, size_t bytes, void *all, struct error *e)
{
    MPI_Request request;
    if (w->size == 1) {
        memcpy(all, mine, bytes);
        return 0;
    }
    return collective(
        w, MPI_Iallgather(mine, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE, w->comm, &request),
        &request, bytes, e);
}

int wire_trade(struct wire *w, const uint64_t *mine, uint64_t *theirs, size_t each, struct error *e)
{
    MPI_Request request;
    if (w->size == 1) {
        memcpy(theirs, mine, each * sizeof *mine);
        return 0;
    }
    return collective(w,
                      MPI_Ialltoall(mine, (int)each, MPI_UINT64_T, theirs, (int)each, MPI_UINT64_T,
                                    w->comm, &request),
                      &request, (size_t)w->size * each * sizeof *mine, e);
}

int wire_tell(struct wire *w, void *data, size_t bytes, struct error *e)
{
    MPI_Request request;
    if (w->size == 1 || bytes == 0)
        return 0;
    return collective(w, MPI_Ibcast(data, (int)bytes, MPI_BYTE, 0, w->comm, &request), &request,
                      w->rank == 0 ? bytes : 0, e);
}

#else

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
