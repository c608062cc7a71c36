/* my-plugin.c -- a scheme: SPH as the textbooks have it, for a gas. Densities are sums over the
 * neighbours, and the shocks are carried by an artificial viscosity. With W the kernel and
 * v_ij = v_i - v_j:
 *
 *   rho_i = sum_j m_j W(x_ij, h_i)
 *   dv_i/dt = - sum_j m_j (p_i / rho_i^2 + p_j / rho_j^2 + Pi_ij) grad W
 *   du_i/dt = 1/2 sum_j m_j (p_i / rho_i^2 + p_j / rho_j^2 + Pi_ij) v_ij . grad W
 *   Pi_ij = (-alpha c mu + beta mu^2) / rho where the two approach, else 0,
 *   mu = h v_ij . x_ij / (r^2 + 0.01 h^2)
 *
 * with c, rho, h the means of the pair, and W in the rates the mean of W(h_i) and W(h_j). After
 * each step the smoothing lengths follow the densities, h = eta (m / rho)^(1/d).
 *
 * Source: J. J. Monaghan, Annu. Rev. Astron. Astrophys. 30 (1992) 543,
 * doi:10.1146/annurev.aa.30.090192.002551, sections 2 to 4. */
#include <math.h>
#include <sph/plugin.h>

#define SIZE(type) (uint32_t)sizeof(type)

/* -- Density --------
 *
 * A scheme is a recipe of functions. This is the first one: a sum over neighbours. It lists the
 * properties (columns of the particles) that it touches and how; the host hands them over in this
 * order, so that the enum numbers them. */
enum { DENSITY_M, DENSITY_RHO };
static const sph_prop density_props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_SUM, 0),
};

/* pair-loop.h makes the loops over all pairs out of what is done for one pair, the file that
 * SPH_LOOP_BODY names. S(name, NUMBER) gives that body the property NUMBER: name_i of the
 * destination (LOOP_I), name_j of the source (LOOP_J), or the sum `name` (LOOP_SUM); V(name,
 * NUMBER) a vector. */
#define SPH_LOOP density_sweep
#define SPH_LOOP_J(S, V, MATRIX) S(m, DENSITY_M)
#define SPH_LOOP_SUM(S, V, MATRIX) S(rho, DENSITY_RHO)
#define SPH_LOOP_REACH SPH_GATHER /* pairs with r < support h_i */
#define SPH_LOOP_SELF 1           /* a particle adds to its own density */
#define SPH_LOOP_BODY "density.body.h"
#define SPH_LOOP_DEVICE density_on_device /* the same body, as text for OpenCL devices */
#include <sph/pair-loop.h>

/* Members that are left out are 0 or NULL, which is the default of each: sph/function.h. */
static const sph_item density_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin-density",
    .doc = "density summation",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551, section 2",
    .props = SPH_LIST(density_props),
};
static const sph_function density_function = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &density_item,
    .run = density_sweep,
    .reach = SPH_GATHER,
    .reach_scale = 1.0,
    .device = &density_on_device,
};

/* -- Rates -------- */

enum { M, RHO, P, CS, V_, U, A, DU, MU, DT };
static const sph_prop rates_props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("a", "m/s^2", "acceleration", SPH_VECTOR, SPH_DST_SUM, 0),
    SPH_PROP("du", "W/kg", "rate of the specific internal energy", SPH_SCALAR, SPH_DST_SUM, 0),
    SPH_PROP("mu", "m/s", "largest speed of approach", SPH_SCALAR, SPH_DST_MAX | SPH_WORK, 0),
    SPH_PROP("dt", "s", "time step that the particle allows, before cfl", SPH_SCALAR, SPH_DST_WRITE,
             0),
};
enum { ALPHA, BETA };
static const sph_param rates_params[] = {
    SPH_PARAM("alpha", "", "artificial viscosity, linear", 1, 0, 10),
    SPH_PARAM("beta", "", "artificial viscosity, quadratic", 2, 0, 20),
};

#define SPH_LOOP rates_sweep
#define SPH_LOOP_I(S, V, MATRIX) S(rho, RHO) S(p, P) S(cs, CS) V(v, V_)
#define SPH_LOOP_J(S, V, MATRIX) S(m, M) S(rho, RHO) S(p, P) S(cs, CS) V(v, V_)
#define SPH_LOOP_SUM(S, V, MATRIX) V(a, A) S(du, DU)
#define SPH_LOOP_MAX(S) S(fastest, MU)
#define SPH_LOOP_PARAM(PARAM) PARAM(alpha, ALPHA) PARAM(beta, BETA)
#define SPH_LOOP_REACH SPH_SYMMETRIC /* pairs with r < support max(h_i, h_j) */
#define SPH_LOOP_BODY "rates.body.h"
#define SPH_LOOP_DEVICE rates_on_device
#include <sph/pair-loop.h>

/* After the sweep, each destination alone. point-loop.h makes `time_step` out of what is done for one
 * particle, time_step.body.h. P(scalar, name, NUMBER) gives that the property NUMBER, as do vector and
 * the like; it reads what stands in _IN, sets what stands in _OUT; _H gives it h. Many threads work on
 * a range of particles each, so that nothing is kept between calls. */
#define SPH_POINT_LOOP time_step
#define SPH_POINT_IN(X) X(scalar, cs, CS) X(scalar, fastest, MU)
#define SPH_POINT_OUT(X) X(scalar, dt, DT)
#define SPH_POINT_PARAM(X) X(alpha, ALPHA) X(beta, BETA)
#define SPH_POINT_H
#define SPH_POINT_BODY "time_step.body.h"
#define SPH_POINT_DEVICE time_step_on_device
#include <sph/point-loop.h>

/* What is the rate of what: integrators act on this table alone. */
static const sph_rate rates_rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
    SPH_RATE("u", "du", SPH_KICK),
};

/* Of all particles: the smallest dt bounds the time step, u is the internal energy. */
static const sph_reduction rates_reductions[] = {
    SPH_REDUCTION("dt", "dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP),
    SPH_REDUCTION("internal", "u", SPH_REDUCE_SUM, SPH_USE_INTERNAL),
};

static const sph_item rates_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin-rates",
    .doc = "acceleration and heating by pressure and artificial viscosity",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551, sections 3 and 4",
    .params = SPH_LIST(rates_params),
    .props = SPH_LIST(rates_props),
};
static const sph_function rates_function = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &rates_item,
    .run = rates_sweep,
    .after = time_step,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates_rates),
    .reductions = SPH_LIST(rates_reductions),
    .device = &rates_on_device,
    .device_after = &time_step_on_device,
};

/* -- Smoothing lengths --------
 *
 * A point function: each particle alone. */
enum { LENGTH_M, LENGTH_RHO, LENGTH_H };
static const sph_prop length_props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN),
    SPH_PROP("h", "m", "smoothing length", SPH_SCALAR, SPH_DST_WRITE, NAN),
};
enum { ETA };
static const sph_param length_params[] = {
    SPH_PARAM("eta", "", "smoothing length in units of (m / rho)^(1/d)", 1.3, 1, 4),
};

#define SPH_POINT_LOOP length
#define SPH_POINT_IN(X) X(scalar, m, LENGTH_M) X(scalar, rho, LENGTH_RHO)
#define SPH_POINT_OUT(X) X(scalar, h, LENGTH_H)
#define SPH_POINT_PARAM(X) X(eta, ETA)
#define SPH_POINT_BODY "length.body.h"
#define SPH_POINT_DEVICE length_on_device
#include <sph/point-loop.h>

static const sph_item length_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin-length",
    .doc = "smoothing length that follows the density",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551",
    .params = SPH_LIST(length_params),
    .props = SPH_LIST(length_props),
};
static const sph_function length_function = {
    .size = SIZE(sph_function),
    .shape = SPH_POINT,
    .item = &length_item,
    .run = length,
    .reach_scale = 1.0,
    .device_run = &length_on_device,
};

/* -- The scheme --------
 *
 * Its functions in order, here and from other plugins, with the material's equation of state
 * between. A scene may insert, replace and delete steps, and set their parameters on the scheme. */
static const sph_step steps[] = {
    SPH_STEP(SPH_AT_EVALUATE, "my-plugin-density"),
    SPH_STEP_EOS(SPH_AT_EVALUATE),
    SPH_STEP(SPH_AT_EVALUATE, "my-plugin-rates"),
    SPH_STEP(SPH_AT_FINISH, "my-plugin-length"),
};
static const sph_rate scheme_rates[] = {SPH_RATE("x", "v", SPH_DRIFT)};
static const sph_item scheme_item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "my-plugin",
    .doc = "SPH of the textbooks, with artificial viscosity",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551",
};
static const sph_scheme scheme = {
    .size = SIZE(sph_scheme),
    .item = &scheme_item,
    .kernel = "cubic-spline", /* kernel, integrator and cfl, where a scene names none */
    .integrator = "kdk",
    .cfl = 0.3,
    .steps = SPH_LIST(steps),
    .rates = SPH_LIST(scheme_rates),
};

/* Called once, when the plugin is loaded. It registers, and does nothing else. */
static sph_status init(const sph_host *host)
{
    sph_status status = host->register_item(host, SPH_KIND_FUNCTION, &density_function);

    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_FUNCTION, &rates_function);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_FUNCTION, &length_function);
    if (status == SPH_OK)
        status = host->register_item(host, SPH_KIND_SCHEME, &scheme);
    return status;
}

/* The one symbol that the plugin exports: name, version, licence, what it is, init, fini. */
SPH_PLUGIN("my-plugin", "0.1", "BSD-3-Clause", "SPH of the textbooks", init, NULL)
