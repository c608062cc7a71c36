/* registry/preflight.h -- looks at a plugin's file before it is mapped and any of its code runs. */
#ifndef REGISTRY_PREFLIGHT_H
#define REGISTRY_PREFLIGHT_H

#include "base/error.h"

/* Who may write to the file and its folder, and whether it is a whole shared object for this
 * machine. Fails (EXIT_REFUSED) with a sentence that does not name the file. */
int preflight_file(const char *path, struct error *e);

#endif
