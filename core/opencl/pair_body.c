/* opencl/pair_body.c -- builds a pair body for a device and runs it there (see pair_body.h). */
#include "config.h"

#include "opencl/pair_body.h"

#include "opencl/devices.h"
#include "opencl/pair_source.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int pair_body_device(size_t *device, struct error *e)
{
    struct opencl_device *all;
    size_t n;
    bool found = false;

    if (!opencl_is_built())
        return error_set(e, EXIT_RUN, "this sph is built without OpenCL");
    if (opencl_devices(&all, &n, e))
        return -1;
    for (size_t k = 0; k < n && !found; k++) {
        found = all[k].fp64;
        *device = k;
    }
    free(all);
    if (found)
        return 0;
    return error_set(e, EXIT_RUN,
                     n ? "no OpenCL device here has double precision"
                       : "there is no OpenCL device here");
}

#if SPH_HAVE_OPENCL

#include <CL/cl.h>

#define GROUP 64u /* work items are launched in multiples of it, for devices that like that */

struct pair_body {
    const sph_function *function;
    int dim;
    char device[128];
    struct pair_column *column;
    size_t n_column;
    cl_context context;
    cl_command_queue queue;
    cl_program program;
    cl_kernel kernel;
};

static const char *code_name(cl_int code)
{
    static const struct {
        cl_int code;
        const char *name;
    } names[] = {
        {CL_DEVICE_NOT_AVAILABLE, "the device is not available"},
        {CL_COMPILER_NOT_AVAILABLE, "its driver has no compiler"},
        {CL_MEM_OBJECT_ALLOCATION_FAILURE, "its memory does not suffice"},
        {CL_OUT_OF_RESOURCES, "out of resources"},
        {CL_OUT_OF_HOST_MEMORY, "out of the host's memory"},
        {CL_BUILD_PROGRAM_FAILURE, "the program does not build"},
        {CL_INVALID_BUFFER_SIZE, "a buffer is larger than it can hold"},
    };

    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (names[i].code == code)
            return names[i].name;
    return "OpenCL's error";
}

static int failed(const struct pair_body *p, const char *what, cl_int code, struct error *e)
{
    return error_set(e, EXIT_RUN, "device \"%s\" fails to %s: %s (%d)", p->device, what,
                     code_name(code), (int)code);
}

/* -- Build -------- */

/* The first line of the log that is an error, else its first line. Cut off at its end, in place. */
static const char *first_error(char *log)
{
    char *line = strstr(log, "error:");

    if (!line)
        line = log;
    while (line > log && line[-1] != '\n')
        line--;
    line[strcspn(line, "\r\n")] = '\0';
    return line;
}

static int build_failed(const struct pair_body *p, cl_device_id id, cl_int code, struct error *e)
{
    size_t size = 0;
    char *log = NULL;

    if (code == CL_BUILD_PROGRAM_FAILURE &&
        clGetProgramBuildInfo(p->program, id, CL_PROGRAM_BUILD_LOG, 0, NULL, &size) == CL_SUCCESS)
        log = calloc(1, size + 1);
    if (!log || clGetProgramBuildInfo(p->program, id, CL_PROGRAM_BUILD_LOG, size, log, NULL) !=
                    CL_SUCCESS) {
        free(log);
        return failed(p, "build a body", code, e);
    }
    error_set(e, EXIT_REFUSED, "its device body \"%s\" does not compile on \"%s\": %s",
              p->function->device->file, p->device, first_error(log));
    free(log);
    return -1;
}

static int build(struct pair_body *p, cl_device_id id, const char *source, struct error *e)
{
    cl_int code;

    p->context = clCreateContext(NULL, 1, &id, NULL, NULL, &code);
    if (!p->context)
        return failed(p, "make a context", code, e);
    p->queue = clCreateCommandQueue(p->context, id, 0, &code);
    if (!p->queue)
        return failed(p, "make a queue", code, e);
    p->program = clCreateProgramWithSource(p->context, 1, &source, NULL, &code);
    if (!p->program)
        return failed(p, "take a program", code, e);
    code = clBuildProgram(p->program, 1, &id, "-cl-std=CL1.2", NULL, NULL);
    if (code != CL_SUCCESS)
        return build_failed(p, id, code, e);
    p->kernel = clCreateKernel(p->program, PAIR_KERNEL, &code);
    return p->kernel ? 0 : failed(p, "make a kernel", code, e);
}

const char *pair_body_device_name(const struct pair_body *p)
{
    return p->device;
}

void pair_body_free(struct pair_body *p)
{
    if (!p)
        return;
    if (p->kernel)
        clReleaseKernel(p->kernel);
    if (p->program)
        clReleaseProgram(p->program);
    if (p->queue)
        clReleaseCommandQueue(p->queue);
    if (p->context)
        clReleaseContext(p->context);
    free(p->column);
    free(p);
}

int pair_body_build(struct pair_body **out, size_t device, const sph_function *f, int dim,
                    bool measured, struct error *e)
{
    struct pair_body *p = calloc(1, sizeof(*p));
    cl_device_id id = opencl_device_handle(device);
    char *source;
    int status;

    *out = NULL;
    if (!p)
        return error_memory(e, "a body", sizeof(*p));
    p->function = f;
    p->dim = dim;
    if (!id) {
        free(p);
        return error_set(e, EXIT_RUN, "there is no OpenCL device %zu", device);
    }
    if (clGetDeviceInfo(id, CL_DEVICE_NAME, sizeof(p->device), p->device, NULL) != CL_SUCCESS)
        strcpy(p->device, "?");
    source = pair_source(f->device, dim, measured, e);
    status =
        !source || pair_columns(&p->column, &p->n_column, f->device, e) || build(p, id, source, e);
    free(source);
    if (status) {
        pair_body_free(p);
        return -1;
    }
    *out = p;
    return 0;
}

/* -- Run -------- */

#define ARGUMENTS 20u /* in front of the columns: see pair_source.h */

/* One run: the buffers, by argument. */
struct call {
    const struct pair_body *p;
    const sph_batch *b;
    cl_mem *buffer; /* [ARGUMENTS + columns], NULL: not one */
    cl_uint next;   /* argument */
    cl_uint absolute;
};

static int give(struct call *c, const void *value, size_t size, struct error *e)
{
    const cl_int code = clSetKernelArg(c->p->kernel, c->next++, size, value);

    return code == CL_SUCCESS ? 0 : failed(c->p, "take an argument", code, e);
}

static int give_ulong(struct call *c, uint64_t value, struct error *e)
{
    const cl_ulong x = value;

    return give(c, &x, sizeof(x), e);
}

/* A buffer, as the next argument. */
static int give_buffer(struct call *c, cl_mem_flags flags, size_t size, struct error *e)
{
    cl_int code;
    cl_mem *buffer = &c->buffer[c->next];

    *buffer = clCreateBuffer(c->p->context, flags, size ? size : sizeof(double), NULL, &code);
    return *buffer ? give(c, buffer, sizeof(*buffer), e) : failed(c->p, "make a buffer", code, e);
}

static int put(struct call *c, cl_mem buffer, size_t at, const void *data, size_t size,
               struct error *e)
{
    const cl_int code = size == 0 ? CL_SUCCESS
                                  : clEnqueueWriteBuffer(c->p->queue, buffer, CL_TRUE, at, size,
                                                         data, 0, NULL, NULL);

    return code == CL_SUCCESS ? 0 : failed(c->p, "take data", code, e);
}

static int give_data(struct call *c, const void *data, size_t size, struct error *e)
{
    const cl_uint k = c->next;

    return give_buffer(c, CL_MEM_READ_ONLY, size, e) ? -1 : put(c, c->buffer[k], 0, data, size, e);
}

static double *plane_of(const sph_column *column, uint32_t k, uint64_t first)
{
    return (double *)column->data + k * column->plane + first;
}

/* Elements [first, first + n) of each component, packed. */
static int give_column(struct call *c, const sph_column *column, uint64_t first, uint64_t n,
                       struct error *e)
{
    const size_t bytes = (size_t)n * sizeof(double);
    const cl_uint argument = c->next;

    if (!column->data)
        return error_set(e, EXIT_RUN, "a column that the body needs is not in the batch");
    if (give_buffer(c, CL_MEM_READ_WRITE, bytes * column->ncomp, e))
        return -1;
    for (uint32_t k = 0; k < column->ncomp; k++)
        if (put(c, c->buffer[argument], k * bytes, plane_of(column, k, first), bytes, e))
            return -1;
    return 0;
}

static int take_column(struct call *c, cl_mem buffer, const sph_column *column, struct error *e)
{
    const size_t bytes = (size_t)c->b->count * sizeof(double);

    for (uint32_t k = 0; k < column->ncomp; k++) {
        const cl_int code = clEnqueueReadBuffer(c->p->queue, buffer, CL_TRUE, k * bytes, bytes,
                                                plane_of(column, k, c->b->first), 0, NULL, NULL);
        if (code != CL_SUCCESS)
            return failed(c->p, "give data back", code, e);
    }
    return 0;
}

/* The spans of a range's groups, and the part of the list that they lie in. */
struct part {
    const uint64_t *begin;
    size_t groups, spans;
    uint64_t least, end; /* of the list */
};

static struct part part_of(const sph_batch *b)
{
    struct part p = {.begin = b->begin + b->first / SPH_LANES,
                     .groups = (size_t)((b->count + SPH_LANES - 1) / SPH_LANES)};

    p.spans = (size_t)(p.begin[p.groups] - p.begin[0]);
    for (size_t k = 0; k < p.spans; k++) {
        const sph_span *s = &b->span[p.begin[0] + k];
        if (k == 0 || s->first < p.least)
            p.least = s->first;
        if (s->first + s->count > p.end)
            p.end = s->first + s->count;
    }
    return p;
}

static int give_scalars(struct call *c, const struct part *part, struct error *e)
{
    const sph_batch *b = c->b;
    const cl_uint same = b->same;

    if (give_ulong(c, b->count, e) || give_ulong(c, b->n_src, e) || give_ulong(c, b->first, e) ||
        give_ulong(c, part->begin[0], e) || give_ulong(c, part->least, e) ||
        give(c, &same, sizeof(same), e) || give(c, &c->absolute, sizeof(c->absolute), e) ||
        give(c, &b->time, sizeof(double), e) || give(c, &b->dt, sizeof(double), e))
        return -1;
    return give_ulong(c, b->step, e);
}

/* As they are: 2 bytes a source travel, not 4. */
static int give_lists(struct call *c, const struct part *part, struct error *e)
{
    const sph_batch *b = c->b;

    _Static_assert(sizeof(sph_span) == 16 && offsetof(sph_span, base) == 8 &&
                       offsetof(sph_span, count) == 12 && offsetof(sph_span, common) == 14,
                   "sph_span in pair_source.c is another");
    if (give_data(c, part->begin, (part->groups + 1) * sizeof(*part->begin), e) ||
        give_data(c, b->span + part->begin[0], part->spans * sizeof(*b->span), e))
        return -1;
    return give_data(c, part->spans ? b->list + part->least : NULL,
                     (size_t)(part->end - part->least) * sizeof(*b->list), e);
}

static int give_kernel(struct call *c, struct error *e)
{
    const sph_kernel_form *given = c->b->kernel;
    struct pair_form form;

    pair_form(&form, given);
    if (give_data(c, &form, sizeof(form), e))
        return -1;
    return give_data(c, given->table,
                     given->n_table ? 2 * ((size_t)given->n_table + 1) * sizeof(double) : 0, e);
}

static int give_columns(struct call *c, struct error *e)
{
    const sph_batch *b = c->b;

    if (give_column(c, &b->x_dst, b->first, b->count, e) ||
        give_column(c, &b->h_dst, b->first, b->count, e) ||
        give_column(c, &b->x_src, 0, b->n_src, e) || give_column(c, &b->h_src, 0, b->n_src, e))
        return -1;
    for (size_t k = 0; k < c->p->n_column; k++) {
        const struct pair_column *column = &c->p->column[k];
        if (column->source ? give_column(c, &b->src[column->index], 0, b->n_src, e)
                           : give_column(c, &b->dst[column->index], b->first, b->count, e))
            return -1;
    }
    return 0;
}

static int launch(struct call *c, struct error *e)
{
    const size_t items = (size_t)((c->b->count + GROUP - 1) / GROUP * GROUP);
    cl_int code =
        clEnqueueNDRangeKernel(c->p->queue, c->p->kernel, 1, NULL, &items, NULL, 0, NULL, NULL);

    if (code == CL_SUCCESS)
        code = clFinish(c->p->queue);
    return code == CL_SUCCESS ? 0 : failed(c->p, "run a body", code, e);
}

static int run(struct call *c, struct error *e)
{
    const struct part part = part_of(c->b);

    if (give_scalars(c, &part, e) || give_lists(c, &part, e) || give_kernel(c, e) ||
        give_data(c, c->b->param, c->b->n_params * sizeof(double), e) || give_columns(c, e) ||
        launch(c, e))
        return -1;
    for (size_t k = 0; k < c->p->n_column; k++)
        if (c->p->column[k].written &&
            take_column(c, c->buffer[ARGUMENTS + k], &c->b->dst[c->p->column[k].index], e))
            return -1;
    return 0;
}

int pair_body_run(struct pair_body *p, const sph_batch *b, bool absolute, struct error *e)
{
    struct call call = {.p = p, .b = b, .absolute = absolute};
    int status;

    if (b->real != SPH_F64 || b->dim != (uint32_t)p->dim || !b->kernel || !b->begin || !b->span)
        return error_set(e, EXIT_RUN, "the batch is not one of doubles in %d dimensions", p->dim);
    if (b->count == 0)
        return 0;
    call.buffer = calloc(ARGUMENTS + p->n_column, sizeof(*call.buffer));
    if (!call.buffer)
        return error_memory(e, "a list of buffers", ARGUMENTS + p->n_column);
    status = run(&call, e);
    for (size_t k = 0; k < ARGUMENTS + p->n_column; k++)
        if (call.buffer[k])
            clReleaseMemObject(call.buffer[k]);
    free(call.buffer);
    return status;
}

#else

int pair_body_build(struct pair_body **out, size_t device, const sph_function *f, int dim,
                    bool measured, struct error *e)
{
    (void)device;
    (void)f;
    (void)dim;
    (void)measured;
    *out = NULL;
    return error_set(e, EXIT_RUN, "this sph is built without OpenCL");
}

const char *pair_body_device_name(const struct pair_body *p)
{
    (void)p;
    return "";
}

void pair_body_free(struct pair_body *p)
{
    (void)p;
}

int pair_body_run(struct pair_body *p, const sph_batch *b, bool absolute, struct error *e)
{
    (void)p;
    (void)b;
    (void)absolute;
    return error_set(e, EXIT_RUN, "this sph is built without OpenCL");
}

#endif
