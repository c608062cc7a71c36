/* diagnostics.h -- the functions of the plugin "diagnostics", one file each. */
#ifndef DIAGNOSTICS_H
#define DIAGNOSTICS_H

#include <sph/plugin.h>

extern const sph_function nearest_function; /* nearest.c */

#endif
