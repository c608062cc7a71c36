/* conduction.c -- conduction of heat in bodies at rest. Three items: a function, the scheme that
 * consists of it, and an exact solution to compare with. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* -- The function ------------------------------------------------------------------------------ */

/* The properties it touches, in the order in which a batch hands over their columns. */
enum { MASS, DENSITY, CAPACITY, CONDUCTIVITY, TEMPERATURE, RATE, HEAT, STEP };
static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("heat_capacity", "J/(kg K)", "heat capacity", SPH_SCALAR, SPH_DST_READ, 1.0),
    SPH_PROP("conductivity", "W m^(2-d)/K", "conductivity", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ,
             1.0),
    SPH_PROP("T", "K", "temperature", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("dT", "K/s", "rate of the temperature", SPH_SCALAR, SPH_DST_SUM, 0.0),
    SPH_PROP("heat", "J/kg", "heat_capacity T", SPH_SCALAR, SPH_DST_WRITE | SPH_WORK, 0.0),
    SPH_PROP("conduction_dt", "s", "time step that the particle allows, before cfl", SPH_SCALAR,
             SPH_DST_WRITE | SPH_WORK, 0.0),
};

/* The sweep over the neighbours: makes `sweep`, from conduction.body.h. */
#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V, MATRIX) S(rho, DENSITY) S(c, CAPACITY) S(k, CONDUCTIVITY) S(T, TEMPERATURE)
#define SPH_LOOP_J(S, V, MATRIX) S(m, MASS) S(rho, DENSITY) S(k, CONDUCTIVITY) S(T, TEMPERATURE)
#define SPH_LOOP_SUM(S, V, MATRIX) S(rate, RATE)
#define SPH_LOOP_REACH SPH_SYMMETRIC
#define SPH_LOOP_BODY "conduction.body.h"
#define SPH_LOOP_DEVICE sweep_on_device
#include <sph/pair-loop.h>

/* After the sweep, each destination alone: makes `finish`, from finish.body.h. */
#define SPH_POINT_LOOP finish
#define SPH_POINT_IN(P)                                                                            \
    P(scalar, rho, DENSITY)                                                                        \
    P(scalar, c, CAPACITY) P(scalar, k, CONDUCTIVITY) P(scalar, temperature, TEMPERATURE)
#define SPH_POINT_OUT(P) P(scalar, heat, HEAT) P(scalar, step, STEP)
#define SPH_POINT_H
#define SPH_POINT_BODY "finish.body.h"
#define SPH_POINT_DEVICE finish_on_device
#include <sph/point-loop.h>

static const sph_rate rates[] = {SPH_RATE("T", "dT", SPH_KICK)};
static const sph_reduction reductions[] = {
    SPH_REDUCTION("conduction_dt", "conduction_dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),
    SPH_REDUCTION("heat", "heat", SPH_REDUCE_SUM, SPH_USE_INTERNAL),
};

static const sph_item function_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "conduction",
    .doc = "conduction of heat, between materials too",
    .source = "Cleary & Monaghan 1999, doi:10.1006/jcph.1998.6118",
    .props = SPH_LIST(props),
};
static const sph_function function = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &function_item,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device = &sweep_on_device,
    .device_after = &finish_on_device,
};

/* -- The scheme -------------------------------------------------------------------------------- */

static const sph_step steps[] = {SPH_STEP(SPH_AT_EVALUATE, "conduction")};

static const sph_item scheme_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "conduction",
    .doc = "conduction of heat in bodies at rest",
    .source = "Cleary & Monaghan 1999, doi:10.1006/jcph.1998.6118",
};
static const sph_scheme scheme = {
    .size = SIZE(sph_scheme),
    .item = &scheme_item,
    .kernel = "quintic-spline",
    .integrator = "kdk",
    .cfl = 0.1,
    .steps = SPH_LIST(steps),
};

/* -- The exact solution ------------------------------------------------------------------------ */

enum { X0, T_LEFT, T_RIGHT, K_LEFT, K_RIGHT, RHO_LEFT, RHO_RIGHT, C_LEFT, C_RIGHT };
static const sph_param params[] = {
    SPH_PARAM("x0", "m", "where the bodies touch", 0.0, -1e300, 1e300),
    SPH_PARAM("T_left", "K", "temperature at the start, x < x0", NAN, -1e300, 1e300),
    SPH_PARAM("T_right", "K", "temperature at the start, x > x0", NAN, -1e300, 1e300),
    SPH_PARAM("k_left", "W m^(2-d)/K", "conductivity", 1.0, 1e-300, 1e300),
    SPH_PARAM("k_right", "W m^(2-d)/K", "conductivity", 1.0, 1e-300, 1e300),
    SPH_PARAM("rho_left", "kg/m^d", "density", 1.0, 1e-300, 1e300),
    SPH_PARAM("rho_right", "kg/m^d", "density", 1.0, 1e-300, 1e300),
    SPH_PARAM("c_left", "J/(kg K)", "heat capacity", 1.0, 1e-300, 1e300),
    SPH_PARAM("c_right", "J/(kg K)", "heat capacity", 1.0, 1e-300, 1e300),
};

enum { EXACT_X, EXACT_T };
static const sph_prop exact_props[] = {
    SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("T", "K", "temperature", SPH_SCALAR, SPH_DST_WRITE, 0.0),
};

static sph_status contact(const sph_batch *b)
{
    const double *p = b->param, *x = b->dst[EXACT_X].data;
    double *temperature = b->dst[EXACT_T].data;
    const double left = sqrt(p[K_LEFT] * p[RHO_LEFT] * p[C_LEFT]);
    const double right = sqrt(p[K_RIGHT] * p[RHO_RIGHT] * p[C_RIGHT]);
    const double touch = (left * p[T_LEFT] + right * p[T_RIGHT]) / (left + right);

    if (!temperature) /* nobody asks for it */
        return SPH_OK;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        const double d = x[i] - p[X0];
        const double far = d < 0 ? p[T_LEFT] : p[T_RIGHT];
        const double a = d < 0 ? p[K_LEFT] / (p[RHO_LEFT] * p[C_LEFT])
                               : p[K_RIGHT] / (p[RHO_RIGHT] * p[C_RIGHT]);
        temperature[i] =
            b->time > 0 ? touch + (far - touch) * erf(fabs(d) / sqrt(4 * a * b->time)) : far;
    }
    return SPH_OK;
}

static const sph_item exact_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "contact",
    .doc = "two half spaces of different temperature that touch at x0 from time 0 on",
    .source = "Carslaw & Jaeger 1959, Conduction of Heat in Solids, section 2.15",
    .params = SPH_LIST(params),
    .props = SPH_LIST(exact_props),
};
static const sph_exact exact = {
    .size = SIZE(sph_exact),
    .item = &exact_item,
    .run = contact,
};

/* -- The plugin -------------------------------------------------------------------------------- */

static sph_status init(const sph_host *host)
{
    sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &function);

    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_SCHEME, &scheme);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_EXACT, &exact);
    return status;
}

SPH_PLUGIN("conduction", "0.1", "BSD-3-Clause", "conduction of heat", init, NULL)
