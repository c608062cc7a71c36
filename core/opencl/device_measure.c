/* opencl/device_measure.c -- what a device reaches with the simplest kernels: a triad of long buffers, and
 * chains of multiply-adds (see device.h). The measure for what others reach. Kept in the cache. */
#include "config.h"

#if SPH_HAVE_OPENCL

#include "opencl/device_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Eight chains of vectors: enough to hide a multiply-add's latency, few enough for registers. */
static const char source[] =
    "#ifdef F64\n"
    "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
    "typedef double real;\n"
    "#else\n"
    "typedef float real;\n"
    "#endif\n"
    "#define CAT_(a, b) a##b\n"
    "#define CAT(a, b) CAT_(a, b)\n"
    "#ifdef F64\n"
    "typedef CAT(double, WIDTH) wide;\n"
    "#else\n"
    "typedef CAT(float, WIDTH) wide;\n"
    "#endif\n"
    "__kernel __attribute__((reqd_work_group_size(64, 1, 1)))\n"
    "void triad(__global const ulong *restrict b, __global const ulong *restrict c,\n"
    "           __global ulong *restrict a, const ulong n)\n"
    "{\n"
    "    const size_t i = get_global_id(0);\n"
    "    if (i < n)\n"
    "        a[i] = b[i] + 3 * c[i];\n"
    "}\n"
    "__kernel __attribute__((reqd_work_group_size(64, 1, 1)))\n"
    "void chains(__global ulong *out, const ulong turns)\n"
    "{\n"
    "    const wide m = (wide)((real)0.999), p = (wide)((real)get_global_id(0));\n"
    "    wide x[8];\n"
    "    for (int c = 0; c < 8; c++)\n"
    "        x[c] = p + (wide)((real)c);\n"
    "    for (ulong k = 0; k < turns; k++) {\n"
    "#pragma unroll\n"
    "        for (int c = 0; c < 8; c++)\n"
    "            x[c] = fma(x[c], m, p);\n"
    "    }\n"
    "    x[0] += x[1] + x[2] + x[3] + x[4] + x[5] + x[6] + x[7];\n"
    "    real sum = 0;\n"
    "    real each[WIDTH];\n"
    "    CAT(vstore, WIDTH)(x[0], 0, each);\n"
    "    for (int k = 0; k < WIDTH; k++)\n"
    "        sum += each[k];\n"
    "    out[get_global_id(0)] = (ulong)sum;\n"
    "}\n";

enum { REPEATS = 8, FLOPS_PER_TURN = 8 * 2 };

static const double enough = 0.01; /* [s] of one launch of chains */

/* Seconds by the device's clock, waited for. The times of launches in the table are not touched: these are
 * none of the caller's work. */
static int timed(struct device *d, cl_kernel kernel, size_t items, double *seconds, struct error *e)
{
    static const size_t group = 64;
    cl_ulong begin = 0, end = 0;
    cl_event event = NULL;
    cl_int status =
        clEnqueueNDRangeKernel(d->queue, kernel, 1, NULL, &items, &group, 0, NULL, &event);

    if (status == CL_SUCCESS)
        status = clWaitForEvents(1, &event);
    if (status != CL_SUCCESS)
        return device_lose(d, e, status, "run", "a measurement");
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof(begin), &begin, NULL);
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof(end), &end, NULL);
    clReleaseEvent(event);
    *seconds = 1e-9 * (double)(end > begin ? end - begin : 1);
    return 0;
}

/* The best of some launches with these arguments. */
static int best_of(struct device *d, struct device_program *p, const char *name, size_t items,
                   const struct device_buffer *buffer, size_t n_buffer, cl_ulong last, int repeats,
                   double *seconds, struct error *e)
{
    cl_int status;
    cl_kernel kernel = clCreateKernel(p->program, name, &status);
    int failed = 0;

    if (status != CL_SUCCESS)
        return device_lose(d, e, status, "take", name);
    for (size_t i = 0; i < n_buffer; i++)
        clSetKernelArg(kernel, (cl_uint)i, sizeof(cl_mem), &buffer[i].mem);
    clSetKernelArg(kernel, (cl_uint)n_buffer, sizeof(last), &last);
    *seconds = 1e30;
    for (int k = 0; k < repeats && !failed; k++) {
        double once = 0;
        failed = timed(d, kernel, items, &once, e);
        *seconds = !failed && once < *seconds ? once : *seconds;
    }
    clReleaseKernel(kernel);
    return failed;
}

/* Longer than any cache, and no more than a sixth of the memory for three of them. */
static size_t triad_items(const struct device *d)
{
    const uint64_t wanted = (uint64_t)(d->facts.cpu ? 32 : 256) << 20;
    const uint64_t free = d->facts.memory - (d->bytes < d->facts.memory ? d->bytes : 0);
    uint64_t bytes = wanted;

    if (bytes > free / 6)
        bytes = free / 6;
    if (bytes > d->facts.largest)
        bytes = d->facts.largest;
    return (size_t)bytes / 512 * 64;
}

static int bandwidth(struct device *d, struct device_program *p, double *rate, struct error *e)
{
    struct device_buffer b[3] = {{NULL, 0}, {NULL, 0}, {NULL, 0}};
    const size_t n = triad_items(d);
    double seconds = 1;
    int status = 0;

    for (int k = 0; k < 3 && !status; k++)
        status = device_reserve(d, &b[k], 8 * n, "measurement of bandwidth", e);
    status = status || best_of(d, p, "triad", n, b, 3, n, REPEATS, &seconds, e) ? -1 : 0;
    for (int k = 0; k < 3; k++)
        device_release(d, &b[k]);
    *rate = 24 * (double)n / seconds;
    return status;
}

/* Doubles the turns until a launch is long enough to be measured. */
static int chains(struct device *d, struct device_program *p, unsigned width, double *rate,
                  struct error *e)
{
    const size_t items = (size_t)d->facts.units * (d->facts.cpu ? 256 : 4096);
    struct device_buffer b = {NULL, 0};
    double seconds = 0;
    cl_ulong turns = 64;
    int status = device_reserve(d, &b, 8 * items, "measurement of multiply-adds", e);

    while (!status && seconds < enough) {
        turns *= seconds < enough / 8 ? 8 : 2;
        status = best_of(d, p, "chains", items, &b, 1, turns, 1, &seconds, e);
    }
    if (!status)
        status = best_of(d, p, "chains", items, &b, 1, turns, REPEATS, &seconds, e);
    device_release(d, &b);
    *rate = FLOPS_PER_TURN * (double)width * (double)items * (double)turns / seconds;
    return status;
}

static int measure_with(struct device *d, bool f64, double *rate, double *bytes, struct error *e)
{
    /* A processor wants whole registers (AVX-512's), a GPU few. */
    const unsigned width = d->facts.cpu ? (f64 ? 8 : 16) : 2;
    char options[64];
    struct device_program *p;
    int status;

    snprintf(options, sizeof(options), "-DWIDTH=%u%s", width, f64 ? " -DF64" : "");
    if (device_build(d, &p, source, options, "the measurement of the device", e))
        return -1;
    status = chains(d, p, width, rate, e);
    if (!status && bytes)
        status = bandwidth(d, p, bytes, e);
    device_program_free(d, p);
    return status;
}

int device_measure(struct device *d, struct device_rates *r, struct error *e)
{
    struct cache_key key = device_cache_key(d);
    const struct device kept = *d;
    size_t n;
    void *known;
    int status;

    memset(r, 0, sizeof(*r));
    if (device_alive(d, e))
        return -1;
    cache_key_text(&key, source);
    known = cache_get(&key, &n);
    if (known && n == sizeof(*r)) {
        memcpy(r, known, n);
        free(known);
        return 0;
    }
    free(known);
    status = measure_with(d, false, &r->flops_f32, &r->bytes, e);
    if (!status && d->facts.fp64)
        status = measure_with(d, true, &r->flops_f64, NULL, e);
    /* None of the caller's memory, nor programs. */
    d->most = kept.most;
    d->build_seconds = kept.build_seconds;
    d->cached = kept.cached;
    d->built = kept.built;
    if (!status)
        cache_put(&key, r, sizeof(*r));
    return status;
}

#else

/* ISO C wants something in a file. */
extern const int device_measure_is_not_built_in;

#endif
