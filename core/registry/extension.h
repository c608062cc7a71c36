/* registry/extension.h -- the host's extensions by id, and what those that belong to a run ask of it. */
#ifndef REGISTRY_EXTENSION_H
#define REGISTRY_EXTENSION_H

#include "registry/registry.h"

struct extension {
    const char *id, *doc;
    const void *table; /* begins with its size */
};
extern const struct extension extension[];
extern const size_t n_extension;

/* NULL: there is none of that id. */
const void *extension_find(const char *id);

/* What a batch's `run` points to; filled by the run, which outlives the batch. Both may be called from
 * many threads at once. */
struct sph_run {
    void *context;
    double (*reduction)(const struct sph_run *, const char *function, const char *name);
    void (*propose)(const struct sph_run *, double dt);
};

#endif
