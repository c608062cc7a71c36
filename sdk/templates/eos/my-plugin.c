/* my-plugin.c -- the gas of Noble and Abel, whose molecules take up room: an ideal gas in the
 * volume that they leave. Hot gases behind explosions are near to it. With the covolume b,
 *
 *   p = (gamma - 1) rho u / (1 - b rho),      c^2 = gamma p / (rho (1 - b rho)).
 *
 * Source: I. A. Johnston, The Noble-Abel equation of state: thermodynamic derivations for
 * ballistics modelling, DSTO-TN-0670 (2005). */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* What a user may set in the scene's material: {"eos": {"name": "my-plugin", "covolume": 0.25}}.
 * The host parses it, checks its range, and hands it over in b->param, in this order. */
enum { GAMMA, COVOLUME };
static const sph_param params[] = {
    SPH_PARAM("gamma", "", "ratio of the specific heats", 1.4, 1.000001, 100),
    /* NAN as the default would mean: a scene has to give it. */
    SPH_PARAM("covolume", "m^d/kg", "room that the molecules take up", 5e-4, 0, 1e300),
};

/* The columns that `run` is handed, in this order, and what it does with them. The names are those
 * of the schemes: an equation of state reads rho and u, and writes the pressure and the speed of
 * sound. */
enum { RHO, U, P, CS };
static const sph_prop props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0),
};

/* ... and those of the inverse: u where a scene gives p. */
enum { INVERSE_RHO, INVERSE_P, INVERSE_U };
static const sph_prop inverse_props[] = {
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0),
};

#define TOO_DENSE "my-plugin: the density exceeds 1 / covolume"

/* What is done for one particle stands in my-plugin.body.h. point-loop.h makes of it the function `run`,
 * for a range of particles: X(scalar, name, NUMBER) gives that the property NUMBER; it reads what stands
 * in _IN, and sets what stands in _OUT. SPH_POINT_DEVICE: the same body, as text for OpenCL devices. */
#define SPH_POINT_LOOP run
#define SPH_POINT_IN(X) X(scalar, rho, RHO) X(scalar, u, U)
#define SPH_POINT_OUT(X) X(scalar, p, P) X(scalar, cs, CS)
#define SPH_POINT_PARAM(X) X(gamma, GAMMA) X(covolume, COVOLUME)
#define SPH_POINT_FAIL TOO_DENSE
#define SPH_POINT_BODY "my-plugin.body.h"
#define SPH_POINT_DEVICE run_on_device
#include <sph/point-loop.h>

/* For the particles first ... first + count - 1. Many threads do this at once, each with a range of
 * its own: nothing is kept between calls. */
static sph_status inverse(const sph_batch *b)
{
    const double gamma = b->param[GAMMA], covolume = b->param[COVOLUME];

    const double *rho = (const double *)b->dst[INVERSE_RHO].data;
    const double *p = (const double *)b->dst[INVERSE_P].data;
    double *u = (double *)b->dst[INVERSE_U].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        if (!(covolume * rho[i] < 1))
            return b->host->fail(b->host, SPH_E_NUMERIC, TOO_DENSE);
        u[i] = p[i] * (1 - covolume * rho[i]) / ((gamma - 1) * rho[i]);
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin",
    .doc = "gas of Noble and Abel: p = (gamma - 1) rho u / (1 - covolume rho)",
    .source = "Johnston 2005, DSTO-TN-0670",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};
static const sph_eos eos = {
    .size = SIZE(sph_eos),
    .item = &item,
    .run = run,
    .inverse = inverse,
    .inverse_props = SPH_LIST(inverse_props),
    .device = &run_on_device,
};

/* Called once, when the plugin is loaded. It registers, and does nothing else. */
static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_EOS, &eos);
}

/* The one symbol that the plugin exports: name, version, licence, what it is, init, fini. */
SPH_PLUGIN("my-plugin", "0.1", "BSD-3-Clause", "equation of state of a gas with a covolume", init,
           NULL)
