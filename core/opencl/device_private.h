/* opencl/device_private.h -- what the parts of an open device share (device*.c alone; they alone call
 * OpenCL to compute). */
#ifndef OPENCL_DEVICE_PRIVATE_H
#define OPENCL_DEVICE_PRIVATE_H

#include "opencl/device.h"
#include "opencl/device_cache.h"

#include <CL/cl.h>

/* A launch or transfer whose time is not read yet. */
struct device_pending {
    cl_event event;
    size_t row; /* of the times */
    size_t span;
    void *staged; /* what a write reads from; freed after it */
};

struct device_kernel {
    struct device_kernel *next;
    cl_kernel kernel;
    char *name;
    size_t row;   /* of the times */
    size_t group; /* work items of a work group */
    cl_uint n_arg;
};

struct device_program {
    struct device_program *next;
    cl_program program;
    struct device_kernel *kernel; /* all taken so far */
};

struct device_memory {
    cl_mem mem;
    size_t bytes;
};

struct device {
    struct device_facts facts;
    cl_device_id id;
    bool part; /* `id` is a part of a device, ours to release */
    cl_context context;
    cl_command_queue queue;
    struct device_memory *memory; /* all buffers */
    size_t n_memory, bytes, most;
    struct device_program *program; /* all of them */
    double build_seconds;
    unsigned cached, built;
    char wrong_file[256];     /* of the last build that failed */
    struct device_time *time; /* a row a name */
    size_t n_time;
    struct device_span *span;
    size_t n_span, now;             /* now: what is given counts to it */
    size_t last;                    /* of the last command that was read */
    cl_ulong last_end;              /* when that ended; 0: there was none */
    struct device_pending *pending; /* in the queue's order */
    size_t n_pending, unflushed;
    bool failed; /* to do something */
    bool lost;   /* the device itself failed: */
    struct error why;
};

/* OpenCL's word for a status. */
const char *device_word(cl_int status);
/* What the driver was asked for, failed: "device \"NAME\" fails to VERB WHAT: CL_WORD (NUMBER)". From now on
 * nothing else works. Returns -1. */
int device_lose(struct device *d, struct error *e, cl_int status, const char *verb,
                const char *what);
/* What distinguishes this device, its driver and this sph from others, for the cache. */
struct cache_key device_cache_key(const struct device *d);
/* -1 with the first failure's sentence, once the device has failed. */
int device_alive(const struct device *d, struct error *e);

/* The row of the times of that name, made if new; SIZE_MAX without memory. */
size_t device_row(struct device *d, const char *name);
/* Notes a command's event for its row; takes the event over, and `staged` (NULL: nothing), which is freed
 * after the command. */
int device_note(struct device *d, cl_event event, size_t row, size_t bytes, void *staged,
                struct error *e);
/* Reads the times of all that is noted; waits for it. */
int device_collect(struct device *d, struct error *e);

#endif
