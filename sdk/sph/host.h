/* sph/host.h -- the host's function table: all that a plugin may call. The host's; it lives, and
 * stays where it is, from the plugin's init to its fini. */
#ifndef SPH_HOST_H
#define SPH_HOST_H

#include <sph/abi.h>

SPH_BEGIN_DECLS

typedef struct sph_host sph_host;
typedef struct sph_config sph_config; /* opaque: the parsed parameters of one use of an item */

#define SPH_LOG_ERROR 0
#define SPH_LOG_WARNING 1
#define SPH_LOG_INFO 2
#define SPH_LOG_DEBUG 3

struct sph_host {
    uint32_t size;
    uint32_t abi_major, abi_minor, reserved; /* the host's; SPH_HAS tells of single members */
    void *context;                           /* the host's own */
    const char *name, *version;              /* of the host, for messages */
    /* Registers a descriptor of `kind` (SPH_KIND_...): a static struct that, with all that it
     * points to, stays as it is until the plugin is closed. SPH_E_INVALID with a message naming
     * item and field if it contradicts itself: the plugin is refused then, whatever init returns.
     * SPH_E_UNKNOWN if the host has no such kind. [main], in init only */
    sph_status (*register_item)(const sph_host *, const char *kind, const void *descriptor);
    /* An extension by id, host-owned, for as long as the plugin is loaded; NULL: not here. Each is
     * a struct of functions that begins with its size: SPH_EXT_... in tables.h, reductions.h,
     * time_step.h, population.h, state.h. [any] */
    const void *(*extension)(const sph_host *, const char *id);
    /* level: SPH_LOG_...; one line of UTF-8 without newline, copied. A plugin never prints itself.
     * [any] */
    void (*log)(const sph_host *, int32_t level, const char *message);
    /* Keeps the message (one sentence, copied) and returns status: `return host->fail(host, code,
     * "...")`. Of several the last is shown. [any] */
    sph_status (*fail)(const sph_host *, sph_status status, const char *message);
    /* Value of a declared parameter, in its unit; of a choice: its index. Undeclared names give
     * NaN. [main], in sph_life.create */
    double (*param)(const sph_config *, const char *name);
};

/* Life of one configured use of an item, such as one step of a scheme or one material's equation of
 * state. Both may be NULL; state is NULL then. */
typedef struct sph_life {
    uint32_t size, reserved;
    /* Sets *state (NULL before) to what the plugin has allocated for this use, for all later
     * batches. Parameters that contradict each other: SPH_E_INVALID with a message; on failure
     * *state is NULL and nothing is left behind. The configuration is not to be kept. [main] */
    sph_status (*create)(const sph_host *, const sph_config *, uint32_t dim, void **state);
    /* Frees a state that create has made and that is not NULL, once. [main] */
    void (*destroy)(const sph_host *, void *state);
} sph_life;

SPH_END_DECLS
#endif
