/* rotating_patch.c -- how the rotating square patch of liquid starts: it turns as a rigid body, and
 * its pressure obeys laplace(p) = 2 rho omega^2 with p = 0 on its sides.
 * D. Le Touze, A. Colagrossi, G. Colicchio & M. Greco, Int. J. Numer. Methods Fluids 73 (2013) 660,
 * doi:10.1002/fld.3819; after A. Colagrossi's thesis (Rome, 2005).
 *
 * Their double series in sines, which falls as 1 / n^2, is summed over one of its indices:
 * p = -rho omega^2 (L^2 / 4 - x^2 - 8 L^2 / pi^3 sum over odd n of (-1)^((n - 1) / 2) / n^3
 *     cosh(n pi y / L) / cosh(n pi / 2) cos(n pi x / L))
 * (S. P. Timoshenko & J. N. Goodier, Theory of Elasticity (1951): torsion of a square bar).
 * The terms fall as exp(-n pi (1/2 - |y| / L)); x and y change places where that is faster. */
#include "exact.h"

#include <stdio.h>

static const sph_item item;

enum { SIDE, OMEGA, RHO0, X0, Y0 };
static const sph_param params[] = {
    SPH_PARAM("side", "m", "of the square", 1, 1e-300, 1e300),
    SPH_PARAM("omega", "1/s", "at time 0, v is (omega y, -omega x)", 1, -1e300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density", 1, 1e-300, 1e300),
    SPH_PARAM("x0", "m", "x of the centre", 0, -1e300, 1e300),
    SPH_PARAM("y0", "m", "y of the centre", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_P,
    EXACT_V,
};

/* -p / (rho omega^2 L^2), |y| <= |x| < 1/2. The longest sums are those in the very corners, where p
 * vanishes: what is left out there is below 2e-12. */
static double torsion(double x, double y)
{
    const double depth = EXACT_PI * (.5 - y);
    double sum = 0;

    for (int n = 1; n < 200000; n += 2) {
        const double fall = exp(-n * depth) / ((double)n * n * n);
        const double both = (1 + exp(-2 * n * EXACT_PI * y)) / (1 + exp(-n * EXACT_PI));
        sum += (n % 4 == 1 ? 1 : -1) * fall * both * cos(n * EXACT_PI * x);
        if (fall < 1e-18)
            break;
    }
    return (.5 - x) * (.5 + x) - 8 / (EXACT_PI * EXACT_PI * EXACT_PI) * sum;
}

static void at(const void *of, struct exact_point *q)
{
    const double *param = of;
    const double x = q->x[0] - param[X0], y = q->x[1] - param[Y0];
    const double s = fabs(x / param[SIDE]), t = fabs(y / param[SIDE]);
    const double speed = param[OMEGA] * param[SIDE];

    q->v[0] = param[OMEGA] * y;
    q->v[1] = -param[OMEGA] * x;
    if (s < .5 && t < .5)
        q->p = -param[RHO0] * speed * speed * torsion(fmax(s, t), fmin(s, t));
}

static sph_status run(const sph_batch *b)
{
    if (b->time > 0) {
        char text[160];
        snprintf(text, sizeof(text),
                 "rotating-patch: compares with the fields of time 0, which are all it knows; this "
                 "is time %g",
                 b->time);
        b->host->log(b->host, SPH_LOG_WARNING, text);
    }
    return exact_each(b, &item, at, b->param);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "rotating-patch",
    .doc = "the start of a rotating square patch, and only that: p and v of time 0, whatever the "
           "time; outside p is 0",
    .source = "Le Touze et al. 2013, doi:10.1002/fld.3819",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact rotating_patch = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
