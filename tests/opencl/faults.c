/* faults.c -- OpenCL calls that fail when they are told to: in front of libOpenCL by LD_PRELOAD, or linked into a
 * test. The environment's SPH_FAULT lists, with commas between:
 *
 *     FUNCTION:N:STATUS   the N-th call (from 1 on) of it fails with that status, such as
 *                         clEnqueueNDRangeKernel:40:-5; N of 0: each call
 *     no-devices          there are none
 *     no-fp64             no device has double precision
 *     memory:BYTES        so much memory have devices, and their largest buffer
 *
 * It is read at each call; another list begins to count anew. FUNCTION is one of those below. */
#include "config.h"

#if SPH_HAVE_OPENCL

/* They are to stand before libOpenCL's. */
#pragma GCC visibility push(default)
#include <CL/cl.h>
#pragma GCC visibility pop
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum function {
    CREATE_CONTEXT,
    CREATE_BUFFER,
    CREATE_BINARY,
    BUILD,
    KERNEL,
    LAUNCH,
    READ,
    WRITE,
    COPY,
    FILL,
    FINISH,
    WAIT,
    N_FUNCTIONS
};
static const char *const function_name[N_FUNCTIONS] = {"clCreateContext",
                                                       "clCreateBuffer",
                                                       "clCreateProgramWithBinary",
                                                       "clBuildProgram",
                                                       "clCreateKernel",
                                                       "clEnqueueNDRangeKernel",
                                                       "clEnqueueReadBuffer",
                                                       "clEnqueueWriteBuffer",
                                                       "clEnqueueCopyBuffer",
                                                       "clEnqueueFillBuffer",
                                                       "clFinish",
                                                       "clWaitForEvents"};

/* What is listed now. */
static struct {
    char list[256];
    bool hide, no_fp64;
    unsigned long long memory;
    long at[N_FUNCTIONS]; /* the call that fails; -1: none; 0: each */
    cl_int status[N_FUNCTIONS];
    long calls[N_FUNCTIONS];
} told;

static void take(const char *word)
{
    char name[64];
    long at;
    int status;

    told.hide |= strcmp(word, "no-devices") == 0;
    told.no_fp64 |= strcmp(word, "no-fp64") == 0;
    if (sscanf(word, "memory:%llu", &told.memory) == 1 ||
        sscanf(word, "%63[^:]:%ld:%d", name, &at, &status) != 3)
        return;
    for (int f = 0; f < N_FUNCTIONS; f++)
        if (strcmp(name, function_name[f]) == 0) {
            told.at[f] = at;
            told.status[f] = status;
        }
}

static void listen(void)
{
    const char *list = getenv("SPH_FAULT");
    char words[sizeof(told.list)], *rest = NULL;

    list = list ? list : "";
    if (strncmp(list, told.list, sizeof(told.list) - 1) == 0)
        return;
    memset(&told, 0, sizeof(told));
    snprintf(told.list, sizeof(told.list), "%s", list);
    snprintf(words, sizeof(words), "%s", list);
    for (int f = 0; f < N_FUNCTIONS; f++)
        told.at[f] = -1;
    for (char *w = strtok_r(words, ",", &rest); w; w = strtok_r(NULL, ",", &rest))
        take(w);
}

/* The status that this call is to fail with, or CL_SUCCESS. */
static cl_int fault(enum function f)
{
    listen();
    if (told.list[0] == '\0')
        return CL_SUCCESS;
    told.calls[f]++;
    return told.at[f] == 0 || told.at[f] == told.calls[f] ? told.status[f] : CL_SUCCESS;
}

/* The driver's own, as a pointer to a function of that type. */
#define REAL(name)                                                                                 \
    static __typeof__(name) *real;                                                                 \
    if (!real)                                                                                     \
    *(void **)&real = dlsym(RTLD_NEXT, #name)

#define FAIL_STATUS(f)                                                                             \
    {                                                                                              \
        const cl_int wrong = fault(f);                                                             \
        if (wrong != CL_SUCCESS)                                                                   \
            return wrong;                                                                          \
    }
#define FAIL_NULL(f)                                                                               \
    {                                                                                              \
        const cl_int wrong = fault(f);                                                             \
        if (wrong != CL_SUCCESS) {                                                                 \
            if (status)                                                                            \
                *status = wrong;                                                                   \
            return NULL;                                                                           \
        }                                                                                          \
    }

/* -- What there is -------- */

CL_API_ENTRY cl_int CL_API_CALL clGetPlatformIDs(cl_uint room, cl_platform_id *out, cl_uint *n)
{
    REAL(clGetPlatformIDs);
    listen();
    if (told.hide) {
        if (n)
            *n = 0;
        return -1001; /* CL_PLATFORM_NOT_FOUND_KHR: what the ICD loader says */
    }
    return real(room, out, n);
}

CL_API_ENTRY cl_int CL_API_CALL clGetDeviceInfo(cl_device_id id, cl_device_info what, size_t size,
                                                void *out, size_t *needed)
{
    REAL(clGetDeviceInfo);
    const cl_int status = real(id, what, size, out, needed);

    listen();
    if (status != CL_SUCCESS || !out)
        return status;
    if (told.no_fp64 && what == CL_DEVICE_DOUBLE_FP_CONFIG)
        memset(out, 0, size);
    if (told.memory && (what == CL_DEVICE_GLOBAL_MEM_SIZE || what == CL_DEVICE_MAX_MEM_ALLOC_SIZE))
        memcpy(out, &(cl_ulong){told.memory}, sizeof(cl_ulong));
    return status;
}

/* -- What fails -------- */

CL_API_ENTRY cl_context CL_API_CALL
clCreateContext(const cl_context_properties *properties, cl_uint n, const cl_device_id *id,
                void(CL_CALLBACK *tell)(const char *, const void *, size_t, void *), void *context,
                cl_int *status)
{
    REAL(clCreateContext);
    FAIL_NULL(CREATE_CONTEXT)
    return real(properties, n, id, tell, context, status);
}

CL_API_ENTRY cl_mem CL_API_CALL clCreateBuffer(cl_context c, cl_mem_flags flags, size_t size,
                                               void *host, cl_int *status)
{
    REAL(clCreateBuffer);
    FAIL_NULL(CREATE_BUFFER)
    return real(c, flags, size, host, status);
}

CL_API_ENTRY cl_program CL_API_CALL clCreateProgramWithBinary(cl_context c, cl_uint n,
                                                              const cl_device_id *id,
                                                              const size_t *bytes,
                                                              const unsigned char **binary,
                                                              cl_int *each, cl_int *status)
{
    REAL(clCreateProgramWithBinary);
    FAIL_NULL(CREATE_BINARY)
    return real(c, n, id, bytes, binary, each, status);
}

CL_API_ENTRY cl_int CL_API_CALL clBuildProgram(cl_program p, cl_uint n, const cl_device_id *id,
                                               const char *options,
                                               void(CL_CALLBACK *tell)(cl_program, void *),
                                               void *context)
{
    REAL(clBuildProgram);
    FAIL_STATUS(BUILD)
    return real(p, n, id, options, tell, context);
}

CL_API_ENTRY cl_kernel CL_API_CALL clCreateKernel(cl_program p, const char *name, cl_int *status)
{
    REAL(clCreateKernel);
    FAIL_NULL(KERNEL)
    return real(p, name, status);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue q, cl_kernel k, cl_uint dim,
                                                       const size_t *from, const size_t *items,
                                                       const size_t *group, cl_uint n,
                                                       const cl_event *wait, cl_event *event)
{
    REAL(clEnqueueNDRangeKernel);
    FAIL_STATUS(LAUNCH)
    return real(q, k, dim, from, items, group, n, wait, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue q, cl_mem b, cl_bool wait_for,
                                                    size_t at, size_t bytes, void *out, cl_uint n,
                                                    const cl_event *wait, cl_event *event)
{
    REAL(clEnqueueReadBuffer);
    FAIL_STATUS(READ)
    return real(q, b, wait_for, at, bytes, out, n, wait, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueWriteBuffer(cl_command_queue q, cl_mem b, cl_bool wait_for,
                                                     size_t at, size_t bytes, const void *in,
                                                     cl_uint n, const cl_event *wait,
                                                     cl_event *event)
{
    REAL(clEnqueueWriteBuffer);
    FAIL_STATUS(WRITE)
    return real(q, b, wait_for, at, bytes, in, n, wait, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueCopyBuffer(cl_command_queue q, cl_mem from, cl_mem to,
                                                    size_t from_at, size_t to_at, size_t bytes,
                                                    cl_uint n, const cl_event *wait,
                                                    cl_event *event)
{
    REAL(clEnqueueCopyBuffer);
    FAIL_STATUS(COPY)
    return real(q, from, to, from_at, to_at, bytes, n, wait, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueFillBuffer(cl_command_queue q, cl_mem b,
                                                    const void *pattern, size_t size, size_t at,
                                                    size_t bytes, cl_uint n, const cl_event *wait,
                                                    cl_event *event)
{
    REAL(clEnqueueFillBuffer);
    FAIL_STATUS(FILL)
    return real(q, b, pattern, size, at, bytes, n, wait, event);
}

CL_API_ENTRY cl_int CL_API_CALL clFinish(cl_command_queue q)
{
    REAL(clFinish);
    FAIL_STATUS(FINISH)
    return real(q);
}

CL_API_ENTRY cl_int CL_API_CALL clWaitForEvents(cl_uint n, const cl_event *event)
{
    REAL(clWaitForEvents);
    FAIL_STATUS(WAIT)
    return real(n, event);
}

#else

/* ISO C wants something in a file. */
extern const int faults_are_not_built_in;

#endif
