/* registry/preflight.h -- looks at a plugin's file before it is mapped and any of its code runs. */
#ifndef REGISTRY_PREFLIGHT_H
#define REGISTRY_PREFLIGHT_H

#include "base/error.h"
#include <sys/stat.h>

/* The one function that a plugin must export. */
#define PREFLIGHT_ENTRY "sph_plugin_entry"

/* Opens a path without symbolic links (registry/trust.h), and checks by the descriptor: whose it
 * is, who may write to it, and whether it is a whole shared object for this machine, all of
 * whose tables that the dynamic linker follows lead somewhere sensible, and which exports a
 * plugin's entry. Returns the descriptor, for the caller to close, and what fstat said of it; or
 * -1 with a sentence that does not name the file.
 *
 * What it cannot see is a changed bit in code or data, or an address changed into another one
 * that could as well be meant: a file carries no proof of its own content. */
int preflight_open(const char *path, struct stat *st, struct error *e);

/* The same, closed again. */
int preflight_file(const char *path, struct error *e);

#endif
