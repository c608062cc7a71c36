/* opencl/device_cache.h -- what took long to make for a device, kept in files from one run to the next: built
 * programs, measured rates. Knows nothing of OpenCL. No failure here is an error: what is not there, or
 * not as it was written, is made again. */
#ifndef OPENCL_DEVICE_CACHE_H
#define OPENCL_DEVICE_CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All that a thing was made from. Begins with zeros. */
struct cache_key {
    uint64_t half[2];
};

/* Adds n bytes; where they end counts. */
void cache_key_add(struct cache_key *k, const void *data, size_t n);
void cache_key_text(struct cache_key *k, const char *text);

/* What was put under that key, in fresh memory; NULL: nothing. */
void *cache_get(const struct cache_key *k, size_t *bytes);
/* Whoever is about to make what was not there: while another process makes the same this waits, so that it is there
 * then; not for ever, and not for one that has died. Returns what cache_end wants; *waited: it had to. */
int cache_begin(const struct cache_key *k, bool *waited);
void cache_end(const struct cache_key *k, int turn);
/* Puts it there, all or nothing, and removes what was not asked for the longest where all is too much. */
void cache_put(const struct cache_key *k, const void *data, size_t bytes);

#endif
