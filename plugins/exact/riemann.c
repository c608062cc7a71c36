/* riemann.c -- Riemann's problem of an ideal gas in x: two uniform states meet at x0 at time 0.
 * E. F. Toro, Riemann Solvers and Numerical Methods for Fluid Dynamics (2009), chapter 4,
 * doi:10.1007/b79761; equation numbers are his. Vacuum on a side, or made between them:
 * section 4.6. */
#include "exact.h"

#include <stdlib.h>

static const sph_item item;

static const sph_param params[] = {
    SPH_PARAM("rho_l", "kg/m^d", "density left of x0", 1, 0, 1e300),
    SPH_PARAM("u_l", "m/s", "velocity left of x0", 0, -1e300, 1e300),
    SPH_PARAM("p_l", "J/m^d", "pressure left of x0", 1, 0, 1e300),
    SPH_PARAM("rho_r", "kg/m^d", "density right of x0", .125, 0, 1e300),
    SPH_PARAM("u_r", "m/s", "velocity right of x0", 0, -1e300, 1e300),
    SPH_PARAM("p_r", "J/m^d", "pressure right of x0", .1, 0, 1e300),
    SPH_PARAM("gamma", "", "ratio of the specific heats", 1.4, 1.000001, 100),
    SPH_PARAM("x0", "m", "where the two states meet", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    SPH_PROP("x", "m", "position; only its first component matters", SPH_VECTOR, SPH_DST_READ, NAN),
    EXACT_RHO,
    EXACT_P,
    EXACT_V,
    EXACT_U,
};

struct side {
    double rho, u, p; /* u: velocity along x */
    double a;         /* speed of sound */
};

struct fan {
    struct side l, r;
    double gamma, x0;
    double p, u; /* between the two waves */
    int vacuum;  /* no state is between them */
};

/* The jump of velocity over the wave of a side to pressure p, and its derivative:
 * eqs. 4.6-4.7, 4.37. */
static double jump(const struct side *k, double gamma, double p, double *derivative)
{
    if (p > k->p) {
        const double a = 2 / ((gamma + 1) * k->rho);
        const double b = (gamma - 1) / (gamma + 1) * k->p;
        const double root = sqrt(a / (p + b));
        *derivative = root * (1 - (p - k->p) / (2 * (p + b)));
        return (p - k->p) * root;
    }
    if (k->p == 0) { /* cold gas does not expand */
        *derivative = 0;
        return 0;
    }
    *derivative = pow(p / k->p, -(gamma + 1) / (2 * gamma)) / (k->rho * k->a);
    return 2 * k->a / (gamma - 1) * (pow(p / k->p, (gamma - 1) / (2 * gamma)) - 1);
}

static double mismatch(const struct fan *f, double p, double *derivative)
{
    double dl, dr;
    const double sum = jump(&f->l, f->gamma, p, &dl) + jump(&f->r, f->gamma, p, &dr);

    *derivative = dl + dr;
    return sum + f->r.u - f->l.u;
}

/* The pressure if both waves are rarefactions, eq. 4.46; a fair guess where that means nothing. */
static double first_guess(const struct fan *f)
{
    const double z = (f->gamma - 1) / (2 * f->gamma);
    const double du = f->r.u - f->l.u;
    const double p = pow((f->l.a + f->r.a - (f->gamma - 1) / 2 * du) /
                             (f->l.a / pow(f->l.p, z) + f->r.a / pow(f->r.p, z)),
                         1 / z);

    if (isfinite(p) && p > 0)
        return p;
    return f->l.p + f->r.p + (f->l.rho + f->r.rho) * du * du;
}

/* Newton's iteration, kept within a bracket. The mismatch rises with p, from below 0 at p = 0. */
static sph_status solve(struct fan *f)
{
    double derivative;
    double low = 0;
    double high = first_guess(f);
    double p = high;

    while (mismatch(f, high, &derivative) < 0) {
        low = high;
        high *= 4;
        if (!isfinite(high))
            return SPH_E_NUMERIC;
    }
    for (int i = 0; i < 200; i++) {
        const double wrong = mismatch(f, p, &derivative);
        double next = p - wrong / derivative;

        if (wrong < 0)
            low = p;
        else
            high = p;
        if (!(next >= low && next <= high))
            next = low > 0 ? sqrt(low) * sqrt(high) : high / 16;
        if (fabs(next - p) <= 1e-15 * next) {
            p = next;
            break;
        }
        p = next;
    }
    f->p = p;
    f->u = (f->l.u + f->r.u + jump(&f->r, f->gamma, p, &derivative) -
            jump(&f->l, f->gamma, p, &derivative)) /
           2;
    return isfinite(f->p) && isfinite(f->u) ? SPH_OK : SPH_E_NUMERIC;
}

static struct side side_of(const sph_host *host, const sph_config *c, const char *rho,
                           const char *u, const char *p, double gamma)
{
    struct side s = {host->param(c, rho), host->param(c, u), host->param(c, p), 0};

    s.a = s.rho > 0 ? sqrt(gamma * s.p / s.rho) : 0;
    return s;
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    struct fan *f = calloc(1, sizeof(*f));
    sph_status status = SPH_OK;

    (void)dim;
    if (!f)
        return SPH_E_NOMEM;
    f->gamma = host->param(c, "gamma");
    f->x0 = host->param(c, "x0");
    f->l = side_of(host, c, "rho_l", "u_l", "p_l", f->gamma);
    f->r = side_of(host, c, "rho_r", "u_r", "p_r", f->gamma);
    /* Eq. 4.40: the gas parts faster than it can follow. */
    f->vacuum =
        f->l.rho == 0 || f->r.rho == 0 || f->r.u - f->l.u >= 2 * (f->l.a + f->r.a) / (f->gamma - 1);
    if (!f->vacuum)
        status = solve(f);
    if (status != SPH_OK) {
        free(f);
        return exact_fail(host, status, "no pressure joins the two states");
    }
    *state = f;
    return SPH_OK;
}

/* Within the rarefaction of the left side: eq. 4.56. */
static struct side inside_fan(const struct side *k, double gamma, double s)
{
    const double c = 2 / (gamma + 1) + (gamma - 1) / ((gamma + 1) * k->a) * (k->u - s);

    return (struct side){k->rho * pow(c, 2 / (gamma - 1)),
                         2 / (gamma + 1) * (k->a + (gamma - 1) / 2 * k->u + s),
                         k->p * pow(c, 2 * gamma / (gamma - 1)), 0};
}

/* Left of the contact (or of the vacuum, whose edge moves with `edge`) at speed s = (x - x0) / t.
 * The right is its mirror image. */
static struct side sample_left(const struct side *k, const struct fan *f, double p, double u,
                               double s)
{
    const double g = f->gamma;
    const double ratio = p / k->p;

    if (p > k->p) { /* shock: eqs. 4.50, 4.52 */
        const double m = (g - 1) / (g + 1);
        /* rho (u - speed), finite for cold gas as well */
        const double flux = sqrt(k->rho * ((g + 1) / 2 * p + (g - 1) / 2 * k->p));
        if (s <= k->u - flux / k->rho)
            return *k;
        return (struct side){k->rho * (p + m * k->p) / (m * p + k->p), u, p, 0};
    }
    if (s <= k->u - k->a) /* rarefaction: eqs. 4.53-4.56 */
        return *k;
    if (s > u - k->a * pow(ratio, (g - 1) / (2 * g)))
        return (struct side){k->rho * pow(ratio, 1 / g), u, p, 0};
    return inside_fan(k, g, s);
}

static struct side sample_vacuum(const struct side *k, double gamma, double s)
{
    if (k->rho > 0 && s <= k->u - k->a)
        return *k;
    if (k->rho > 0 && s < k->u + 2 * k->a / (gamma - 1))
        return inside_fan(k, gamma, s);
    return (struct side){0, s, 0, 0};
}

static struct side mirrored(struct side k)
{
    k.u = -k.u;
    return k;
}

static struct side sample(const struct fan *f, double s)
{
    const struct side r = mirrored(f->r);

    if (f->vacuum) {
        const struct side left = sample_vacuum(&f->l, f->gamma, s);
        return left.rho > 0 ? left : mirrored(sample_vacuum(&r, f->gamma, -s));
    }
    if (s <= f->u)
        return sample_left(&f->l, f, f->p, f->u, s);
    return mirrored(sample_left(&r, f, f->p, -f->u, -s));
}

struct moment {
    const struct fan *fan;
    double t;
};

static void at(const void *of, struct exact_point *q)
{
    const struct moment *m = of;
    const struct fan *f = m->fan;
    const double distance = q->x[0] - f->x0;
    const struct side s = m->t > 0 ? sample(f, distance / m->t) : distance < 0 ? f->l : f->r;

    q->rho = s.rho;
    q->p = s.p;
    q->u = s.rho > 0 ? s.p / ((f->gamma - 1) * s.rho) : 0;
    q->v[0] = s.u;
}

static sph_status run(const sph_batch *b)
{
    const struct moment m = {b->state, b->time};

    return exact_each(b, &item, at, &m);
}

static const sph_life life = {
    .size = (uint32_t)sizeof(sph_life),
    .create = create,
    .destroy = exact_free,
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "riemann",
    .doc = "Riemann's problem of an ideal gas along x, vacuum included; the defaults are Sod's",
    .source =
        "Toro 2009, doi:10.1007/b79761, chapter 4; Sod 1978, doi:10.1016/0021-9991(78)90023-2",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact riemann = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .life = &life,
    .run = run,
};
