/* opencl/lists.h -- neighbour lists on a device, as neighbours.h has them on the host, in a plainer form; and the
 * order of particles. */
#ifndef OPENCL_LISTS_H
#define OPENCL_LISTS_H

#include "neighbours/neighbours.h"
#include "opencl/device.h"

/* Points on a device: coordinate k of point i is element x_slot * plane + k * plane + i of `wide`, its smoothing
 * length element h_slot * plane + i (doubles). From `first` on, n of them. */
struct device_cloud {
    int dim;
    const struct device_buffer *wide;
    size_t plane, first, n;
    uint32_t x_slot, h_slot;
    double scale; /* reach = scale * h */
};

/* The sources of group g (SPH_LANES destinations) are step[begin[g]] ... step[begin[g + 1] - 1], whole indices.
 * The first `common[g]` are for all lanes; the others, an even number, take turns: for the lower half of the
 * lanes, for the upper (sph_span in batch.h). */
struct device_list {
    struct device_buffer begin;  /* uint[n_group + 1] */
    struct device_buffer common; /* uint[n_group] */
    struct device_buffer step;   /* uint[n_entry] */
    size_t n_group;
    uint64_t n_entry,
        n_pair;       /* n_pair: true pairs within reach, without skin and self pairs, if counted */
    uint64_t crowded; /* destinations with more neighbours than `most` */
};

struct device_search; /* programs and room for both of the below; one a device */

int device_search_open(struct device_search **out, struct device *d, int dim,
                       const struct neighbour_manager *manager, struct error *e);
void device_search_close(struct device_search *s);

/* As group_list_make: every source within (1 + skin) of reach_i, or if symmetric of the larger of both, of any
 * lane. counted: n_pair is set. most: as in struct overflow, 0: nobody asks. A position or smoothing length that
 * is no number: fails with EXIT_RUN; the caller finds the particle. */
int device_list_make(struct device_search *s, struct device_list *list,
                     const struct device_cloud *dst, const struct device_cloud *src, bool symmetric,
                     double skin, bool counted, uint64_t most, struct error *e);
void device_list_release(struct device *d, struct device_list *list);

/* cell_order: the same order, index for index. id: int64 elements id_at and on of `wide`. order: uint[n],
 * reserved here. cell: as cell_best, found here for the cloud. */
int device_order(struct device_search *s, const struct device_cloud *points, uint32_t id_slot,
                 struct device_buffer *order, struct error *e);

#endif
