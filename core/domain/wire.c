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
    MPI_Request *request;                  /* of parcels under way */
    size_t n_request, n_receive, capacity; /* receives come first */
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
    if (ranks_agree(w ? 0 : error_memory(e, "the domain", sizeof *w), e))
        return -1;
    ranks_count(&rank, &size);
    w->rank = rank;
    w->size = size;
    w->host_size = 1;
    if (size == 1)
        return 0;
    if (look_around(w) || MPI_Comm_dup(MPI_COMM_WORLD, &w->comm) ||
        MPI_Comm_dup(MPI_COMM_WORLD, &w->alarm) ||
        MPI_Type_contiguous((int)sizeof(struct term), MPI_BYTE, &w->term) ||
        MPI_Type_commit(&w->term) || MPI_Op_create(merge, 1, &w->merge) ||
        MPI_Comm_set_name(w->comm, "sph") || MPI_Comm_set_name(w->alarm, "sph alarm"))
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

/* How long a message that has begun to arrive may take to do so when all others are on their way home. */
#define LAST_SECONDS 5.0

void wire_renew(struct wire *w)
{
    if (!w || w->size == 1)
        return;
    /* What has arrived by half goes on arriving: not into memory that is free by then. */
    for (size_t k = 0; k < w->n_receive; k++)
        if (w->request[k] != MPI_REQUEST_NULL)
            MPI_Cancel(&w->request[k]);
    const double begin = MPI_Wtime();
    for (int done = 0; w->n_receive && !done && MPI_Wtime() < begin + LAST_SECONDS;)
        MPI_Testall((int)w->n_receive, w->request, &done, MPI_STATUSES_IGNORE);
    for (size_t k = w->n_receive; k < w->n_request; k++)
        if (w->request[k] != MPI_REQUEST_NULL)
            MPI_Request_free(&w->request[k]);
    w->n_request = w->n_receive = 0;
    /* What nobody has taken stays where it is, and so do the old ways. */
    MPI_Comm_dup(MPI_COMM_WORLD, &w->comm);
    MPI_Comm_dup(MPI_COMM_WORLD, &w->alarm);
    w->alarmed = false;
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
    w->n_request = w->n_receive = 0;
    if (w->size == 1)
        return 0;
    for (size_t k = 0; k < n_receive; k++) {
        if (post(w, &receive[k], false, e))
            return -1;
        w->n_receive = w->n_request;
    }
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
    if (w->n_request && wait(w, w->request, w->n_request, e))
        return -1;
    w->n_request = w->n_receive = 0;
    return 0;
}

/* -- Of all ranks -------- */

/* After an alarm others may go on writing to what a call was given, when its caller has gone: MPI works on a copy,
 * which then is left to it. */
static void *copy_of(const void *data, size_t bytes, struct error *e)
{
    void *copy = malloc(bytes);
    if (!copy)
        error_memory(e, "what ranks share", bytes);
    else if (data)
        memcpy(copy, data, bytes);
    return copy;
}

/* Waits for a call of all ranks, and takes what has come. */
static int collective(struct wire *w, int status, MPI_Request *request, size_t sent, void *copy,
                      void *to, size_t bytes, struct error *e)
{
    if (status)
        return failed(e);
    w->count.collectives++;
    w->count.collective_bytes += sent;
    if (wait(w, request, 1, e))
        return -1;
    memcpy(to, copy, bytes);
    free(copy);
    return 0;
}

int wire_reduce(struct wire *w, double *value, const uint32_t *op, size_t n, struct error *e)
{
    if (w->size == 1 || n == 0)
        return 0;
    const size_t bytes = n * sizeof(struct term);
    struct term *term = malloc(bytes), *copy;
    MPI_Request request;
    if (!term)
        return error_memory(e, "sums", bytes);
    for (size_t k = 0; k < n; k++)
        term[k] = (struct term){value[k], op[k]};
    copy = copy_of(term, bytes, e);
    const int status = copy ? collective(w,
                                         MPI_Iallreduce(MPI_IN_PLACE, copy, (int)n, w->term,
                                                        w->merge, w->comm, &request),
                                         &request, bytes, copy, term, bytes, e)
                            : -1;
    for (size_t k = 0; !status && k < n; k++)
        value[k] = term[k].value;
    free(term);
    return status;
}

/* Sums of n whole numbers: signed ones alike, but for their type. */
static int sum(struct wire *w, void *value, size_t n, MPI_Datatype type, struct error *e)
{
    const size_t bytes = n * sizeof(uint64_t);
    MPI_Request request;
    if (w->size == 1 || n == 0)
        return 0;
    void *copy = copy_of(value, bytes, e);
    return copy ? collective(
                      w,
                      MPI_Iallreduce(MPI_IN_PLACE, copy, (int)n, type, MPI_SUM, w->comm, &request),
                      &request, bytes, copy, value, bytes, e)
                : -1;
}

int wire_exact(struct wire *w, struct exact_sum *exact, size_t n, struct error *e)
{
    for (size_t k = 0; k < n; k++)
        exact_carry(&exact[k]);
    return sum(w, exact, n * sizeof *exact / sizeof(int64_t), MPI_INT64_T, e);
}

int wire_sum(struct wire *w, uint64_t *value, size_t n, struct error *e)
{
    return sum(w, value, n, MPI_UINT64_T, e);
}

int wire_before(struct wire *w, uint64_t *value, size_t n, struct error *e)
{
    const size_t bytes = n * sizeof *value;
    MPI_Request request;
    int status = 0;
    if (w->size > 1 && n > 0) {
        void *copy = copy_of(value, bytes, e);
        status = copy ? collective(w,
                                   MPI_Iexscan(MPI_IN_PLACE, copy, (int)n, MPI_UINT64_T, MPI_SUM,
                                               w->comm, &request),
                                   &request, bytes, copy, value, bytes, e)
                      : -1;
    }
    if (w->rank == 0)
        memset(value, 0, bytes);
    return status;
}

int wire_gather(struct wire *w, const void *mine, size_t bytes, void *all, struct error *e)
{
    const size_t ranks = (size_t)w->size;
    MPI_Request request;
    if (w->size == 1) {
        memcpy(all, mine, bytes);
        return 0;
    }
    char *copy = copy_of(NULL, (ranks + 1) * bytes + 1, e); /* theirs, then mine */
    if (!copy)
        return -1;
    memcpy(copy + ranks * bytes, mine, bytes);
    return collective(w,
                      MPI_Iallgather(copy + ranks * bytes, (int)bytes, MPI_BYTE, copy, (int)bytes,
                                     MPI_BYTE, w->comm, &request),
                      &request, bytes, copy, all, ranks * bytes, e);
}

int wire_trade(struct wire *w, const uint64_t *mine, uint64_t *theirs, size_t each, struct error *e)
{
    const size_t n = (size_t)w->size * each, bytes = n * sizeof *mine;
    MPI_Request request;
    if (w->size == 1) {
        memcpy(theirs, mine, bytes);
        return 0;
    }
    uint64_t *copy = copy_of(NULL, 2 * bytes + 1, e);
    if (!copy)
        return -1;
    memcpy(copy + n, mine, bytes);
    return collective(w,
                      MPI_Ialltoall(copy + n, (int)each, MPI_UINT64_T, copy, (int)each,
                                    MPI_UINT64_T, w->comm, &request),
                      &request, bytes, copy, theirs, bytes, e);
}

int wire_tell(struct wire *w, void *data, size_t bytes, struct error *e)
{
    MPI_Request request;
    if (w->size == 1 || bytes == 0)
        return 0;
    void *copy = copy_of(data, bytes, e);
    return copy ? collective(w, MPI_Ibcast(copy, (int)bytes, MPI_BYTE, 0, w->comm, &request),
                             &request, w->rank == 0 ? bytes : 0, copy, data, bytes, e)
                : -1;
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
