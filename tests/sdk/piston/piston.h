/* piston.h -- what the piston's functions share: its motion, and how columns are read. */
#ifndef PISTON_H
#define PISTON_H

#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* The motion along x at one time: way [m] since time 0, speed [m/s], acceleration [m/s^2]. */
struct motion {
    double way, speed, acceleration;
};

/* Parameters "speed" and "path", which every function of the plugin that needs them declares first. */
enum { SPEED, PATH, N_MOTION_PARAMS };
#define PISTON_PARAMS                                                                              \
    SPH_PARAM("speed", "m/s", "speed along x, where there is no path", 0, -1e300, 1e300),          \
        SPH_PARAM_OF_TABLE("path", "columns t [s] and v [m/s]: the speed, straight between rows",  \
                           0)

/* The state of a use is the checked path: NULL where the speed is constant. motion.c */
extern const sph_life piston_life;
struct motion piston_motion(const sph_batch *, double time);

extern const sph_function piston_start; /* move.c */
extern const sph_function piston_still; /* move.c */
extern const sph_function piston_place; /* move.c */
extern const sph_function piston_state; /* state.c */

/* Component c of a column of doubles. */
static inline double *piston_plane(const sph_column *column, uint32_t c)
{
    return (double *)column->data + (size_t)c * column->plane;
}

#endif
