/* sph/host.h -- the host's function table: all that a plugin may call. */
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
    uint32_t size, abi_major, abi_minor, reserved;
    void *context; /* the host's own */
    const char *name, *version;
    /* Registers a descriptor of `kind` (SPH_KIND_...). The host keeps the pointer, not a copy.
     * SPH_E_INVALID with a message naming item and field if the descriptor contradicts itself.
     * [main], in init only. */
    sph_status (*register_item)(const sph_host *, const char *kind, const void *descriptor);
    /* An extension by id, host-owned, for as long as the plugin is loaded; NULL: not here. Each is a
     * struct of functions that begins with its size: SPH_EXT_... in tables.h, reductions.h,
     * time_step.h, population.h, state.h. [any] */
    const void *(*extension)(const sph_host *, const char *id);
    /* level: SPH_LOG_...; one line without newline. A plugin never prints itself. [any] */
    void (*log)(const sph_host *, int32_t level, const char *message);
    /* Keeps the message (copied) and returns status: `return host->fail(host, code, "...")`. [any] */
    sph_status (*fail)(const sph_host *, sph_status status, const char *message);
    /* Value of a declared parameter; of a choice: its index. Undeclared names give NaN. [main] */
    double (*param)(const sph_config *, const char *name);
};

/* Life of one configured use of an item; both may be NULL, then state is NULL. [main] */
typedef struct sph_life {
    uint32_t size, reserved;
    sph_status (*create)(const sph_host *, const sph_config *, uint32_t dim, void **state);
    void (*destroy)(const sph_host *, void *state);
} sph_life;

SPH_END_DECLS
#endif
