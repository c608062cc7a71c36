/* opencl/devices.c -- lists OpenCL devices (see devices.h). Creates no context. */
#include "config.h"

#include "opencl/devices.h"

#include <stdlib.h>
#include <string.h>

#if SPH_HAVE_OPENCL

#include <CL/cl.h>

#define PLATFORMS_MAX 32u
#define DEVICES_MAX 64u

bool opencl_is_built(void)
{
    return true;
}

const char *opencl_type(uint64_t type)
{
    if (type & CL_DEVICE_TYPE_GPU)
        return "gpu";
    if (type & CL_DEVICE_TYPE_CPU)
        return "cpu";
    return type & CL_DEVICE_TYPE_ACCELERATOR ? "accelerator" : "other";
}

/* A text of a device; what does not fit is left empty. */
static void device_text(cl_device_id id, cl_device_info what, char *out, size_t size)
{
    if (clGetDeviceInfo(id, what, size, out, NULL) != CL_SUCCESS)
        out[0] = '\0';
    out[size - 1] = '\0';
}

static void describe(struct opencl_device *d, cl_platform_id platform, cl_device_id id)
{
    cl_device_type type = 0;
    cl_uint units = 0;
    cl_ulong memory = 0, largest = 0;
    cl_device_fp_config fp64 = 0;

    memset(d, 0, sizeof(*d));
    if (clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof(d->platform), d->platform, NULL) !=
        CL_SUCCESS)
        d->platform[0] = '\0';
    device_text(id, CL_DEVICE_NAME, d->name, sizeof(d->name));
    device_text(id, CL_DEVICE_VERSION, d->version, sizeof(d->version));
    device_text(id, CL_DRIVER_VERSION, d->driver, sizeof(d->driver));
    clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof(type), &type, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof(units), &units, NULL);
    clGetDeviceInfo(id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof(memory), &memory, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof(largest), &largest, NULL);
    clGetDeviceInfo(id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof(fp64), &fp64, NULL);
    d->type = opencl_type(type);
    d->units = units;
    d->memory = memory;
    d->largest = largest;
    d->fp64 = fp64 != 0;
}

static int add_platform(struct opencl_device **out, size_t *n, cl_platform_id platform,
                        struct error *e)
{
    cl_device_id device[DEVICES_MAX];
    cl_uint count = 0;
    struct opencl_device *grown;

    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, DEVICES_MAX, device, &count) != CL_SUCCESS ||
        count == 0)
        return 0;
    if (count > DEVICES_MAX)
        count = DEVICES_MAX;
    grown = realloc(*out, (*n + count) * sizeof(*grown));
    if (!grown)
        return error_memory(e, "the list of devices", (*n + count) * sizeof(*grown));
    *out = grown;
    for (cl_uint i = 0; i < count; i++)
        describe(&grown[(*n)++], platform, device[i]);
    return 0;
}

int opencl_devices(struct opencl_device **out, size_t *n, struct error *e)
{
    cl_platform_id platform[PLATFORMS_MAX];
    cl_uint count = 0;

    *out = NULL;
    *n = 0;
    /* An ICD loader without a platform answers with an error of its own: there are none. */
    if (clGetPlatformIDs(PLATFORMS_MAX, platform, &count) != CL_SUCCESS)
        return 0;
    for (cl_uint i = 0; i < count && i < PLATFORMS_MAX; i++) {
        if (add_platform(out, n, platform[i], e)) {
            free(*out);
            *out = NULL;
            *n = 0;
            return -1;
        }
    }
    return 0;
}

void *opencl_device_handle(size_t k)
{
    cl_platform_id platform[PLATFORMS_MAX];
    cl_device_id device[DEVICES_MAX];
    cl_uint platforms = 0;

    if (clGetPlatformIDs(PLATFORMS_MAX, platform, &platforms) != CL_SUCCESS)
        return NULL;
    for (cl_uint i = 0; i < platforms && i < PLATFORMS_MAX; i++) {
        cl_uint n = 0;
        if (clGetDeviceIDs(platform[i], CL_DEVICE_TYPE_ALL, DEVICES_MAX, device, &n) != CL_SUCCESS)
            continue;
        n = n > DEVICES_MAX ? DEVICES_MAX : n;
        if (k < n)
            return device[k];
        k -= n;
    }
    return NULL;
}

#else

void *opencl_device_handle(size_t k)
{
    (void)k;
    return NULL;
}

bool opencl_is_built(void)
{
    return false;
}

int opencl_devices(struct opencl_device **out, size_t *n, struct error *e)
{
    (void)e;
    *out = NULL;
    *n = 0;
    return 0;
}

#endif
