/* opencl/sort.h -- running sums and sorts on a device: what neighbour lists and the order of
 * particles are made with. Sizes are below 2^32. */
#ifndef OPENCL_SORT_H
#define OPENCL_SORT_H

#include "opencl/device.h"

struct device_sort;

/* cpu: for a processor. */
int device_sort_open(struct device_sort **out, struct device *d, bool cpu, struct error *e);
void device_sort_close(struct device_sort *s); /* NULL: nothing */

/* out[out_at + i] = total[slot] + in[in_at] + ... + in[in_at + i - 1] for i <= n (n + 1 of them),
 * of uints, in the lowest 32 bits. total: of ulongs; total[slot + 1] becomes the last sum with all
 * 64. */
int device_scan(struct device_sort *s, const struct device_buffer *in, size_t in_at, size_t n,
                const struct device_buffer *out, size_t out_at, const struct device_buffer *total,
                size_t slot, struct error *e);
/* Sorts n keys (of key_bytes: 4 or 8) by their lowest `bits`, those above being zero, and the uints
 * that go with them. Equal keys keep their order. The two buffers may be others afterwards; they
 * begin with n elements at least. */
int device_sort_pairs(struct device_sort *s, struct device_buffer *key, struct device_buffer *value,
                      size_t n, size_t key_bytes, unsigned bits, struct error *e);

#endif
