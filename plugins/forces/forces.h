/* forces.h -- the functions of the plugin "forces", one file each, and what they share. */
#ifndef FORCES_H
#define FORCES_H

#include <sph/plugin.h>

extern const sph_function body_force;    /* body.c */
extern const sph_function central_force; /* central.c */

/* A sum, and a rate: what several forces and a scheme give adds up. */
#define FORCES_A SPH_PROP("a", "m/s^2", "acceleration", SPH_VECTOR, SPH_DST_SUM, 0.0)
#define FORCES_V SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ, 0.0)

#define SIZE(type) (uint32_t)sizeof(type)

#endif
