/* wcsph.h -- the functions of the plugin "wcsph", one file each, and what they share. */
#ifndef WCSPH_H
#define WCSPH_H

#include <sph/plugin.h>

extern const sph_function wcsph_pressure;   /* pressure.c */
extern const sph_function wcsph_continuity; /* continuity.c */
extern const sph_function wcsph_momentum;   /* momentum.c */
extern const sph_function wcsph_rates;      /* rates.c: both in one sweep */

/* What finish.body.h reads, by its function's own numbers of columns and parameters. */
#define WCSPH_FINISH_IN(P_) P_(scalar, rho, RHO) P_(scalar, cs, CS) P_(scalar, drho, DRHO)
#define WCSPH_FINISH_PARAM(P_) P_(alpha, ALPHA) P_(beta, BETA) P_(gx, GX) P_(gy, GY) P_(gz, GZ)

#define WCSPH_VISCOSITY                                                                            \
    SPH_PARAM("alpha", "", "artificial viscosity, linear in the closing speed", 0.1, 0.0, 10.0),   \
        SPH_PARAM("beta", "", "artificial viscosity, quadratic", 0.0, 0.0, 10.0)
#define WCSPH_GRAVITY                                                                              \
    SPH_PARAM("gx", "m/s^2", "acceleration of gravity along x", 0.0, -1e300, 1e300),               \
        SPH_PARAM("gy", "m/s^2", "along y", 0.0, -1e300, 1e300),                                   \
        SPH_PARAM("gz", "m/s^2", "along z", 0.0, -1e300, 1e300)

#define WCSPH_READ (SPH_DST_READ | SPH_SRC_READ)
#define WCSPH_M SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN)
#define WCSPH_V SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, WCSPH_READ | SPH_DST_SWEEP, 0.0)
#define WCSPH_RHO SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, WCSPH_READ, NAN)
#define WCSPH_P_RHO2(access)                                                                       \
    SPH_PROP("p_rho2", "J m^d/kg^2", "pressure over the square of the density", SPH_SCALAR,        \
             (access), 0.0)
#define WCSPH_CS SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, WCSPH_READ, NAN)
#define WCSPH_DRHO SPH_PROP("drho", "kg/m^d/s", "rate of the density", SPH_SCALAR, SPH_DST_SUM, 0.0)
#define WCSPH_A SPH_PROP("a", "m/s^2", "acceleration", SPH_VECTOR, SPH_DST_SUM | SPH_DST_READ, 0.0)
#define WCSPH_DT                                                                                   \
    SPH_PROP("dt", "s", "time step that the particle allows, before cfl", SPH_SCALAR,              \
             SPH_DST_WRITE, 0.0)

#define WCSPH_REDUCTIONS                                                                           \
    SPH_REDUCTION("dt", "dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),                                  \
        SPH_REDUCTION("rho_max", "rho", SPH_REDUCE_MAX, SPH_USE_NONE)

#define SIZE(type) (uint32_t)sizeof(type)

#endif
