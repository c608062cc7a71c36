/* sweep_gsph.h -- the sweeps of the plugin gsph: a table of their own. */
#ifndef SWEEP_GSPH_H
#define SWEEP_GSPH_H

#include "machine.h"
#include "sweep_engine.h"

enum { ROUNDS_MOST = 99 };

/* Medians of n rounds over the fluid's particles, with pressures of a gas. The plugins are loaded. */
void sweep_gsph(struct registry *r, const struct pair_case *fluid, const struct machine *m, int n);

#endif
