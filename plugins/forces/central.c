/* central.c -- a force toward a centre that falls with a power of the distance: gravity of a point or of a
 * softened one, a spring. */
#include "forces.h"
#include <math.h>

enum { X, V, A, PHI, DT };
enum { MU, N, EPS, CENTRE };

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

/* phi' = mu r s^-(n+1), s^2 = r^2 + eps^2. */
static double potential(double mu, double n, double s2)
{
    return n > 1.0 || n < 1.0 ? mu / (1.0 - n) * pow(s2, 0.5 * (1.0 - n)) : 0.5 * mu * log(s2);
}

static sph_status run(const sph_batch *b)
{
    const double mu = b->param[MU], n = b->param[N], eps = b->param[EPS];
    double *phi = b->dst[PHI].data, *dt = b->dst[DT].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        double d[3] = {0.0, 0.0, 0.0}, s2 = eps * eps;
        for (uint32_t c = 0; c < b->dim; c++) {
            d[c] = ((const double *)b->dst[X].data)[c * b->dst[X].plane + i] - b->param[CENTRE + c];
            s2 += d[c] * d[c];
        }
        const double strength = mu * pow(s2, -0.5 * (n + 1.0)); /* the frequency's square */
        for (uint32_t c = 0; c < b->dim; c++)
            ((double *)b->dst[A].data)[c * b->dst[A].plane + i] -= strength * d[c];
        phi[i] = potential(mu, n, s2);
        dt[i] = 1.0 / sqrt(fabs(strength));
    }
    return SPH_OK;
}

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
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
};
