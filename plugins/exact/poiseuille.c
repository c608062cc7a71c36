/* poiseuille.c -- a body force sets a viscous liquid between two walls at rest in motion along x.
 * J. P. Morris, P. J. Fox & Y. Zhu, J. Comput. Phys. 136 (1997) 214, doi:10.1006/jcph.1997.5776. */
#include "exact.h"

static const sph_item item;

enum { WIDTH, NU, FORCE, Y0 };
static const sph_param params[] = {
    SPH_PARAM("width", "m", "distance of the walls", 1e-3, 1e-300, 1e300),
    SPH_PARAM("nu", "m^2/s", "kinematic viscosity", 1e-6, 1e-300, 1e300),
    SPH_PARAM("force", "m/s^2", "body force along x, per mass", 1e-4, -1e300, 1e300),
    SPH_PARAM("y0", "m", "y of the lower wall", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_V,
};

struct channel {
    double tau; /* nu t / width^2 */
    double y0, width;
    double scale; /* [m/s]: force width^2 / nu */
};

/* 4 i^2 erfc(z), the second integral of the error function. */
static double i2erfc(double z)
{
    return (1 + 2 * z * z) * erfc(z) - 2 * z / sqrt(EXACT_PI) * exp(-z * z);
}

/* Soon after the start: as if each wall were alone, and images of them. The terms fall as
 * exp(-n^2 / (4 tau)): H. S. Carslaw & J. C. Jaeger, Conduction of Heat in Solids (1959),
 * chapter 3, for a source of heat. */
static double early(double y, double tau)
{
    const double per = 1 / (2 * sqrt(tau));
    double sum = 1;

    for (int n = 0; n < 8; n++)
        sum += (n % 2 ? 1 : -1) * (i2erfc((n + y) * per) + i2erfc((n + 1 - y) * per));
    return tau * sum;
}

/* Later: the series of the paper. The terms fall as exp(-n^2 pi^2 tau). */
static double late(double y, double tau)
{
    double sum = y * (1 - y) / 2;

    for (int n = 1; n < 16; n += 2) {
        const double a = n * EXACT_PI;
        sum -= 4 / (a * a * a) * sin(a * y) * exp(-a * a * tau);
    }
    return sum;
}

static void at(const void *of, struct exact_point *q)
{
    const struct channel *c = of;
    const double y = (q->x[1] - c->y0) / c->width;

    if (y > 0 && y < 1 && c->tau > 0)
        q->v[0] = c->scale * (c->tau < .1 ? early(y, c->tau) : late(y, c->tau));
}

static sph_status run(const sph_batch *b)
{
    const double width = b->param[WIDTH], nu = b->param[NU];
    const struct channel c = {nu * b->time / (width * width), b->param[Y0], width,
                              b->param[FORCE] * width * width / nu};

    return exact_each(b, &item, at, &c);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "poiseuille",
    .doc = "a body force starts a viscous flow along x between two walls at rest; in them v is 0",
    .source = "Morris, Fox & Zhu 1997, doi:10.1006/jcph.1997.5776",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact poiseuille = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
