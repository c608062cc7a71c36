/* tests/unit/device_clouds.h -- an OpenCL device to test on, and clouds of points on it. */
#ifndef TESTS_DEVICE_CLOUDS_H
#define TESTS_DEVICE_CLOUDS_H

#include "clouds.h"
#include "opencl/devices.h"
#include "opencl/lists.h"

/* The first one with double precision; NULL if there is none. */
static inline struct device *any_device(void)
{
    struct opencl_device *all = NULL;
    struct device *d = NULL;
    struct error e;
    size_t n = 0, k = 0;

    if (!opencl_is_built() || opencl_devices(&all, &n, &e) != 0) {
        return NULL;
    }
    while (k < n && !all[k].fp64) {
        k++;
    }
    free(all);
    assert_true(k == n || device_open(&d, k, &e) == 0);
    return d;
}

/* Planes of a cloud in a buffer, `first` elements from their begin: ids, x, h. */
struct there {
    struct device_buffer wide;
    struct device_cloud c;
};

static inline struct there cloud_there(struct device *d, const struct cloud *c, const int64_t *id,
                                       size_t first)
{
    struct there t = {
        .c = {.dim = c->dim, .plane = first + c->n + 64, .first = first, .n = c->n, .x_slot = 1}};
    size_t plane = t.c.plane * sizeof(double);
    struct error e;

    t.c.h_slot = 1 + (uint32_t)c->dim;
    t.c.scale = c->scale;
    assert_int_equal(device_reserve(d, &t.wide, (2 + (size_t)c->dim) * plane, "a test", &e), 0);
    for (int k = -1; k <= c->dim && c->n > 0; k++) {
        const void *from = k < 0 ? (const void *)id : k < c->dim ? c->x[k] : c->h;

        if (from) {
            assert_int_equal(device_write(d, &t.wide, (size_t)(k + 1) * plane + first * 8, from,
                                          c->n * sizeof(double), &e),
                             0);
        }
    }
    return t;
}

#endif
