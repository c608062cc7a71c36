/* on_device.h -- for tests and measurements: a scene's passes natively and on a device, on the same particles. No
 * cmocka in here. */
#ifndef TESTS_UNIT_ON_DEVICE_H
#define TESTS_UNIT_ON_DEVICE_H

#include "opencl/kernels.h"
#include "run/run.h"

/* A plan in motion, and what it has on a device. */
struct on_device {
    char *text;
    struct document document;
    struct scene scene;
    struct registry registry;
    struct plan plan;
    struct run run;
    bool has_document, has_scene, has_registry, has_plan, has_run;
    struct device *d;
    struct arena *arena;      /* [array] */
    struct device_list *list; /* [plan.n_list] */
    struct stage *stage;
    size_t n_stage;
    struct kernels *kernels;
};

/* Whether there is a device with double precision, and which. */
bool on_device_there(size_t *number, struct error *e);
/* A scene (JSON with ' in place of ") made, filled, and evaluated once natively; the stages of an evaluation built
 * for the device. on_device_close in any case. */
int on_device_open(struct on_device *o, size_t number, const char *scene, const char *precision,
                   int threads, bool fuse, struct error *e);
void on_device_close(struct on_device *o);
/* All columns go to the device, ghosts and mirrors as well, and the lists as they are. */
int on_device_put(struct on_device *o, struct error *e);
/* A stage of the evaluation there, until nobody asks for another sweep; all of them. */
int on_device_stage(struct on_device *o, size_t k, struct error *e);
int on_device_run(struct on_device *o, struct error *e);
struct kernel_now on_device_now(const struct on_device *o);
/* A column's component of n real particles, as the device has it. */
int on_device_get(struct on_device *o, size_t array, int column, uint32_t c, double *out,
                  struct error *e);
/* tests/unit/on_device.h -- an OpenCL device to test on, and clouds of points on it. */
#ifndef TESTS_ON_DEVICE_H
#define TESTS_ON_DEVICE_H
#include "clouds.h"
#include "opencl/devices.h"
#include "opencl/lists.h"
/* The first one with double precision; NULL if there is none. */
static inline struct device *any_device(void)
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
static inline struct there cloud_there(struct device *d, const struct cloud *c, const int64_t *id,
                                       size_t first)
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
