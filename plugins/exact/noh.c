/* noh.c -- Noh's implosion: cold gas falls towards the origin, and a shock runs out of it.
 * W. F. Noh, J. Comput. Phys. 72 (1987) 78, doi:10.1016/0021-9991(87)90074-X, section 2. In one
 * dimension the geometry is a wall at x = 0, seen from both sides. */
#include "exact.h"

#include <math.h>

enum { PARAM_GAMMA, PARAM_RHO0, PARAM_V0 };
static const sph_param params[] = {
    SPH_PARAM("gamma", "", "ratio of the specific heats", 5. / 3, 1.000001, 100),
    SPH_PARAM("rho0", "kg/m^d", "density at the start", 1, 1e-300, 1e300),
    SPH_PARAM("v0", "m/s", "speed of fall", 1, 1e-300, 1e300),
};

enum { PROP_X, PROP_RHO, PROP_P, PROP_V, PROP_U };
static const sph_prop props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_WRITE, 0),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0),
};

struct state {
    double rho, p, u;
    double v; /* radial */
};

/* At radius r and time t. Behind the shock (speed (gamma - 1) v0 / 2) the gas rests and holds the
 * energy of its fall; ahead of it, it falls freely and piles up with its geometry. */
static struct state noh_at(const sph_batch *b, double r, double t)
{
    const double gamma = b->param[PARAM_GAMMA];
    const double rho0 = b->param[PARAM_RHO0];
    const double v0 = b->param[PARAM_V0];
    struct state s = {rho0, 0, 0, -v0};

    if (r < (gamma - 1) / 2 * v0 * t) {
        s.rho = rho0 * pow((gamma + 1) / (gamma - 1), b->dim);
        s.u = v0 * v0 / 2;
        s.p = (gamma - 1) * s.rho * s.u;
        s.v = 0;
    } else if (r > 0) {
        s.rho = rho0 * pow(1 + v0 * t / r, (double)b->dim - 1);
    }
    return s;
}

static sph_status run(const sph_batch *b)
{
    double *x[3] = {NULL}, *v[3] = {NULL};

    if (b->real != SPH_F64)
        return b->host->fail(b->host, SPH_E_UNKNOWN,
                             "noh: single precision is not implemented yet");

    double *rho = exact_column(b, PROP_RHO, 0);
    double *p = exact_column(b, PROP_P, 0);
    double *u = exact_column(b, PROP_U, 0);
    for (uint32_t c = 0; c < b->dim; c++) {
        x[c] = exact_column(b, PROP_X, c);
        v[c] = exact_column(b, PROP_V, c);
    }

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        double r2 = 0;
        for (uint32_t c = 0; c < b->dim; c++)
            r2 += x[c][i] * x[c][i];
        const double r = sqrt(r2);
        const struct state s = noh_at(b, r, b->time);
        if (rho)
            rho[i] = s.rho;
        if (p)
            p[i] = s.p;
        if (u)
            u[i] = s.u;
        for (uint32_t c = 0; c < b->dim && v[c]; c++)
            v[c][i] = r > 0 ? s.v * x[c][i] / r : 0;
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "noh",
    .doc = "Noh's implosion of cold gas onto a wall (1D), an axis (2D) or a point (3D)",
    .source = "Noh 1987, doi:10.1016/0021-9991(87)90074-X, section 2",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact noh = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
