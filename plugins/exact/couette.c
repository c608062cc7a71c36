/* couette.c -- the upper of two walls sets out along x at time 0, and drags a viscous liquid along.
 * J. P. Morris, P. J. Fox & Y. Zhu, J. Comput. Phys. 136 (1997) 214, doi:10.1006/jcph.1997.5776. */
#include "exact.h"

static const sph_item item;

enum { WIDTH, NU, SPEED, Y0 };
static const sph_param params[] = {
    SPH_PARAM("width", "m", "distance of the walls", 1e-3, 1e-300, 1e300),
    SPH_PARAM("nu", "m^2/s", "kinematic viscosity", 1e-6, 1e-300, 1e300),
    SPH_PARAM("speed", "m/s", "of the upper wall along x, from time 0 on", 1.25e-5, -1e300, 1e300),
    SPH_PARAM("y0", "m", "y of the lower wall, at rest", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_V,
};

struct channel {
    double tau; /* nu t / width^2 */
    double y0, width, speed;
};

/* Soon after the start: each wall alone, and images of them. The terms fall as exp(-n^2 / tau):
 * H. S. Carslaw & J. C. Jaeger, Conduction of Heat in Solids (1959), chapter 12. */
static double early(double y, double tau)
{
    const double per = 1 / (2 * sqrt(tau));
    double sum = 0;

    for (int n = 1; n < 9; n += 2)
        sum += erfc((n - y) * per) - erfc((n + y) * per);
    return sum;
}

/* Later: the series of the paper. The terms fall as exp(-n^2 pi^2 tau). */
static double late(double y, double tau)
{
    double sum = y;

    for (int n = 1; n < 12; n++) {
        const double a = n * EXACT_PI;
        sum += (n % 2 ? -2 : 2) / a * sin(a * y) * exp(-a * a * tau);
    }
    return sum;
}

static void at(const void *of, struct exact_point *q)
{
    const struct channel *c = of;
    const double y = (q->x[1] - c->y0) / c->width;

    if (y >= 1)
        q->v[0] = c->speed;
    else if (y > 0 && c->tau > 0)
        q->v[0] = c->speed * (c->tau < .1 ? early(y, c->tau) : late(y, c->tau));
}

static sph_status run(const sph_batch *b)
{
    const double width = b->param[WIDTH];
    const struct channel c = {b->param[NU] * b->time / (width * width), b->param[Y0], width,
                              b->param[SPEED]};

    return exact_each(b, &item, at, &c);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "couette",
    .doc = "the upper of two walls drags a viscous liquid along x, from time 0 on; in the walls v "
           "is theirs",
    .source = "Morris, Fox & Zhu 1997, doi:10.1006/jcph.1997.5776",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact couette = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
