/* noh.c -- Noh's implosion: cold gas falls towards the origin, and a shock runs out of it.
 * W. F. Noh, J. Comput. Phys. 72 (1987) 78, doi:10.1016/0021-9991(87)90074-X, section 2. In one
 * dimension the geometry is a wall at x = 0, seen from both sides. */
#include "exact.h"

static const sph_item item;

enum { PARAM_GAMMA, PARAM_RHO0, PARAM_V0 };
static const sph_param params[] = {
    SPH_PARAM("gamma", "", "ratio of the specific heats", 5. / 3, 1.000001, 100),
    SPH_PARAM("rho0", "kg/m^d", "density at the start", 1, 1e-300, 1e300),
    SPH_PARAM("v0", "m/s", "speed of fall", 1, 1e-300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X, EXACT_RHO, EXACT_P, EXACT_V, EXACT_U,
};

struct implosion {
    double gamma, rho0, v0, t;
    uint32_t dim;
};

/* Behind the shock (speed (gamma - 1) v0 / 2) the gas rests and holds the energy of its fall; ahead
 * of it, it falls freely and piles up with its geometry. */
static void at(const void *of, struct exact_point *q)
{
    const struct implosion *n = of;
    const double r = hypot(hypot(q->x[0], q->x[1]), q->x[2]);

    if (r < (n->gamma - 1) / 2 * n->v0 * n->t) {
        q->rho = n->rho0 * pow((n->gamma + 1) / (n->gamma - 1), n->dim);
        q->u = n->v0 * n->v0 / 2;
        q->p = (n->gamma - 1) * q->rho * q->u;
        return;
    }
    q->rho = n->rho0;
    if (r > 0)
        q->rho *= pow(1 + n->v0 * n->t / r, (double)n->dim - 1);
    for (int c = 0; c < 3 && r > 0; c++)
        q->v[c] = -n->v0 * q->x[c] / r;
}

static sph_status run(const sph_batch *b)
{
    const struct implosion n = {b->param[PARAM_GAMMA], b->param[PARAM_RHO0], b->param[PARAM_V0],
                                b->time, b->dim};

    return exact_each(b, &item, at, &n);
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
