/* neighbours/keys.h -- sources sorted by the key of the cell in which they are. */
#ifndef NEIGHBOURS_KEYS_H
#define NEIGHBOURS_KEYS_H

#include "neighbours/neighbours.h"

/* Keys, ascending, and whose they are; of equal keys the lower index is first. */
struct keys {
    uint64_t *key;
    uint32_t *index;
    size_t n, bytes; /* bytes: while it was sorted */
};

/* Room for n keys; fill in `key`, then sort. */
int keys_init(struct keys *k, size_t n, struct error *e);
void keys_fini(struct keys *k);
/* By the lowest `bits` of the keys; those above must be zero. */
int keys_sort(struct keys *k, int bits, int threads, struct error *e);

#endif
