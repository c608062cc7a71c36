/* on_device.h -- for tests and measurements: a scene's passes natively and on a device, on the same
 * particles. No cmocka in here. */
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
/* A scene (JSON with ' in place of ") made, filled, and evaluated once natively; the stages of an
 * evaluation built for the device: with vectors, or a work item a destination. on_device_close in
 * any case. */
struct on_device_as {
    const char *scene, *precision;
    int threads;
    bool fuse, vectors;
    const sph_plugin *(*entry)(void); /* of a plugin besides; or NULL */
};
int on_device_open(struct on_device *o, size_t number, const struct on_device_as *as,
                   struct error *e);
void on_device_close(struct on_device *o);
/* All columns go to the device, ghosts and mirrors as well, and the lists as they are. */
int on_device_put(struct on_device *o, struct error *e);
/* All columns come back to the host: real particles; ghosts and mirrors are old. */
int on_device_fetch(struct on_device *o, struct error *e);
/* A stage of the evaluation there, until nobody asks for another sweep; all of them, by way of the
 * host, which refreshes ghosts and mirrors in between. */
int on_device_stage(struct on_device *o, size_t k, struct error *e);
int on_device_run(struct on_device *o, struct error *e);
struct kernel_now on_device_now(const struct on_device *o);

#endif
