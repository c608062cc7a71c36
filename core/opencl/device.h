/* opencl/device.h -- an open OpenCL device: memory, programs, launches, and the time they took. The only
 * door to OpenCL for all that computes on a device; knows nothing of particles.
 *
 * One queue, in order; a launch returns before it is done, a read waits for all before it. All calls
 * [main]. What fails says "device \"NAME\" ...: WHY" with EXIT_RUN; where what a plugin wrote does not
 * build, EXIT_REFUSED. After a failure of the device itself nothing but device_close is of use: what is
 * on the host stays right. */
#ifndef OPENCL_DEVICE_H
#define OPENCL_DEVICE_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct device;

struct device_facts {
    char name[128], platform[128], driver[128];
    const char *type;  /* "cpu", "gpu", "accelerator", "other" */
    bool cpu;          /* explicit vectors pay: a work item takes a group of destinations */
    bool fp64;         /* has double precision */
    uint32_t units;    /* compute units */
    uint64_t memory;   /* of the device [bytes] */
    uint64_t largest;  /* that one buffer may have [bytes] */
    size_t group_most; /* work items of a work group */
};

/* `number` as `sph info --devices` counts. None there, or none of that number: EXIT_USAGE. */
int device_open(struct device **out, size_t number, struct error *e);
/* The same with no more than so many compute units, where it is a processor that can be divided; 0: with all. */
int device_open_part(struct device **out, size_t number, unsigned units, struct error *e);
/* What it is, without opening it. */
int device_look(size_t number, struct device_facts *out, struct error *e);
void device_close(struct device *d); /* NULL: nothing */
const struct device_facts *device_facts(const struct device *d);
/* -1 with EXIT_USAGE for a device without double precision. */
int device_need_fp64(const struct device *d, struct error *e);
/* Whether a call has failed for a reason of the device's: no memory, or worse. *lost: nothing works any longer. */
bool device_failed(const struct device *d, bool *lost);

/* -- Memory -------- */

/* Begin with zeros. Freed by device_release, or with the device. */
struct device_buffer {
    void *mem; /* OpenCL's own handle */
    size_t bytes;
};

/* At least so large from now on; what it held is lost if it grows. `what` it is for, in messages: "neighbour
 * lists". */
int device_reserve(struct device *d, struct device_buffer *b, size_t bytes, const char *what,
                   struct error *e);
void device_release(struct device *d, struct device_buffer *b);
/* Bytes in all buffers now, and at most so far. */
size_t device_bytes(const struct device *d, size_t *most);
/* Between the host and a buffer, from byte `at` on. */
int device_write(struct device *d, struct device_buffer *b, size_t at, const void *data,
                 size_t bytes, struct error *e);
int device_read(struct device *d, const struct device_buffer *b, size_t at, void *data,
                size_t bytes, struct error *e);
/* Within the device; the ranges do not overlap. */
int device_copy(struct device *d, struct device_buffer *to, size_t to_at,
                const struct device_buffer *from, size_t from_at, size_t bytes, struct error *e);
/* bytes % 4 == 0 */
int device_fill(struct device *d, struct device_buffer *b, size_t at, uint32_t value, size_t bytes,
                struct error *e);

/* -- Programs -------- */

struct device_program;
struct device_kernel;

/* From OpenCL C 1.2, out of the cache of binaries (device_cache.h) where source, options, device, driver and
 * sph are the same as once before. `what` it is, in messages: "the scene's sweeps". `text` is not kept.
 * What does not compile: "FILE:LINE: does not compile on \"NAME\": MESSAGE" with EXIT_REFUSED, where
 * `#line` names files. Freed with the device or by device_program_free. */
int device_build(struct device *d, struct device_program **out, const char *text,
                 const char *options, const char *what, struct error *e);
/* The FILE that the last device_build complained of, so that the caller can say whose it is; NULL: none.
 * The device's, until the next build. */
const char *device_build_file(const struct device *d);
void device_program_free(struct device *d, struct device_program *p);
/* Seconds that builds took; how many came out of the cache, how many did not. */
double device_build_seconds(const struct device *d, unsigned *cached, unsigned *built);

/* The program's kernel of that name; the program's own. `timed` as what its time counts: kernels that say the
 * same share a row of device_times; NULL: as `name`. */
int device_kernel(struct device *d, struct device_program *p, const char *name, const char *timed,
                  struct device_kernel **out, struct error *e);

/* An argument. */
struct device_arg {
    const struct device_buffer *buffer; /* or */
    const void *value;                  /* of `size` bytes; or */
    size_t size;                        /* alone: local memory */
};
#define DEVICE_BUFFER(b)                                                                           \
    (struct device_arg)                                                                            \
    {                                                                                              \
        .buffer = (b)                                                                              \
    }
#define DEVICE_VALUE(x)                                                                            \
    (struct device_arg)                                                                            \
    {                                                                                              \
        .value = &(x), .size = sizeof(x)                                                           \
    }
#define DEVICE_LOCAL(bytes)                                                                        \
    (struct device_arg)                                                                            \
    {                                                                                              \
        .size = (bytes)                                                                            \
    }

/* With the arguments in order. At least `items` work items: rounded up to whole work groups where the kernel
 * says how large those are (reqd_work_group_size, which it should: PoCL vectorizes only then), so a kernel
 * must look at its number. 0 items: nothing
 * is done. */
int device_launch(struct device *d, struct device_kernel *k, size_t items,
                  const struct device_arg *arg, size_t n_arg, struct error *e);
/* Waits until all is done. */
int device_finish(struct device *d, struct error *e);

/* -- Time -------- */

/* By the device's own events: what kernels of one name took. Transfers are "read", "write", "copy", "fill". */
struct device_time {
    const char *name; /* the device's */
    double seconds;
    uint64_t launches, bytes; /* bytes: of transfers */
};
/* All so far, waited for; the device's, until the next call. */
const struct device_time *device_times(struct device *d, size_t *n);

/* Commands are counted in spans as well, by what the host was about when it gave them. What follows counts to
 * span k, a small number, 0 at first; returns the one that was counted to. */
size_t device_span(struct device *d, size_t k);
struct device_span {
    double busy; /* its commands [s] */
    double idle; /* the device had nothing to do, from one of its commands to its next [s] */
};
/* All so far, waited for; the device's, until the next call. */
const struct device_span *device_spans(struct device *d, size_t *n);

/* What the device reaches with the simplest kernels; 0: does not have it. */
struct device_rates {
    double bytes;                /* of a triad, read and written [1/s] */
    double flops_f32, flops_f64; /* of multiply-adds, two each [1/s] */
};
/* Measured in some tenths of a second, or known from an earlier run. Takes some of the device's memory
 * meanwhile. */
int device_measure(struct device *d, struct device_rates *r, struct error *e);

#endif
