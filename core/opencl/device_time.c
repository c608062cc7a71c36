/* opencl/device_time.c -- what launches and transfers took, by OpenCL's own events: noted as commands go
 * into the queue, read in bulk later, so that nothing waits for a clock. */
#include "config.h"

#if SPH_HAVE_OPENCL

#include "opencl/device_private.h"

#include <stdlib.h>
#include <string.h>

/* Events are read once there are so many; by then the first are long done. */
#define PENDING_MOST 2048u
/* Drivers may keep commands to themselves until flushed. */
#define FLUSH_EVERY 16u

size_t device_row(struct device *d, const char *name)
{
    struct device_time *grown;

    for (size_t i = 0; i < d->n_time; i++)
        if (strcmp(d->time[i].name, name) == 0)
            return i;
    grown = realloc(d->time, (d->n_time + 1) * sizeof(*grown));
    if (!grown)
        return SIZE_MAX;
    d->time = grown;
    grown[d->n_time] = (struct device_time){.name = strdup(name)};
    if (!grown[d->n_time].name)
        return SIZE_MAX;
    return d->n_time++;
}

/* One queue, in order: a command begins once the one before it has ended. */
static void count(struct device *d, const struct device_pending *p, cl_ulong begin, cl_ulong end)
{
    struct device_span *span = &d->span[p->span];

    if (end > begin) {
        d->time[p->row].seconds += 1e-9 * (double)(end - begin);
        span->busy += 1e-9 * (double)(end - begin);
    }
    if (d->last == p->span && d->last_end && begin > d->last_end)
        span->idle += 1e-9 * (double)(begin - d->last_end);
    d->last = p->span;
    d->last_end = end;
}

size_t device_span(struct device *d, size_t k)
{
    const size_t before = d->now;

    if (k >= d->n_span) {
        struct device_span *grown = realloc(d->span, (k + 1) * sizeof(*grown));
        if (!grown)
            return before; /* times are not worth a failure: they count to the wrong span */
        memset(grown + d->n_span, 0, (k + 1 - d->n_span) * sizeof(*grown));
        d->span = grown;
        d->n_span = k + 1;
    }
    d->now = k;
    return before;
}

const struct device_span *device_spans(struct device *d, size_t *n)
{
    device_collect(d, NULL);
    *n = d->n_span;
    return d->span;
}

/* Adds the first n noted to their rows. */
static int collect(struct device *d, size_t n, struct error *e)
{
    int status = 0;

    if (n == 0)
        return 0;
    /* The last of them is done when all are: one queue, in order. */
    const cl_int waited = clWaitForEvents(1, &d->pending[n - 1].event);
    for (size_t i = 0; i < n; i++) {
        const struct device_pending *p = &d->pending[i];
        cl_ulong begin = 0, end = 0;
        cl_int done = CL_COMPLETE;
        clGetEventInfo(p->event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof(done), &done, NULL);
        if (done < 0 && !status)
            status = device_lose(d, e, done, "do", d->time[p->row].name);
        if (clGetEventProfilingInfo(p->event, CL_PROFILING_COMMAND_START, sizeof(begin), &begin,
                                    NULL) == CL_SUCCESS &&
            clGetEventProfilingInfo(p->event, CL_PROFILING_COMMAND_END, sizeof(end), &end, NULL) ==
                CL_SUCCESS)
            count(d, p, begin, end);
        clReleaseEvent(p->event);
        free(p->staged);
    }
    if (waited != CL_SUCCESS && !status)
        status = device_lose(d, e, waited, "do", "what was asked of it");
    d->n_pending -= n;
    memmove(d->pending, d->pending + n, d->n_pending * sizeof(*d->pending));
    return status;
}

int device_collect(struct device *d, struct error *e)
{
    return collect(d, d->n_pending, e);
}

int device_note(struct device *d, cl_event event, size_t row, size_t bytes, void *staged,
                struct error *e)
{
    if (!d->pending)
        d->pending = malloc(PENDING_MOST * sizeof(*d->pending));
    if (!d->n_span)
        device_span(d, 0);
    if (!d->pending || !d->n_span || row == SIZE_MAX) {
        clFinish(d->queue);
        clReleaseEvent(event);
        free(staged);
        return error_memory(e, "the times of a device", PENDING_MOST * sizeof(*d->pending));
    }
    d->pending[d->n_pending++] = (struct device_pending){event, row, d->now, staged};
    d->time[row].launches++;
    d->time[row].bytes += bytes;
    if (++d->unflushed >= FLUSH_EVERY) {
        clFlush(d->queue);
        d->unflushed = 0;
    }
    return d->n_pending < PENDING_MOST ? 0 : collect(d, PENDING_MOST / 2, e);
}

const struct device_time *device_times(struct device *d, size_t *n)
{
    device_collect(d, NULL);
    *n = d->n_time;
    return d->time;
}

#else

/* ISO C wants something in a file. */
extern const int device_time_is_not_built_in;

#endif
