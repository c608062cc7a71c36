/* taylor_green.c -- vortices of a viscous liquid in a periodic square, that fade away.
 * G. I. Taylor & A. E. Green, Proc. R. Soc. A 158 (1937) 499, doi:10.1098/rspa.1937.0036; the plane
 * flow: G. I. Taylor, Philos. Mag. 46 (1923) 671. */
#include "exact.h"

static const sph_item item;

enum { SPEED, LENGTH, NU, RHO0, P0 };
static const sph_param params[] = {
    SPH_PARAM("speed", "m/s", "largest speed at time 0", 1, -1e300, 1e300),
    SPH_PARAM("length", "m", "side of the periodic square", 1, 1e-300, 1e300),
    SPH_PARAM("nu", "m^2/s", "kinematic viscosity; speed length / nu is the Reynolds number", .01,
              0, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density", 1, 1e-300, 1e300),
    SPH_PARAM("p0", "J/m^d", "mean pressure", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_P,
    EXACT_V,
};

struct flow {
    double k, speed, rho, p0;
};

static void at(const void *of, struct exact_point *q)
{
    const struct flow *f = of;
    const double x = f->k * q->x[0], y = f->k * q->x[1];

    q->v[0] = -f->speed * cos(x) * sin(y);
    q->v[1] = f->speed * sin(x) * cos(y);
    q->p = f->p0 - f->rho * f->speed * f->speed * (cos(2 * x) + cos(2 * y)) / 4;
}

static sph_status run(const sph_batch *b)
{
    const double k = 2 * EXACT_PI / b->param[LENGTH];
    const struct flow f = {k, b->param[SPEED] * exp(-2 * b->param[NU] * k * k * b->time),
                           b->param[RHO0], b->param[P0]};

    return exact_each(b, &item, at, &f);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "taylor-green",
    .doc = "Taylor and Green's vortices in the x-y plane, incompressible and viscous",
    .source = "Taylor & Green 1937, doi:10.1098/rspa.1937.0036; Taylor 1923, Philos. Mag. 46, 671",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact taylor_green = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
