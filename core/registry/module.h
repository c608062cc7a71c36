/* registry/module.h -- one shared object, mapped and unmapped. */
#ifndef REGISTRY_MODULE_H
#define REGISTRY_MODULE_H

#include "base/error.h"
#include <sph/plugin.h>

struct module;

/* Looks at a file (registry/preflight.h) and loads it: local scope, all symbols bound. `path`
 * has no symbolic links (registry/trust.h). Fails (EXIT_REFUSED) with a sentence that names it;
 * nothing stays mapped, and the floating point mode is as it was. [main] */
struct module *module_open(const char *path, struct error *e);
/* For registry_add. */
void module_close(void *module);

sph_plugin_entry_fn module_entry(const struct module *m);
/* The descriptor through which the file was looked at: its bytes are those that were loaded. */
int module_descriptor(const struct module *m);

#endif
