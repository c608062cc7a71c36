/* body.c -- a uniform acceleration, such as gravity near the ground. */
#include "forces.h"
#include <math.h>

enum { X, V, A, PHI };
enum { G };

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

static sph_status run(const sph_batch *b)
{
    double *phi = b->dst[PHI].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        phi[i] = 0.0;
    for (uint32_t c = 0; c < b->dim; c++) {
        const double g = b->param[G + c];
        const double *x = (const double *)b->dst[X].data + (size_t)c * b->dst[X].plane;
        double *a = (double *)b->dst[A].data + (size_t)c * b->dst[A].plane;
        for (uint64_t i = b->first; i < b->first + b->count; i++) {
            a[i] += g;
            phi[i] -= g * x[i];
        }
    }
    return SPH_OK;
}

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
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
};
