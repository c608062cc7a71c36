/* domain/same_plugins.h -- every rank proves that it loaded the same plugins: the same bytes,
 * compared one by one with those of the first rank. */
#ifndef DOMAIN_SAME_PLUGINS_H
#define DOMAIN_SAME_PLUGINS_H

#include "registry/registry.h"

/* All ranks call it, after all plugins are loaded. Where a plugin of one is missing on another
 * or differs, every rank fails (EXIT_REFUSED), and the lowest of those that differ from the
 * first has the sentence, which names the rank, both files and what differs; the others' text is
 * empty. Does nothing on one rank. [main] */
int same_plugins(const struct registry *r, struct error *e);

#endif
