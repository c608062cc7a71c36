/* gsph.h -- the functions of the plugin "gsph", one file each. */
#ifndef GSPH_H
#define GSPH_H

#include <sph/plugin.h>

extern const sph_function gsph_density;   /* density.c */
extern const sph_function gsph_gradients; /* gradients.c */
extern const sph_function gsph_rates;     /* rates.c */

#define SIZE(type) (uint32_t)sizeof(type)

#endif
