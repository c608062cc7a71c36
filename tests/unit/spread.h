/* spread.h -- a function with all that a pass may have, for the tests of passes on a device. */
#ifndef TESTS_UNIT_SPREAD_H
#define TESTS_UNIT_SPREAD_H

#include <sph/plugin.h>

/* Registers "spread": its `before` makes of a guess what its sweep, over destinations that may be its sources,
 * sums with an own term, takes the least and the most of; its `after` writes what its sweep reads of sources, in
 * phases therefore, and fails of the particle whose mass is more than the parameter "heaviest". A state that
 * `prepare` changes, a symmetric tensor, a vector. */
const sph_plugin *spread_entry(void);

#endif
