/* fountain.c -- an inlet and an outlet: particles that leave a reservoir are copied at its far end, those
 * that come past the outlet are taken away. README has what must come out. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

enum { INLET, LENGTH, OUTLET };
static const sph_param params[] = {
    SPH_PARAM("inlet", "m", "x where the reservoir ends and the flow begins", NAN, -1e300, 1e300),
    SPH_PARAM("length", "m", "length of the reservoir, whole spacings", NAN, 1e-300, 1e300),
    SPH_PARAM("outlet", "m", "x beyond which particles are taken away", NAN, -1e300, 1e300),
};

enum { X, RELEASED, LEAVES, COPIES };
static const sph_prop props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("released", "", "1: has left the reservoir", SPH_INT32, SPH_DST_UPDATE, 0),
    SPH_PROP("leaves", "", "1: to be taken away", SPH_INT32, SPH_DST_WRITE | SPH_WORK, 0),
    SPH_PROP("copies", "", "how many copies to make", SPH_INT32, SPH_DST_WRITE | SPH_WORK, 0),
};

#define SPH_POINT_LOOP run
#define SPH_POINT_IN(P) P(vector, x, X)
#define SPH_POINT_INOUT(P) P(int32, released, RELEASED)
#define SPH_POINT_OUT(P) P(int32, leaves, LEAVES) P(int32, copies, COPIES)
#define SPH_POINT_PARAM(P) P(inlet, INLET) P(length, LENGTH) P(outlet, OUTLET)
#define SPH_POINT_BODY "fountain.body.h"
#define SPH_POINT_DEVICE fountain_device
#include <sph/point-loop.h>

enum { BORN_X, BORN_RELEASED, BORN_NUMBER };
static const sph_prop born_props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_UPDATE, NAN),
    SPH_PROP("released", "", "1: has left the reservoir", SPH_INT32, SPH_DST_WRITE, 0),
    SPH_PROP("copies", "", "number of the copy", SPH_INT32, SPH_DST_READ, 0),
};

/* The k-th copy stands k lengths behind; only the last one is still in the reservoir. */
static sph_status born(const sph_batch *b)
{
    double *x = b->dst[BORN_X].data;
    int32_t *released = b->dst[BORN_RELEASED].data;
    const int32_t *number = b->dst[BORN_NUMBER].data;

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        x[i] -= number[i] * b->param[LENGTH];
        released[i] = x[i] >= b->param[INLET];
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "fountain",
    .doc = "inlet and outlet of a flow along x",
    .source = "README",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};
static const sph_function function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &item,
    .run = run,
    .device_run = &fountain_device,
    .reach_scale = 1,
};
static const sph_population population = {
    .size = SIZE(sph_population),
    .remove = "leaves",
    .create = "copies",
    .born = born,
    .born_props = SPH_LIST(born_props),
};

/* The boundary condition of that name, for any scheme. */
static const sph_step steps[] = {
    SPH_STEP_AT(SPH_AT_FINISH, "fountain", NULL, NULL, SPH_ON_BOUNDARY),
};
static const sph_item boundary_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "fountain",
    .doc = "inlet and outlet of a flow along x",
    .source = "README",
};
static const sph_boundary boundary = {
    .size = SIZE(sph_boundary),
    .item = &boundary_item,
    .steps = SPH_LIST(steps),
};

/* -- A flow that needs no neighbours, to try it with: each particle keeps its velocity. */

enum { V };
static const sph_prop drift_props[] = {
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ, NAN),
};
#define SPH_POINT_LOOP drift
#define SPH_POINT_BODY "drift.body.h"
#define SPH_POINT_DEVICE drift_device
#include <sph/point-loop.h>

static const sph_item drift_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "fountain-drift",
    .doc = "x moves with v",
    .source = "README",
    .props = SPH_LIST(drift_props),
};
static const sph_function drift_function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &drift_item,
    .run = drift,
    .device_run = &drift_device,
    .reach_scale = 1,
};
static const sph_step drift_steps[] = {SPH_STEP(SPH_AT_EVALUATE, "fountain-drift")};
static const sph_rate drift_rates[] = {SPH_RATE("x", "v", SPH_DRIFT)};
static const sph_item scheme_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "fountain-drift",
    .doc = "particles that keep their velocity",
    .source = "README",
};
static const sph_scheme scheme = {
    .size = SIZE(sph_scheme),
    .item = &scheme_item,
    .integrator = "kdk",
    .cfl = 1,
    .steps = SPH_LIST(drift_steps),
    .rates = SPH_LIST(drift_rates),
};

static sph_status init(const sph_host *host)
{
    const sph_population_ext *extension = host->extension(host, SPH_EXT_POPULATION);

    if (!extension)
        return host->fail(host, SPH_E_UNKNOWN, "fountain needs the extension sph.population/0");
    sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &function);
    if (status == SPH_OK)
        status = extension->declare(host, "fountain", &population);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_BOUNDARY, &boundary);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_FUNCTION, &drift_function);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_SCHEME, &scheme);
    return status;
}

SPH_PLUGIN("fountain", "0.1", "BSD-3-Clause", "inlet and outlet", init, NULL)
