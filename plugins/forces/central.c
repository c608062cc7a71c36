/* central.c -- a force toward a centre that falls with a power of the distance: gravity of a point or of a
 * softened one, a spring. */
#include "forces.h"
#include <math.h>

enum { X, V, A, PHI, DT };
enum { MU, N, EPS, CX, CY, CZ };

static const sph_param params[] = {
    SPH_PARAM("mu", "m^(n+1)/s^2", "strength; less than 0 pushes away", NAN, -1e300, 1e300),
    SPH_PARAM("n", "", "power of the distance by which it falls: 2 gravity, -1 a spring", 2.0,
              -10.0, 10.0),
    SPH_PARAM("eps", "m", "softening length", 0.0, 0.0, 1e300),
    SPH_PARAM("cx", "m", "centre, x", 0.0, -1e300, 1e300),
    SPH_PARAM("cy", "m", "y", 0.0, -1e300, 1e300),
    SPH_PARAM("cz", "m", "z", 0.0, -1e300, 1e300),
};

static const sph_prop props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    FORCES_V,
    FORCES_A,
    SPH_PROP("phi_central", "J/kg", "potential of central-force", SPH_SCALAR, SPH_DST_WRITE, 0.0),
    SPH_PROP("dt_central", "s", "time step that central-force allows, before cfl", SPH_SCALAR,
             SPH_DST_WRITE, 0.0),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P) P(vector, x, X)
#define SPH_POINT_INOUT(P) P(vector, a, A)
#define SPH_POINT_OUT(P) P(scalar, phi, PHI) P(scalar, dt, DT)
#define SPH_POINT_PARAM(P) P(mu, MU) P(n, N) P(eps, EPS) P(cx, CX) P(cy, CY) P(cz, CZ)
#define SPH_POINT_BODY "central.body.h"
#define SPH_POINT_DEVICE central_device
#include <sph/point-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
};

static const sph_reduction reductions[] = {
    SPH_REDUCTION("dt", "dt_central", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),
    SPH_REDUCTION("potential", "phi_central", SPH_REDUCE_SUM, SPH_USE_POTENTIAL),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "central-force",
    .doc = "acceleration -mu (x - c) / (r^2 + eps^2)^((n + 1) / 2) toward a centre",
    .source = "Landau & Lifshitz, Mechanics (1976), section 14, 15; softening: Plummer 1911, "
              "doi:10.1093/mnras/71.5.460",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function central_force = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .device_run = &central_device,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
};
