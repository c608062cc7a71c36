/* opencl/devices.h -- which OpenCL devices there are, as `--device opencl:N` numbers them. */
#ifndef OPENCL_DEVICES_H
#define OPENCL_DEVICES_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct opencl_device {
    char platform[128], name[128], version[128], driver[128];
    const char *type; /* "cpu", "gpu", "accelerator", "other" */
    uint32_t units;   /* compute units */
    uint64_t memory;  /* [bytes] */
    uint64_t largest; /* that one buffer may have [bytes] */
    bool fp64;        /* has double precision */
};

/* A cl_device_type's word. */
const char *opencl_type(uint64_t type);

/* Was OpenCL built in? */
bool opencl_is_built(void);

/* All devices of all platforms, in the order of the installed platforms; the caller frees *out.
 * None is no error. */
int opencl_devices(struct opencl_device **out, size_t *n, struct error *e);

/* OpenCL's own handle (a cl_device_id) of device k of that list, or NULL. */
void *opencl_device_handle(size_t k);

#endif
