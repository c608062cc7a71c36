/* barotropic.h -- the functions of the plugin "barotropic", one file each, and what they share. */
#ifndef BAROTROPIC_H
#define BAROTROPIC_H

#include <sph/plugin.h>

extern const sph_function barotropic_density;    /* density.c */
extern const sph_function barotropic_continuity; /* continuity.c */
extern const sph_function barotropic_pressure;   /* pressure.c */
extern const sph_function barotropic_energy;     /* energy.c */
extern const sph_function barotropic_momentum;   /* momentum.c */

#define BAROTROPIC_OF_PAIRS (SPH_DST_READ | SPH_SRC_READ | SPH_DST_SWEEP)
#define BAROTROPIC_M SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN)
#define BAROTROPIC_RHO(access) SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, (access), NAN)
#define BAROTROPIC_P_RHO2(access)                                                                  \
    SPH_PROP("p_rho2", "J m^d/kg^2", "pressure over the square of the density", SPH_SCALAR,        \
             (access), 0.0)

#define SIZE(type) (uint32_t)sizeof(type)

#endif
