/* fluid.h -- the particles that sweeps are measured on: a disturbed lattice in the unit box with h = 1.3
 * spacings, random velocities and pressures, in cell order; 75.6 neighbours in 3D, 19.9 in 2D. */
#ifndef FLUID_H
#define FLUID_H

#include "call_per_pair.h"

struct fluid {
    struct pair_case c;
    double *columns; /* x y z, vx vy vz, m rho p h: n each */
    size_t *first;
    uint32_t *neighbour;
};

/* side^dim particles, and the list of each one's neighbours. */
void fluid_fill(struct fluid *f, int dim, int side);
void fluid_free(struct fluid *f);

/* Room for what a sweep finds. */
struct pair_rates fluid_rates(uint32_t n);
void fluid_rates_free(struct pair_rates *r);

/* From [0, 1), the same in each run. */
double fluid_random(void);

#endif
