/* opencl/device_program.c -- programs and kernels of an open device: built or taken from the cache, looked
 * up, launched (see device.h). */
#include "config.h"

#if SPH_HAVE_OPENCL

#include "base/quiet.h"
#include "opencl/device_log.h"
#include "opencl/device_private.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Work items of a group where the kernel does not say. Always the same: drivers may compile a kernel
 * again for each size of groups. */
#define GROUP 64u

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* -- Build -------- */

/* The compiler's own words, in fresh memory, or NULL. */
static char *build_log(struct device *d, cl_program program)
{
    size_t size = 0;
    char *log;

    if (clGetProgramBuildInfo(program, d->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &size) != CL_SUCCESS)
        return NULL;
    log = malloc(size + 1);
    if (!log)
        return NULL;
    if (clGetProgramBuildInfo(program, d->id, CL_PROGRAM_BUILD_LOG, size, log, NULL) != CL_SUCCESS)
        size = 0;
    log[size] = '\0';
    return log;
}

/* One sentence: where, and what. */
static int build_failed(struct device *d, cl_program program, cl_int status, const char *text,
                        const char *what, struct error *e)
{
    struct device_complaint c;
    char *log = build_log(d, program);
    const char *const name = d->facts.name;

    d->failed = true;
    if (!log || !device_log_read(text, log, &c))
        error_set(e, EXIT_RUN, "device \"%s\" fails to build %s: %s (%d)", name, what,
                  device_word(status), (int)status);
    else if (c.line == 0)
        error_set(e, EXIT_REFUSED, "%s: does not compile on \"%s\": %s", what, name, c.message);
    else if (!c.file[0])
        error_set(e, EXIT_REFUSED, "%s, line %lu: does not compile on \"%s\": %s", what, c.line,
                  name, c.message);
    else {
        error_set(e, EXIT_REFUSED, "%s:%lu: does not compile on \"%s\": %s", c.file, c.line, name,
                  c.message);
        memcpy(d->wrong_file, c.file, sizeof(c.file));
    }
    free(log);
    return -1;
}

/* What compilers print beside their log is not for our user's screen. */
static cl_int build_quietly(struct device *d, cl_program program, const char *options)
{
    int kept[2];
    cl_int status;

    quiet_begin(kept);
    status = clBuildProgram(program, 1, &d->id, options, NULL, NULL);
    quiet_end(kept);
    return status;
}

static int build(struct device *d, cl_program *out, const char *text, const char *options,
                 const char *what, struct error *e)
{
    cl_int status;
    cl_program program = clCreateProgramWithSource(d->context, 1, &text, NULL, &status);

    if (status != CL_SUCCESS)
        return device_lose(d, e, status, "take", what);
    status = build_quietly(d, program, options);
    if (status != CL_SUCCESS) {
        build_failed(d, program, status, text, what, e);
        clReleaseProgram(program);
        return -1;
    }
    d->built++;
    *out = program;
    return 0;
}

/* -- Cache -------- */

/* A binary built before; NULL: there is none that the driver takes. */
static cl_program from_cache(struct device *d, const struct cache_key *key, const char *options)
{
    size_t bytes;
    unsigned char *binary = cache_get(key, &bytes);
    const unsigned char *const list[] = {binary};
    cl_int taken = CL_SUCCESS, status;
    cl_program program = NULL;

    if (!binary)
        return NULL;
    program = clCreateProgramWithBinary(d->context, 1, &d->id, &bytes, (const unsigned char **)list,
                                        &taken, &status);
    if (status == CL_SUCCESS && taken == CL_SUCCESS)
        status = build_quietly(d, program, options);
    free(binary);
    if (status == CL_SUCCESS && taken == CL_SUCCESS) {
        d->cached++;
        return program;
    }
    if (program)
        clReleaseProgram(program);
    return NULL;
}

/* PoCL does the better part of its work only here. */
static void to_cache(const struct cache_key *key, cl_program program)
{
    size_t bytes = 0;
    unsigned char *binary = NULL;

    if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof(bytes), &bytes, NULL) ==
            CL_SUCCESS &&
        bytes > 0)
        binary = malloc(bytes);
    if (binary &&
        clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof(binary), &binary, NULL) == CL_SUCCESS)
        cache_put(key, binary, bytes);
    free(binary);
}

static int build_or_take(struct device *d, cl_program *out, const char *text, const char *options,
                         const char *what, struct error *e)
{
    struct cache_key key = device_cache_key(d);

    cache_key_text(&key, options);
    cache_key_text(&key, text);
    *out = from_cache(d, &key, options);
    if (*out)
        return 0;
    /* Ranks that share a machine want the same at the same time. */
    bool waited;
    const int turn = cache_begin(&key, &waited);
    int status = 0;
    *out = waited ? from_cache(d, &key, options) : NULL;
    if (!*out) {
        status = build(d, out, text, options, what, e);
        if (!status)
            to_cache(&key, *out);
    }
    cache_end(&key, turn);
    return status;
}

const char *device_build_file(const struct device *d)
{
    return d->wrong_file[0] ? d->wrong_file : NULL;
}

int device_build(struct device *d, struct device_program **out, const char *text,
                 const char *options, const char *what, struct error *e)
{
    struct device_program *p;
    const double begin = now();

    *out = NULL;
    if (device_alive(d, e))
        return -1;
    p = calloc(1, sizeof(*p));
    if (!p)
        return error_memory(e, what, sizeof(*p));
    d->wrong_file[0] = '\0';
    if (build_or_take(d, &p->program, text, options ? options : "", what, e)) {
        free(p);
        return -1;
    }
    d->build_seconds += now() - begin;
    p->next = d->program;
    d->program = p;
    *out = p;
    return 0;
}

double device_build_seconds(const struct device *d, unsigned *cached, unsigned *built)
{
    if (cached)
        *cached = d->cached;
    if (built)
        *built = d->built;
    return d->build_seconds;
}

void device_program_free(struct device *d, struct device_program *p)
{
    struct device_program **at = &d->program;

    if (!p)
        return;
    while (*at && *at != p)
        at = &(*at)->next;
    if (*at)
        *at = p->next;
    while (p->kernel) {
        struct device_kernel *k = p->kernel;
        p->kernel = k->next;
        clReleaseKernel(k->kernel);
        free(k->name);
        free(k);
    }
    clReleaseProgram(p->program);
    free(p);
}

/* -- Kernels -------- */

/* How many work items go together, as the kernel says, or else as it can. */
static size_t group_of(const struct device *d, cl_kernel kernel)
{
    size_t said[3] = {0, 0, 0}, most = 0;

    clGetKernelWorkGroupInfo(kernel, d->id, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof(said), said,
                             NULL);
    if (said[0] > 0)
        return said[0];
    clGetKernelWorkGroupInfo(kernel, d->id, CL_KERNEL_WORK_GROUP_SIZE, sizeof(most), &most, NULL);
    return most > 0 && most < GROUP ? most : GROUP;
}

int device_kernel(struct device *d, struct device_program *p, const char *name, const char *timed,
                  struct device_kernel **out, struct error *e)
{
    struct device_kernel *k;
    cl_int status;

    *out = NULL;
    if (device_alive(d, e))
        return -1;
    k = calloc(1, sizeof(*k));
    if (k)
        k->name = strdup(name);
    if (k)
        k->row = device_row(d, timed ? timed : name);
    if (!k || !k->name || k->row == SIZE_MAX) {
        if (k)
            free(k->name);
        free(k);
        return error_memory(e, name, sizeof(*k));
    }
    k->kernel = clCreateKernel(p->program, name, &status);
    if (status != CL_SUCCESS) {
        free(k->name);
        free(k);
        d->failed = true;
        return error_set(e, EXIT_RUN, "device \"%s\" has no kernel %s: %s (%d)", d->facts.name,
                         name, device_word(status), (int)status);
    }
    clGetKernelInfo(k->kernel, CL_KERNEL_NUM_ARGS, sizeof(k->n_arg), &k->n_arg, NULL);
    k->group = group_of(d, k->kernel);
    k->next = p->kernel;
    p->kernel = k;
    *out = k;
    return 0;
}

static int set_args(struct device *d, struct device_kernel *k, const struct device_arg *arg,
                    size_t n, struct error *e)
{
    if (n != k->n_arg)
        return error_set(e, EXIT_RUN, "device \"%s\": kernel %s takes %u arguments, not %zu",
                         d->facts.name, k->name, (unsigned)k->n_arg, n);
    for (size_t i = 0; i < n; i++) {
        cl_mem mem = arg[i].buffer ? arg[i].buffer->mem : NULL;
        const cl_int status =
            arg[i].buffer ? clSetKernelArg(k->kernel, (cl_uint)i, sizeof(mem), &mem)
                          : clSetKernelArg(k->kernel, (cl_uint)i, arg[i].size, arg[i].value);
        d->failed = d->failed || status != CL_SUCCESS;
        if (status != CL_SUCCESS)
            return error_set(e, EXIT_RUN,
                             "device \"%s\" refuses argument %zu of kernel %s: %s (%d)",
                             d->facts.name, i, k->name, device_word(status), (int)status);
    }
    return 0;
}

int device_launch(struct device *d, struct device_kernel *k, size_t items,
                  const struct device_arg *arg, size_t n_arg, struct error *e)
{
    const size_t global = (items + k->group - 1) / k->group * k->group;
    cl_event event = NULL;
    cl_int status;

    if (device_alive(d, e))
        return -1;
    if (items == 0)
        return 0;
    if (set_args(d, k, arg, n_arg, e))
        return -1;
    status =
        clEnqueueNDRangeKernel(d->queue, k->kernel, 1, NULL, &global, &k->group, 0, NULL, &event);
    if (status != CL_SUCCESS)
        return device_lose(d, e, status, "run", d->time[k->row].name);
    return device_note(d, event, k->row, 0, NULL, e);
}

#else

/* ISO C wants something in a file. */
extern const int device_program_is_not_built_in;

#endif
