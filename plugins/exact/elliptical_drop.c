/* elliptical_drop.c -- a round drop that is set stretching stays an ellipse, without outer forces.
 * J. J. Monaghan, J. Comput. Phys. 110 (1994) 399, doi:10.1006/jcph.1994.1034; the
 * equations dA/dt = A^2 (a^2 - b^2) / (a^2 + b^2), da/dt = -a A, db/dt = b A.
 *
 * With a = R exp(-s), b = R exp(s) the kinetic energy keeps A^2 cosh(2 s), so that ds/dt = A leaves
 * one quadrature: A0 t is the integral of sqrt(cosh(2 s)) from 0 to s. */
#include "exact.h"

static const sph_item item;

enum { RADIUS, RATE, RHO0 };
static const sph_param params[] = {
    SPH_PARAM("radius", "m", "at time 0", 1, 1e-300, 1e300),
    SPH_PARAM("rate", "1/s", "A0: at time 0, v is (-A0 x, A0 y)", 100, -1e300, 1e300),
    SPH_PARAM("rho0", "kg/m^d", "density", 1, 1e-300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_P,
    EXACT_V,
};

/* sqrt(cosh(2 s)), for s >= 0 */
static double speed(double s)
{
    return exp(s) * sqrt((1 + exp(-4 * s)) / 2);
}

/* Its integral from 0 to s less the time A0 t: 8 points of Gauss on pieces of at most 1/4. */
static double lateness(const void *of, double s, double *derivative)
{
    static const double place[] = {.1834346424956498, .5255324099163290, .7966664774136267,
                                   .9602898564975363};
    static const double weight[] = {.3626837833783620, .3137066458778873, .2223810344533745,
                                    .1012285362903763};
    const double time = *(const double *)of;
    const int pieces = 1 + (int)(4 * s);
    const double half = s / pieces / 2;
    double sum = 0;

    for (int i = 0; i < pieces; i++)
        for (int k = 0; k < 4; k++)
            sum += weight[k] *
                   (speed(half * (2 * i + 1 - place[k])) + speed(half * (2 * i + 1 + place[k])));
    *derivative = speed(s);
    return half * sum - time;
}

struct drop {
    double a, b; /* half axes along x and y */
    double rate;
    double pressure; /* in the middle */
};

static void at(const void *of, struct exact_point *q)
{
    const struct drop *d = of;
    const double x = q->x[0] / d->a, y = q->x[1] / d->b;

    q->v[0] = -d->rate * q->x[0];
    q->v[1] = d->rate * q->x[1];
    q->p = d->pressure * fmax(0, 1 - x * x - y * y);
}

static sph_status run(const sph_batch *b)
{
    const double radius = b->param[RADIUS], rate = b->param[RATE];
    const double time = fmin(fabs(rate) * fmax(0, b->time), 1e300);
    struct drop d;

    /* sinh(s) <= time <= sqrt(2) sinh(s), as sqrt(cosh(2 s)) is between cosh(s) and that. */
    const double s = exact_root(lateness, &time, asinh(time / sqrt(2)), asinh(time));
    const double stretch = exp(rate < 0 ? -s : s);

    d.a = radius / stretch;
    d.b = radius * stretch;
    d.rate = rate / speed(s);
    /* rho A^2 a^2 b^2 / (a^2 + b^2), as a b = R^2 */
    d.pressure = b->param[RHO0] * d.rate * d.rate * radius * radius / (2 * speed(s) * speed(s));
    return exact_each(b, &item, at, &d);
}

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2,
    .name = "elliptical-drop",
    .doc = "a round drop around the origin that stretches into an ellipse; outside p is 0",
    .source = "Monaghan 1994, doi:10.1006/jcph.1994.1034",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact elliptical_drop = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .run = run,
};
