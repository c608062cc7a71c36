/* my-plugin.c -- an exact solution, which scenes compare their particles with: a cloud of a
 * dissolved substance that drifts along x with the fluid and spreads,
 *
 *   c(x, t) = (s0 / s)^d exp(-|x - x(t)|^2 / (2 s^2)),   s^2 = s0^2 + 2 D t,   x(t) = x0 + speed t.
 *
 * Source: J. Crank, The Mathematics of Diffusion, 2nd ed. (1975), section 2.2, where s0 = 0. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* What a scene may set, beside "exact": "my-plugin" in its "compare". The host parses it, checks
 * its range, and hands it over in b->param, in this order. */
enum { X0, Y0, Z0, WIDTH, SPEED, DIFFUSIVITY };
static const sph_param params[] = {
    SPH_PARAM("x0", "m", "where the cloud is at the time 0, along x", 0, -1e300, 1e300),
    SPH_PARAM("y0", "m", "... along y", 0, -1e300, 1e300),
    SPH_PARAM("z0", "m", "... along z", 0, -1e300, 1e300),
    /* NAN as the default: a scene has to give it. */
    SPH_PARAM("width", "m", "s0", NAN, 1e-300, 1e300),
    SPH_PARAM("speed", "m/s", "of the drift", 0, -1e300, 1e300),
    SPH_PARAM("diffusivity", "m^2/s", "D", 0, 0, 1e300),
};

/* It reads positions and writes the fields that it knows. */
enum { X, C };
static const sph_prop props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("c", "kg/kg", "concentration", SPH_SCALAR, SPH_DST_WRITE, 0),
};

/* Component k of a column: the components lie in planes, one behind the other. */
static double *plane(const sph_column *column, uint32_t k)
{
    return (double *)column->data + (size_t)k * column->plane;
}

/* At the positions first ... first + count - 1 and the time b->time. */
static sph_status run(const sph_batch *b)
{
    const double center[3] = {b->param[X0] + b->param[SPEED] * b->time, b->param[Y0], b->param[Z0]};
    const double s0 = b->param[WIDTH];
    const double s2 = s0 * s0 + 2 * b->param[DIFFUSIVITY] * b->time;

    /* Columns are double or float, as the host chooses; this loop knows double. */
    if (b->real != SPH_F64)
        return b->host->fail(b->host, SPH_E_UNKNOWN, "my-plugin works in double precision");
    /* A field that the host did not ask for has no column. */
    if (!b->dst[C].data)
        return SPH_OK;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        double r2 = 0;

        for (uint32_t k = 0; k < b->dim; k++) {
            const double d = plane(&b->dst[X], k)[i] - center[k];
            r2 += d * d;
        }
        plane(&b->dst[C], 0)[i] = pow(s0 * s0 / s2, 0.5 * b->dim) * exp(-0.5 * r2 / s2);
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin",
    .doc = "a cloud of a dissolved substance that drifts and spreads",
    .source = "Crank 1975, The Mathematics of Diffusion, section 2.2",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};
static const sph_exact exact = {
    .size = SIZE(sph_exact),
    .item = &item,
    .run = run,
};

/* Called once, when the plugin is loaded. It registers, and does nothing else. */
static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_EXACT, &exact);
}

/* The one symbol that the plugin exports: name, version, licence, what it is, init, fini. */
SPH_PLUGIN("my-plugin", "0.1", "BSD-3-Clause", "exact solution for a drifting, spreading cloud",
           init, NULL)
