/* sph/abi.h -- the ground every other header of the plugin ABI stands on: version, status, lists.
 *
 * Rules of the ABI
 * - Structs grow at the end only and begin with their size (elements of an sph_list have its
 *   stride); nothing is reordered, removed or re-typed within a major version. A reader takes
 *   min(its size, the struct's size) and gives a missing field its documented default: 0 or NULL
 *   where nothing else is said. Structs that stand by value in others (sph_list, sph_column,
 *   sph_kernel_piece) never grow. `reserved` is 0.
 * - No enum, bool, long, bit-field or FILE pointer in a struct. Strings are UTF-8 and live, like
 *   every descriptor, until the plugin is closed.
 * - Who allocates frees. What the host hands to a call is the host's and, where nothing else is
 *   said, gone when the call returns. A plugin links to nothing of the host: all it may call is in
 *   sph_host.
 * - Errors are a status and a sentence: `return host->fail(host, SPH_E_..., "...")`. A plugin never
 *   prints, exits, longjmps or lets an exception out.
 * - Numbers are in the units that the plugin declares for its properties and parameters; the host
 *   converts nothing.
 * - While major is 0 the host loads only plugins of its own minor; from 1.0 on, those that ask for
 *   its own or an older one (SPH_ABI_WANTED_MINOR in plugin.h).
 *
 * Thread tags, used in every docstring
 *   [main]    the thread that called the plugin's init, no other call of this plugin runs
 *   [worker]  any thread, many at once, each on its own range of destinations
 *   [any]     re-entrant, from any thread
 */
#ifndef SPH_ABI_H
#define SPH_ABI_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define SPH_BEGIN_DECLS extern "C" {
#define SPH_END_DECLS }
#else
#define SPH_BEGIN_DECLS
#define SPH_END_DECLS
#endif

SPH_BEGIN_DECLS

#define SPH_ABI_MAJOR 0u
#define SPH_ABI_MINOR 5u

#if defined(__GNUC__)
#define SPH_EXPORT __attribute__((visibility("default")))
#else
#define SPH_EXPORT
#endif

typedef int32_t sph_status; /* 0 is success, negative an error */
#define SPH_OK 0
#define SPH_E_INVALID (-1) /* an argument or a descriptor contradicts its documentation */
#define SPH_E_UNKNOWN (-2) /* kind, extension, property or parameter unknown to this host */
#define SPH_E_ABI (-3)     /* version or size does not fit */
#define SPH_E_NOMEM (-4)   /* out of memory */
#define SPH_E_NUMERIC (-5) /* NaN, negative density, no convergence */

/* Does the host's struct at p, which begins with its size, hold this member? To be asked before one
 * is read that is younger than the minor version that the plugin asks for. */
#define SPH_HAS(p, member)                                                                         \
    ((size_t)((const char *)(&(p)->member + 1) - (const char *)(p)) <= (size_t)(p)->size)

/* A typed list whose element type may grow: element i is at (char *)data + i * stride. Its elements
 * live as long as the descriptor that it is part of. */
typedef struct sph_list {
    const void *data; /* NULL if count is 0 */
    uint32_t count;
    uint32_t stride; /* bytes from one element to the next: the plugin's sizeof an element */
} sph_list;

/* A list over a static array: SPH_LIST(props) with `static const sph_prop props[] = {...}`. */
#define SPH_LIST(array)                                                                            \
    {                                                                                              \
        (array), (uint32_t)(sizeof(array) / sizeof((array)[0])), (uint32_t)sizeof((array)[0])      \
    }
#define SPH_NO_LIST                                                                                \
    {                                                                                              \
        NULL, 0u, 0u                                                                               \
    }

SPH_END_DECLS
#endif
