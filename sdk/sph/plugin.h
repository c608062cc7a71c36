/* sph/plugin.h -- the plugin's descriptor and its one exported function. Includes the whole ABI. */
#ifndef SPH_PLUGIN_H
#define SPH_PLUGIN_H

#include <sph/batch.h>
#include <sph/boundary.h>
#include <sph/device.h>
#include <sph/eos.h>
#include <sph/exact.h>
#include <sph/function.h>
#include <sph/fusion.h>
#include <sph/host.h>
#include <sph/kernel.h>
#include <sph/population.h>
#include <sph/reductions.h>
#include <sph/scheme.h>
#include <sph/state.h>
#include <sph/tables.h>
#include <sph/time_step.h>

SPH_BEGIN_DECLS

#define SPH_PLUGIN_MAGIC 0x4c504853u /* "SHPL" */

/* The plugin's static descriptor. */
typedef struct sph_plugin {
    uint32_t size, magic;          /* these four are checked before any other code of the plugin */
    uint32_t abi_major, abi_minor; /* what it asks of its host */
    const char *name;              /* [a-z0-9-]; unique among the plugins of a run */
    const char *version;           /* "1.0"; shown, and asked for by `sph info --atleast` */
    const char *license;           /* SPDX; may be NULL */
    const char *doc;               /* one line; may be NULL */
    /* Registers, nothing else: no files, no devices, no MPI, no output. Anything but SPH_OK refuses
     * the plugin with the sentence given to host->fail; fini is not called then. [main] */
    sph_status (*init)(const sph_host *);
    /* Before the plugin is closed, after all states are destroyed; or NULL. [main] */
    void (*fini)(const sph_host *);
} sph_plugin;

/* The only symbol that a plugin exports. A function, so that any loader finds it. Returns the same
 * static descriptor however often it is called, and does nothing else. [main] */
SPH_EXPORT const sph_plugin *sph_plugin_entry(void);
typedef const sph_plugin *(*sph_plugin_entry_fn)(void);

/* The minor version that a plugin asks of its host. By default the oldest of this major: a plugin
 * that is built again with newer headers still loads in older hosts, which see the members they
 * know and no others. One that cannot do without a newer member defines this to the minor that
 * brought it, before the include, and is refused by older hosts; one that can asks SPH_HAS (abi.h).
 * While major is 0 there is no choice. */
#ifndef SPH_ABI_WANTED_MINOR
#if SPH_ABI_MAJOR == 0
#define SPH_ABI_WANTED_MINOR SPH_ABI_MINOR
#else
#define SPH_ABI_WANTED_MINOR 0u
#endif
#endif

#define SPH_PLUGIN(name, version, license, doc, init, fini)                                        \
    SPH_EXPORT const sph_plugin *sph_plugin_entry(void)                                            \
    {                                                                                              \
        static const sph_plugin plugin = {(uint32_t)sizeof(sph_plugin),                            \
                                          SPH_PLUGIN_MAGIC,                                        \
                                          SPH_ABI_MAJOR,                                           \
                                          SPH_ABI_WANTED_MINOR,                                    \
                                          (name),                                                  \
                                          (version),                                               \
                                          (license),                                               \
                                          (doc),                                                   \
                                          (init),                                                  \
                                          (fini)};                                                 \
        return &plugin;                                                                            \
    }

SPH_END_DECLS
#endif
