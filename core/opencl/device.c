/* opencl/device.c -- an open device: its context, queue and buffers, and transfers between host and device
 * (see device.h). Keeps its own account of memory: drivers promise more than there is. */
#include "config.h"

#if SPH_HAVE_OPENCL

#include "opencl/device_private.h"
#include "opencl/devices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Buffers come in whole multiples of it [bytes]: a cache line, and what fills may be cut into. */
#define GRAIN 128u
/* Writes up to so long do not wait [bytes]. */
#define STAGED_MOST 65536u

/* -- Failures -------- */

#define WORD(x)                                                                                    \
    {                                                                                              \
        x, #x                                                                                      \
    }

const char *device_word(cl_int status)
{
    static const struct {
        cl_int status;
        const char *word;
    } words[] = {
        WORD(CL_DEVICE_NOT_AVAILABLE),
        WORD(CL_COMPILER_NOT_AVAILABLE),
        WORD(CL_MEM_OBJECT_ALLOCATION_FAILURE),
        WORD(CL_OUT_OF_RESOURCES),
        WORD(CL_OUT_OF_HOST_MEMORY),
        WORD(CL_PROFILING_INFO_NOT_AVAILABLE),
        WORD(CL_BUILD_PROGRAM_FAILURE),
        WORD(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
        WORD(CL_INVALID_VALUE),
        WORD(CL_INVALID_DEVICE),
        WORD(CL_INVALID_CONTEXT),
        WORD(CL_INVALID_COMMAND_QUEUE),
        WORD(CL_INVALID_MEM_OBJECT),
        WORD(CL_INVALID_BINARY),
        WORD(CL_INVALID_BUILD_OPTIONS),
        WORD(CL_INVALID_PROGRAM),
        WORD(CL_INVALID_PROGRAM_EXECUTABLE),
        WORD(CL_INVALID_KERNEL_NAME),
        WORD(CL_INVALID_KERNEL),
        WORD(CL_INVALID_ARG_INDEX),
        WORD(CL_INVALID_ARG_VALUE),
        WORD(CL_INVALID_ARG_SIZE),
        WORD(CL_INVALID_KERNEL_ARGS),
        WORD(CL_INVALID_WORK_GROUP_SIZE),
        WORD(CL_INVALID_WORK_ITEM_SIZE),
        WORD(CL_INVALID_EVENT),
        WORD(CL_INVALID_OPERATION),
        WORD(CL_INVALID_BUFFER_SIZE),
        WORD(CL_INVALID_GLOBAL_WORK_SIZE),
    };

    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        if (words[i].status == status)
            return words[i].word;
    return "an error of OpenCL";
}

int device_lose(struct device *d, struct error *e, cl_int status, const char *verb,
                const char *what)
{
    error_set(&d->why, EXIT_RUN, "device \"%s\" fails to %s %s: %s (%d)", d->facts.name, verb, what,
              device_word(status), (int)status);
    d->lost = d->failed = true;
    return device_alive(d, e);
}

int device_alive(const struct device *d, struct error *e)
{
    if (!d->lost)
        return 0;
    if (e)
        *e = d->why;
    return -1;
}

/* -- Open and close -------- */

static void text_of(cl_device_id id, cl_device_info what, char *out, size_t size)
{
    if (clGetDeviceInfo(id, what, size, out, NULL) != CL_SUCCESS)
        out[0] = '\0';
    out[size - 1] = '\0';
}

static void find_facts(struct device *d)
{
    struct device_facts *f = &d->facts;
    cl_platform_id platform = NULL;
    cl_device_type type = 0;
    cl_device_fp_config fp64 = 0;
    cl_uint units = 0;
    cl_ulong memory = 0, largest = 0;
    size_t group = 1;

    text_of(d->id, CL_DEVICE_NAME, f->name, sizeof(f->name));
    text_of(d->id, CL_DRIVER_VERSION, f->driver, sizeof(f->driver));
    clGetDeviceInfo(d->id, CL_DEVICE_PLATFORM, sizeof(platform), &platform, NULL);
    if (clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof(f->platform), f->platform, NULL) !=
        CL_SUCCESS)
        f->platform[0] = '\0';
    clGetDeviceInfo(d->id, CL_DEVICE_TYPE, sizeof(type), &type, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof(fp64), &fp64, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof(units), &units, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof(memory), &memory, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof(largest), &largest, NULL);
    clGetDeviceInfo(d->id, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof(group), &group, NULL);
    f->type = opencl_type(type);
    f->cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    f->fp64 = fp64 != 0;
    f->units = units;
    f->memory = memory;
    f->largest = largest;
    f->group_most = group;
}

struct cache_key device_cache_key(const struct device *d)
{
    struct cache_key k = {{0}};
    char version[256];

    text_of(d->id, CL_DEVICE_VERSION, version, sizeof(version));
    cache_key_text(&k, PACKAGE_VERSION);
    cache_key_text(&k, d->facts.platform);
    cache_key_text(&k, d->facts.name);
    cache_key_text(&k, d->facts.driver);
    cache_key_text(&k, version);
    return k;
}

/* The handle of that number. */
static int find_device(struct device *d, size_t number, struct error *e)
{
    struct opencl_device *list;
    size_t n;

    d->id = opencl_device_handle(number);
    if (d->id)
        return 0;
    if (opencl_devices(&list, &n, e))
        return -1;
    free(list);
    if (n == 0)
        return error_set(e, EXIT_USAGE,
                         "no OpenCL device: install the driver of a GPU, or pocl-opencl-icd, which "
                         "makes one of the processor; --device cpu needs none");
    return error_set(e, EXIT_USAGE,
                     "no OpenCL device %zu: there %s %zu, the last is opencl:%zu (`sph info "
                     "--devices' lists them)",
                     number, n == 1 ? "is" : "are", n, n - 1);
}

int device_look(size_t number, struct device_facts *out, struct error *e)
{
    struct device d = {.id = NULL};

    if (find_device(&d, number, e))
        return -1;
    find_facts(&d);
    *out = d.facts;
    return 0;
}

/* Only so many of its compute units from now on. A device that cannot be divided stays whole. */
static void take_part(struct device *d, unsigned units)
{
    const cl_device_partition_property counts[] = {CL_DEVICE_PARTITION_BY_COUNTS, (intptr_t)units,
                                                   CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    cl_device_id part = NULL;
    cl_uint n = 0;

    if (!d->facts.cpu || units == 0 || units >= d->facts.units ||
        clCreateSubDevices(d->id, counts, 1, &part, &n) != CL_SUCCESS || n != 1)
        return;
    d->id = part;
    d->part = true;
    d->facts.units = units;
}

int device_open(struct device **out, size_t number, struct error *e)
{
    return device_open_part(out, number, 0, e);
}

int device_open_part(struct device **out, size_t number, unsigned units, struct error *e)
{
    struct device *d = calloc(1, sizeof(*d));
    cl_int status;

    *out = NULL;
    if (!d)
        return error_memory(e, "a device", sizeof(*d));
    /* PoCL would compile a kernel for each kind of launch, at the first of them, and keep in a program's
     * binary what no launch takes. One form for all is built once; as kernels say how large their groups
     * are, it is as fast. */
    setenv("POCL_WORK_GROUP_SPECIALIZATION", "0", 0);
    if (find_device(d, number, e)) {
        free(d);
        return -1;
    }
    find_facts(d);
    take_part(d, units);
    d->context = clCreateContext(NULL, 1, &d->id, NULL, NULL, &status);
    if (status == CL_SUCCESS)
        d->queue = clCreateCommandQueue(d->context, d->id, CL_QUEUE_PROFILING_ENABLE, &status);
    if (status != CL_SUCCESS) {
        device_lose(d, e, status, "open", d->context ? "a queue" : "a context");
        device_close(d);
        return -1;
    }
    *out = d;
    return 0;
}

void device_close(struct device *d)
{
    if (!d)
        return;
    if (d->queue)
        clFinish(d->queue);
    for (size_t i = 0; i < d->n_pending; i++) {
        clReleaseEvent(d->pending[i].event);
        free(d->pending[i].staged);
    }
    while (d->program)
        device_program_free(d, d->program);
    for (size_t i = 0; i < d->n_memory; i++)
        clReleaseMemObject(d->memory[i].mem);
    for (size_t i = 0; i < d->n_time; i++)
        free((char *)(uintptr_t)d->time[i].name);
    if (d->queue)
        clReleaseCommandQueue(d->queue);
    if (d->context)
        clReleaseContext(d->context);
    if (d->part)
        clReleaseDevice(d->id);
    free(d->pending);
    free(d->span);
    free(d->memory);
    free(d->time);
    free(d);
}

const struct device_facts *device_facts(const struct device *d)
{
    return &d->facts;
}

bool device_failed(const struct device *d, bool *lost)
{
    *lost = d->lost;
    return d->failed;
}

int device_need_fp64(const struct device *d, struct error *e)
{
    if (d->facts.fp64)
        return 0;
    return error_set(e, EXIT_USAGE,
                     "device \"%s\" has no double precision, which the state is kept in: take "
                     "another (`sph info --devices'), or --device cpu",
                     d->facts.name);
}

/* -- Memory -------- */

size_t device_bytes(const struct device *d, size_t *most)
{
    if (most)
        *most = d->most;
    return d->bytes;
}

void device_release(struct device *d, struct device_buffer *b)
{
    for (size_t i = 0; i < d->n_memory; i++)
        if (b->mem && d->memory[i].mem == b->mem) {
            clReleaseMemObject(d->memory[i].mem);
            d->bytes -= d->memory[i].bytes;
            d->memory[i] = d->memory[--d->n_memory];
            break;
        }
    *b = (struct device_buffer){NULL, 0};
}

/* Are there so many bytes? Asked before the driver is, which may find out too late. */
static int check_room(const struct device *d, size_t bytes, const char *what, struct error *e)
{
    const struct device_facts *f = &d->facts;

    if (bytes > f->largest)
        return error_set(e, EXIT_RUN,
                         "device \"%s\" has no room for %s: %zu bytes, where one buffer has at "
                         "most %llu",
                         f->name, what, bytes, (unsigned long long)f->largest);
    if (bytes > f->memory - (d->bytes < f->memory ? d->bytes : f->memory))
        return error_set(e, EXIT_RUN,
                         "device \"%s\" has no room for %s: %zu bytes beside the %zu in use, "
                         "of %llu",
                         f->name, what, bytes, d->bytes, (unsigned long long)f->memory);
    return 0;
}

/* Zeros, waited for: only then is it known that the memory is there. */
static cl_int clear(struct device *d, cl_mem mem, size_t bytes)
{
    static const cl_uint zero = 0;
    cl_int status =
        clEnqueueFillBuffer(d->queue, mem, &zero, sizeof(zero), 0, bytes, 0, NULL, NULL);

    return status == CL_SUCCESS ? clFinish(d->queue) : status;
}

int device_reserve(struct device *d, struct device_buffer *b, size_t bytes, const char *what,
                   struct error *e)
{
    struct device_memory *grown;
    cl_int status;
    cl_mem mem;

    if (device_alive(d, e))
        return -1;
    if (b->mem && bytes <= b->bytes)
        return 0;
    if (bytes > SIZE_MAX / 2)
        return error_memory(e, what, bytes);
    bytes = bytes == 0 ? GRAIN : (bytes + GRAIN - 1) / GRAIN * GRAIN;
    device_release(d, b);
    if (check_room(d, bytes, what, e)) {
        d->failed = true;
        return -1;
    }
    grown = realloc(d->memory, (d->n_memory + 1) * sizeof(*grown));
    if (!grown)
        return error_memory(e, "the list of buffers", (d->n_memory + 1) * sizeof(*grown));
    d->memory = grown;
    mem = clCreateBuffer(d->context, CL_MEM_READ_WRITE, bytes, NULL, &status);
    if (status == CL_SUCCESS) {
        status = clear(d, mem, bytes);
        if (status != CL_SUCCESS)
            clReleaseMemObject(mem);
    }
    d->failed = d->failed || status != CL_SUCCESS;
    if (status != CL_SUCCESS)
        return error_set(e, EXIT_RUN,
                         "device \"%s\" gives no room for %s, %zu bytes beside the %zu in use, "
                         "of %llu: %s (%d)",
                         d->facts.name, what, bytes, d->bytes, (unsigned long long)d->facts.memory,
                         device_word(status), (int)status);
    d->memory[d->n_memory++] = (struct device_memory){mem, bytes};
    d->bytes += bytes;
    d->most = d->bytes > d->most ? d->bytes : d->most;
    *b = (struct device_buffer){mem, bytes};
    return 0;
}

/* -- Transfers -------- */

/* A range that is not in the buffer is a mistake of ours, found here before the driver reads or writes
 * elsewhere. */
static int check_range(const struct device *d, const struct device_buffer *b, size_t at,
                       size_t bytes, const char *verb, struct error *e)
{
    if (device_alive(d, e))
        return -1;
    if (b->mem && at <= b->bytes && bytes <= b->bytes - at)
        return 0;
    return error_set(e, EXIT_RUN, "device \"%s\": to %s bytes %zu to %zu of a buffer of %zu",
                     d->facts.name, verb, at, at + bytes, b->bytes);
}

static int noted(struct device *d, cl_int status, cl_event event, const char *verb, size_t bytes,
                 void *staged, struct error *e)
{
    size_t row;

    if (status != CL_SUCCESS) {
        char what[64];
        snprintf(what, sizeof(what), "%zu bytes", bytes);
        free(staged);
        return device_lose(d, e, status, verb, what);
    }
    row = device_row(d, verb);
    return device_note(d, event, row, bytes, staged, e);
}

int device_write(struct device *d, struct device_buffer *b, size_t at, const void *data,
                 size_t bytes, struct error *e)
{
    cl_event event = NULL;
    cl_int status;
    void *staged = NULL;

    if (bytes == 0)
        return device_alive(d, e);
    if (check_range(d, b, at, bytes, "write", e))
        return -1;
    /* Little goes by a copy, so that the queue need not run dry for it. */
    if (bytes <= STAGED_MOST)
        staged = malloc(bytes);
    if (staged)
        memcpy(staged, data, bytes);
    status = clEnqueueWriteBuffer(d->queue, b->mem, staged ? CL_FALSE : CL_TRUE, at, bytes,
                                  staged ? staged : data, 0, NULL, &event);
    return noted(d, status, event, "write", bytes, staged, e);
}

int device_read(struct device *d, const struct device_buffer *b, size_t at, void *data,
                size_t bytes, struct error *e)
{
    cl_event event = NULL;
    cl_int status;

    if (bytes == 0)
        return device_alive(d, e);
    if (check_range(d, b, at, bytes, "read", e))
        return -1;
    status = clEnqueueReadBuffer(d->queue, b->mem, CL_TRUE, at, bytes, data, 0, NULL, &event);
    return noted(d, status, event, "read", bytes, NULL, e);
}

int device_copy(struct device *d, struct device_buffer *to, size_t to_at,
                const struct device_buffer *from, size_t from_at, size_t bytes, struct error *e)
{
    cl_event event = NULL;
    cl_int status;

    if (bytes == 0)
        return device_alive(d, e);
    if (check_range(d, to, to_at, bytes, "write", e) ||
        check_range(d, from, from_at, bytes, "read", e))
        return -1;
    status =
        clEnqueueCopyBuffer(d->queue, from->mem, to->mem, from_at, to_at, bytes, 0, NULL, &event);
    return noted(d, status, event, "copy", bytes, NULL, e);
}

int device_fill(struct device *d, struct device_buffer *b, size_t at, uint32_t value, size_t bytes,
                struct error *e)
{
    cl_event event = NULL;
    cl_int status;

    if (bytes == 0)
        return device_alive(d, e);
    if (check_range(d, b, at, bytes, "fill", e))
        return -1;
    status =
        clEnqueueFillBuffer(d->queue, b->mem, &value, sizeof(value), at, bytes, 0, NULL, &event);
    return noted(d, status, event, "fill", bytes, NULL, e);
}

int device_finish(struct device *d, struct error *e)
{
    cl_int status;

    if (device_alive(d, e))
        return -1;
    status = clFinish(d->queue);
    if (status != CL_SUCCESS)
        return device_lose(d, e, status, "finish", "what was asked of it");
    return device_collect(d, e);
}

#else

/* ISO C wants something in a file. */
extern const int device_is_not_built_in;

#endif
