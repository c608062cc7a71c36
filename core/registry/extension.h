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

/* For extensions: the item of the plugin whose init runs now; NULL, with a sentence, if it has
 * registered none of that kind and name. */
struct entry *extension_own(struct registry *r, enum kind kind, const char *name, struct error *e);
/* fusion.c: keeps which parts a function stands for; fails if it declares less than they do. */
int fusion_declare(struct registry *r, const sph_fusion *in, struct error *e);

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
