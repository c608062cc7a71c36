/* plate.c -- a plate, clamped at x = 0 and free at x = length, swings in one of its modes.
 * L. D. Landau & E. M. Lifshitz, Theory of Elasticity (1970), sections 12, 25: thin, plane strain.
 * With shear and rotary inertia: S. P. Timoshenko, Philos. Mag. 41 (1921) 744,
 * doi:10.1080/14786442108636264; its frequencies and modes in closed form: T. C. Huang, J. Appl.
 * Mech. 28 (1961) 579, doi:10.1115/1.3641787. The thin plate is what remains for q = r = 0:
 *     p^4 + (q + r) p^2 + q r - k^4 = 0,   p^2 = alpha^2 or -beta^2,
 *     k^4 = rho H omega^2 / D,  q = rho omega^2 / (kappa G),  r = rho omega^2 (1 - nu^2) / E.
 * To first order in the deflection: the place is taken for that in the plate at rest. */
#include "exact.h"

#include <stdlib.h>

static const sph_item item;

static const sph_param params[] = {
    SPH_PARAM("length", "m", "from the clamp to the free end", .2, 1e-300, 1e300),
    SPH_PARAM("thickness", "m", "across, along y", .02, 1e-300, 1e300),
    SPH_PARAM("young", "J/m^d", "Young's modulus", 2e6, 1e-300, 1e300),
    SPH_PARAM("poisson", "", "Poisson's ratio", .3975, -.99, .5),
    SPH_PARAM("rho0", "kg/m^d", "density", 1000, 1e-300, 1e300),
    SPH_PARAM("mode", "", "its number: 1 is the slowest; whole", 1, 1, 100),
    SPH_PARAM("amplitude", "m", "of the free end", .002, -1e300, 1e300),
    SPH_PARAM_CHOICE("theory", "thin, or with shear and rotary inertia", 0, "thin|timoshenko"),
    SPH_PARAM("shear", "", "of timoshenko: shear factor kappa", 5. / 6, .1, 1),
    SPH_PARAM_CHOICE("start", "at time 0: straight and moving, or bent and at rest", 0,
                     "straight|bent"),
    SPH_PARAM("x0", "m", "x of the clamp", 0, -1e300, 1e300),
    SPH_PARAM("y0", "m", "y of the middle of the plate", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X,
    EXACT_V,
    EXACT_D,
};

/* In units of the length. */
struct mode {
    double shear, rotary; /* q and r over (k L)^4 */
    double alpha, beta;   /* of the hyperbolic and the circular functions */
    double turn_a,
        turn_b; /* rotation over deflection: (alpha^2 + q) / alpha, (beta^2 - q) / beta */
    double rise, fall, ratio; /* coefficients */
    double tip;               /* deflection at the free end */
    int sign;
};

struct plate {
    struct mode mode;
    double length, omega, amplitude, x0, y0;
    int bent;
};

/* alpha, beta and the turns for z = k L; 0: alpha is imaginary there. */
static int waves(struct mode *m, double z)
{
    const double k4 = z * z * z * z, q = m->shear * k4, r = m->rotary * k4;
    const double beta2 = (q + r) / 2 + sqrt((q - r) * (q - r) / 4 + k4);

    if (q * r >= k4)
        return 0;
    m->beta = sqrt(beta2);
    m->alpha = sqrt((k4 - q * r) / beta2);
    m->turn_a = m->alpha + q / m->alpha;
    m->turn_b = m->beta - q / m->beta;
    return 1;
}

/* 0 where z is of a mode: Huang's frequency equation over cosh(alpha). */
static double frequency(const void *of, double z, double *derivative)
{
    struct mode m = *(const struct mode *)of;

    if (!waves(&m, z))
        return NAN;

    const double a = m.alpha, b = m.beta, turns = m.turn_a * a / (m.turn_b * b);

    *derivative = 0;
    return m.sign *
           (2 / cosh(a) + cos(b) * (turns + 1 / turns) - (b / a - a / b) * tanh(a) * sin(b));
}

/* k L of the mode of this number; 0: none. Modes are never as near to each other as the step. */
static double find(struct mode *m, int number)
{
    const double step = .02;
    double unused, last = step;
    double before = frequency(m, last, &unused);

    for (int found = 0; isfinite(before); last += step) {
        const double now = frequency(m, last + step, &unused);
        if (before * now <= 0 && ++found == number) {
            m->sign = now > 0 ? 1 : -1;
            return exact_root(frequency, m, last, last + step);
        }
        before = now;
    }
    return 0;
}

/* Deflection and rotation at x, before scaling. No term grows beyond the free end's. */
static double shape(const struct mode *m, double x, double *rotation)
{
    const double up = m->rise * exp(m->alpha * (x - 1)), down = m->fall * exp(-m->alpha * x);
    const double s = sin(m->beta * x), c = cos(m->beta * x);

    *rotation = m->turn_a * (up - down - m->ratio * c) + m->turn_b * s;
    return up + down - c - m->ratio * m->turn_a / m->turn_b * s;
}

/* cosh(alpha x) - cos(beta x) + ratio (sinh(alpha x) - turn_a / turn_b sin(beta x)), clamped at 0,
 * with a ratio that leaves no moment at 1. The sum of its growing parts, (1 + ratio) / 2
 * exp(alpha), is taken before they cancel. */
static void settle(struct mode *m, double z)
{
    waves(m, z);

    const double a = m->alpha, b = m->beta, small = exp(-a);
    const double moment = m->turn_a * (a * (1 - small * small) / 2 + b * sin(b) * small);
    double unused;

    m->rise = (m->turn_a * (b * sin(b) - a * small) - m->turn_b * b * cos(b)) / (2 * moment);
    m->fall = 1 - m->rise * small;
    m->ratio = 2 * m->rise * small - 1;
    m->tip = shape(m, 1, &unused);
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    const double length = host->param(c, "length"), h = host->param(c, "thickness") / length;
    const double young = host->param(c, "young"), poisson = host->param(c, "poisson");
    const double number = host->param(c, "mode");
    struct mode m = {.sign = 1};

    (void)dim;
    if (number != floor(number))
        return exact_fail(host, SPH_E_INVALID, "mode is a whole number, not %g", number);
    if (host->param(c, "theory") == 1) {
        /* D / (rho H) = E H^2 / (12 rho (1 - nu^2)), G = E / (2 (1 + nu)) */
        m.rotary = h * h / 12;
        m.shear = m.rotary * 2 / (host->param(c, "shear") * (1 - poisson));
    }
    const double z = find(&m, (int)number);
    if (z == 0)
        return exact_fail(host, SPH_E_INVALID,
                          "mode %g is above the frequency up to which this solution holds, "
                          "sqrt(12 kappa G / rho) / thickness",
                          number);

    struct plate *p = malloc(sizeof(*p));
    if (!p)
        return SPH_E_NOMEM;
    settle(&m, z);
    const double speed = sqrt(young / (12 * host->param(c, "rho0") * (1 - poisson * poisson)));
    *p = (struct plate){.mode = m,
                        .length = length,
                        .omega = z * z * h * speed / length,
                        .amplitude = host->param(c, "amplitude"),
                        .x0 = host->param(c, "x0"),
                        .y0 = host->param(c, "y0"),
                        .bent = host->param(c, "start") == 1};
    *state = p;
    return SPH_OK;
}

/* At one time: deflection and speed of the free end. */
struct moment {
    const struct plate *plate;
    double d, v;
};

static void at(const void *of, struct exact_point *q)
{
    const struct moment *m = of;
    const struct plate *p = m->plate;
    const double x = (q->x[0] - p->x0) / p->length, y = (q->x[1] - p->y0) / p->length;
    double rotation;

    if (x <= 0) /* in the clamp */
        return;
    /* Beyond the free end, where no moment bends it, straight on. */
    double w = shape(&p->mode, fmin(x, 1), &rotation) / p->mode.tip;
    rotation /= p->mode.tip;
    w += rotation * fmax(0, x - 1);
    q->d[0] = -y * rotation * m->d;
    q->d[1] = w * m->d;
    q->v[0] = -y * rotation * m->v;
    q->v[1] = w * m->v;
}

static sph_status run(const sph_batch *b)
{
    const struct plate *p = b->state;
    const double phase = p->omega * b->time + (p->bent ? EXACT_PI / 2 : 0);
    const struct moment m = {p, p->amplitude * sin(phase), p->amplitude * p->omega * cos(phase)};

    return exact_each(b, &item, at, &m);
}

static const sph_life life = {
    .size = (uint32_t)sizeof(sph_life),
    .create = create,
    .destroy = exact_free,
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_DIM2 | SPH_DIM3,
    .name = "plate",
    .doc = "a plate clamped at one end swings across, along y, in one of its modes; small "
           "deflections, plane strain",
    .source = "Landau & Lifshitz, Theory of Elasticity (1970), sections 12, 25; Huang 1961, "
              "doi:10.1115/1.3641787",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact plate = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .life = &life,
    .run = run,
};
