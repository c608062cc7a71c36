/* body.c -- a uniform acceleration, such as gravity near the ground. */
#include "forces.h"
#include <math.h>

enum { X, V, A, PHI };
enum { GX, GY, GZ };

static const sph_param params[] = {
    SPH_PARAM("gx", "m/s^2", "acceleration along x", 0.0, -1e300, 1e300),
    SPH_PARAM("gy", "m/s^2", "along y", 0.0, -1e300, 1e300),
    SPH_PARAM("gz", "m/s^2", "along z", 0.0, -1e300, 1e300),
};

static const sph_prop props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    FORCES_V,
    FORCES_A,
    SPH_PROP("phi_body", "J/kg", "potential of body-force, 0 at the origin", SPH_SCALAR,
             SPH_DST_WRITE, 0.0),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P) P(vector, x, X)
#define SPH_POINT_INOUT(P) P(vector, a, A)
#define SPH_POINT_OUT(P) P(scalar, phi, PHI)
#define SPH_POINT_PARAM(P) P(gx, GX) P(gy, GY) P(gz, GZ)
#define SPH_POINT_BODY "uniform.body.h"
#define SPH_POINT_DEVICE body_device
#include <sph/point-loop.h>

static const sph_rate rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
};

static const sph_reduction reductions[] = {
    SPH_REDUCTION("potential", "phi_body", SPH_REDUCE_SUM, SPH_USE_POTENTIAL),
};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "body-force",
    .doc = "uniform acceleration g, with the potential -g.x",
    .source = "any textbook, as Landau & Lifshitz, Mechanics (1976), section 5",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function body_force = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .device_run = &body_device,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
};
