/* registry/copy.h -- copies descriptors across the border of the ABI, grown to today's size: the
 * host then reads its own structs, whatever the age of the plugin. Checks sizes and lists, not
 * meaning. */
#ifndef REGISTRY_COPY_H
#define REGISTRY_COPY_H

#include "registry/registry.h"

/* More than any struct or list of the ABI will ever need: beyond it is no size but an accident. */
#define COPY_LARGEST 65536u
#define COPY_LONGEST 1024u

/* A struct that begins with its size: copies min(sizes) bytes to out, zeroes the rest and sets the
 * size to `host`. Fails if it is smaller than `first` or absurdly large; `what` names it. */
int copy_struct(void *out, size_t host, const void *in, size_t first, const char *what,
                struct error *e);

/* A deep copy of a descriptor of a kind, or NULL. `memory` is given what it lies in, and is to be
 * freed with copy_free, also after a failure. */
const void *copy_descriptor(enum kind kind, const void *descriptor, void **memory, struct error *e);
void copy_free(void *memory);

/* The same of what an extension declares of an item, in memory that its entry has already. */
const sph_population *copy_population(void **memory, const sph_population *in, struct error *e);
const sph_fusion *copy_fusion(void **memory, const sph_fusion *in, struct error *e);
const sph_state *copy_state(void **memory, const sph_state *in, struct error *e);

/* The item of a copy. */
const sph_item *copy_item_of(enum kind kind, const void *copy);

#endif
