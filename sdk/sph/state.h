/* sph/state.h -- extension: the plugin's own state in a checkpoint. What lies in properties of
 * particles is saved by the host; this is for what an item keeps beside them (sph_life), such as a
 * random number's seed or the position of a driven wall. An item whose state is made anew by
 * `create` from its parameters alone needs none of it. */
#ifndef SPH_STATE_H
#define SPH_STATE_H

#include <sph/host.h>

SPH_BEGIN_DECLS

#define SPH_EXT_STATE "sph.state/0"

/* Where a state's bytes go. The host's, for the call. */
typedef struct sph_writer sph_writer;
struct sph_writer {
    uint32_t size, reserved;
    void *context; /* the host's own */
    /* Appends n bytes. SPH_E_NOMEM: pass it on. [main] */
    sph_status (*write)(const sph_writer *, const void *bytes, uint64_t n);
};

typedef struct sph_state {
    uint32_t size;
    uint32_t format; /* the plugin's own number of what it writes */
    /* Writes all of `state`, in a form without pointers. What two ranks write must be the same.
     * [main], between steps */
    sph_status (*save)(const sph_host *, const void *state, const sph_writer *out);
    /* Sets `state`, which create has just made from the same parameters, to the n bytes that `save`
     * of `format` wrote; an unknown format: SPH_E_ABI with a message. The bytes are the host's and
     * gone after the call. [main] */
    sph_status (*restore)(const sph_host *, void *state, uint32_t format, const void *bytes,
                          uint64_t n);
} sph_state;

typedef struct sph_state_ext {
    uint32_t size, reserved;
    /* Says that the registered item `name` of `kind` (SPH_KIND_...) of this plugin has such a
     * state, a static struct as a descriptor is. SPH_E_INVALID with a message if the item has no
     * life, or a function is missing. [main], in init only, after register_item */
    sph_status (*declare)(const sph_host *, const char *kind, const char *name, const sph_state *);
} sph_state_ext;

SPH_END_DECLS
#endif
