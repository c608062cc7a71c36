/* plan/device_memory.h -- what a run will hold on its device, estimated before there is one. */
#ifndef PLAN_DEVICE_MEMORY_H
#define PLAN_DEVICE_MEMORY_H

#include "plan/plan.h"

/* [bytes] */
struct device_memory {
    double columns; /* with those of ghosts, and room for some more */
    double lists;
    double
        search; /* what lists and the order of particles are made with, and the places they were made at */
    double total;
    double largest; /* buffer */
    const char *largest_of;
};

/* Ghosts of an array, with some to spare. */
size_t plan_ghosts(const struct plan *plan, size_t array);
/* Of particles that are evenly spread, of a plan whose particles are made or not yet. */
struct device_memory plan_device_memory(const struct plan *plan);
/* "device memory: ...", two lines. */
void plan_print_device_memory(const struct plan *plan, FILE *out);

#endif
