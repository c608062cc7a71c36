/* piston.h -- what the piston's functions share: its motion. */
#ifndef PISTON_H
#define PISTON_H

#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* The motion along x at one time: way [m] since time 0, speed [m/s], acceleration [m/s^2]. The state of a use
 * begins with that at the time of its pass, which bodies read. */
struct motion {
    double way, speed, acceleration;
};
enum { NOW_WAY, NOW_SPEED, NOW_ACCELERATION };

/* Parameters "speed" and "path", which every function of the plugin that needs them declares first. */
enum { SPEED, PATH, N_MOTION_PARAMS };
#define PISTON_PARAMS                                                                              \
    SPH_PARAM("speed", "m/s", "speed along x, where there is no path", 0, -1e300, 1e300),          \
        SPH_PARAM_OF_TABLE("path", "columns t [s] and v [m/s]: the speed, straight between rows",  \
                           0)

/* motion.c: the state, and what sets the motion in it, once a pass. */
extern const sph_life piston_life;
sph_status piston_prepare(const sph_batch *);

extern const sph_function piston_start; /* move.c */
extern const sph_function piston_still; /* move.c */
extern const sph_function piston_place; /* move.c */
extern const sph_function piston_state; /* state.c */

#endif
