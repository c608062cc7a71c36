/* density.c -- density summation solved together with the smoothing length: h = eta (m / rho(h))^(1/d), by
 * Newton's method for h^d rho(h) from the h of the last evaluation, kept within 0.7 and 1.4 of it a sweep. The particle's own
 * term is weighted so that a cubic lattice has just its density. */
#include "gsph.h"
#include <math.h>
#include <sph/kernel-value.h>
#include <stdlib.h>

enum { M, H, RHO, SLOPE, BUSY };
enum { ETA, TOLERANCE };

static const sph_param params[] = {
    SPH_PARAM("eta", "", "smoothing length in units of (m / rho)^(1/d)", 1.5, 1.0, 4.0),
    SPH_PARAM("h_tolerance", "", "relative change of h at which its iteration ends", 1e-3, 1e-15,
              1e-2),
};

static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("h", "m", "smoothing length", SPH_SCALAR, SPH_DST_UPDATE, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_SUM, 0.0),
    SPH_PROP("drho_dh", "kg/m^(d+1)", "derivative of the summed density with h", SPH_SCALAR,
             SPH_DST_SUM | SPH_WORK, 0.0),
    SPH_PROP("h_busy", "", "1 while the iteration of h goes on", SPH_INT32,
             SPH_DST_WRITE | SPH_WORK, 0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_J(S, V, MAT) S(m, M)
#define SPH_LOOP_SUM(S, V, MAT) S(rho, RHO) S(slope, SLOPE)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "density.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_DEVICE density_device
#include <sph/pair-loop.h>

/* The kernel at r = 0, corrected: its sum over a cubic lattice of unit spacing misses 1 by a little at this eta,
 * and the particle's own term makes up for it (the idea of Dehnen & Aly 2012, section 2.4). */
static double own_weight(const sph_kernel_form *kernel, double eta)
{
    const int n = (int)(kernel->support * eta) + 1;
    const double scale = pow(eta, -(double)kernel->dim);
    double others = 0.0;
    for (int z = kernel->dim > 2 ? -n : 0; z <= (kernel->dim > 2 ? n : 0); z++)
        for (int y = kernel->dim > 1 ? -n : 0; y <= (kernel->dim > 1 ? n : 0); y++)
            for (int x = -n; x <= n; x++)
                if (x || y || z)
                    others +=
                        scale * sph_kernel_w(kernel, sqrt((double)(x * x + y * y + z * z)) / eta);
    return (1.0 - others) / scale;
}

/* The weight, once for all particles. */
struct state {
    double own; /* NaN: not known yet */
};

static sph_status create(const sph_host *host, const sph_config *config, uint32_t dim, void **out)
{
    struct state *state = malloc(sizeof(*state));
    (void)config;
    (void)dim;
    if (!state)
        return host->fail(host, SPH_E_NOMEM, "gsph-density: no memory for its state");
    state->own = NAN;
    *out = state;
    return SPH_OK;
}

static void destroy(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}

static sph_status prepare(const sph_batch *b)
{
    struct state *state = b->state;
    if (b->kernel && isnan(state->own))
        state->own = own_weight(b->kernel, b->param[ETA]);
    return SPH_OK;
}

static const sph_life life = {SIZE(sph_life), 0u, create, destroy};

#define SPH_POINT_LOOP update
#define SPH_POINT_IN(P) P(scalar, m, M)
#define SPH_POINT_INOUT(P) P(scalar, h, H) P(scalar, rho, RHO) P(scalar, slope, SLOPE)
#define SPH_POINT_OUT(P) P(int32, busy, BUSY)
#define SPH_POINT_PARAM(P) P(eta, ETA) P(tolerance, TOLERANCE)
#define SPH_POINT_STATE(P) P(own, 0)
#define SPH_POINT_BODY "update.body.h"
#define SPH_POINT_DEVICE density_update
#include <sph/point-loop.h>

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "gsph-density",
    .doc = "density summation, solved together with the smoothing length",
    .source = "Springel & Hernquist 2002, doi:10.1046/j.1365-8711.2002.05445.x, eq. 7; "
              "Dehnen & Aly 2012, doi:10.1111/j.1365-2966.2012.21439.x, section 2.4",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function gsph_density = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .life = &life,
    .run = sweep,
    .after = update,
    .reach = SPH_GATHER,
    .max_sweeps = 50,
    .unfinished = "h_busy",
    .reach_scale = 1.0,
    .device = &density_device,
    .prepare = prepare,
    .reals = SPH_F64 | SPH_F32,
    .device_after = &density_update,
};
