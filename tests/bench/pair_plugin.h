/* pair_plugin.h -- finds the functions that are called for every pair: in a plugin, or they might be
 * compiled into the loop. */
#ifndef PAIR_PLUGIN_H
#define PAIR_PLUGIN_H

#include "call_per_pair.h"

struct pair_plugin {
    void *module;
    pair_fn pair[4]; /* [dimension]: 2 and 3 */
    pair_kernel_fn kernel[4];
};

/* From a file, or where that is NULL from the one of this build. Ends the program if there is none. */
void pair_plugin_open(struct pair_plugin *p, const char *file);
void pair_plugin_close(struct pair_plugin *p);

#endif
