/* stiffened-riemann.c -- two states of a stiffened gas meet at x0 and run along x: the exact solution.
 * README has the equations; their numbers stand here in brackets. */
#include <math.h>
#include <sph/plugin.h>
#include <stdlib.h>

enum { RHO_L, V_L, P_L, RHO_R, V_R, P_R, GAMMA, P_INF, X0 };
static const sph_param params[] = {
    SPH_PARAM("rho_l", "kg/m^d", "density on the left", NAN, 1e-300, 1e300),
    SPH_PARAM("v_l", "m/s", "velocity on the left", 0, -1e300, 1e300),
    SPH_PARAM("p_l", "J/m^d", "pressure on the left", NAN, -1e300, 1e300),
    SPH_PARAM("rho_r", "kg/m^d", "density on the right", NAN, 1e-300, 1e300),
    SPH_PARAM("v_r", "m/s", "velocity on the right", 0, -1e300, 1e300),
    SPH_PARAM("p_r", "J/m^d", "pressure on the right", NAN, -1e300, 1e300),
    SPH_PARAM("gamma", "", "exponent", 4.4, 1.000001, 100),
    SPH_PARAM("p_inf", "J/m^d", "stiffness", 0, 0, 1e300),
    SPH_PARAM("x0", "m", "where the two meet at time 0", 0, -1e300, 1e300),
};

enum { X, RHO, P, V, U };
static const sph_prop props[] = {
    SPH_PROP("x", "m", "position; its first component matters", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_WRITE, 0),
    SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0),
};

/* Gas at one place. pi is p + p_inf throughout: in it the wave relations are those of an ideal gas. */
struct gas {
    double rho, v, pi;
};

/* One wave with the gas before it, seen so that the wave runs to the left: a right one is turned. */
struct wave {
    struct gas before, behind;
    double turn;       /* 1, or -1: the velocities here are -v */
    double head, tail; /* speeds; of a shock both are its own */
    int shock;
};

struct problem {
    struct wave left, right;
    double gamma, p_inf, x0;
};

static double sound(double gamma, const struct gas *g)
{
    return sqrt(gamma * g->pi / g->rho);
}

/* Behind a wave to the left into `g`, where pi is given: density and velocity [1, 2, 4]. */
static struct gas behind(double gamma, const struct gas *g, double pi)
{
    const double z = pi / g->pi;
    struct gas out = {0, 0, pi};

    if (z > 1) {
        const double nu = (gamma - 1) / (gamma + 1);
        const double specific = (1 + nu * z) / (z + nu) / g->rho; /* 1/rho behind the shock */
        out.rho = 1 / specific;
        out.v = g->v - sqrt((pi - g->pi) * (1 / g->rho - specific));
    } else {
        out.rho = g->rho * pow(z, 1 / gamma);
        out.v = g->v + 2 * sound(gamma, g) / (gamma - 1) * (1 - pow(z, (gamma - 1) / 2 / gamma));
    }
    return out;
}

/* How much faster the left gas runs than the right one where both have pi: falls as pi grows. */
static double closing(const struct problem *q, double pi)
{
    return behind(q->gamma, &q->left.before, pi).v + behind(q->gamma, &q->right.before, pi).v;
}

/* The pi at which both meet with one velocity [3]: a bracket, then the secant through its ends with
 * halved weights (Illinois), in log pi, where the function is nearly straight for strong waves. */
static sph_status meet(const struct problem *q, double *out)
{
    double a = log(q->left.before.pi), b = log(q->right.before.pi), x = a;
    if (a > b) {
        x = a;
        a = b;
        b = x;
    }
    while (closing(q, exp(a)) < 0 && a > -690)
        a -= 2;
    while (closing(q, exp(b)) > 0 && b < 690)
        b += 2;
    double fa = closing(q, exp(a)), fb = closing(q, exp(b));
    if (!(fa >= 0 && fb <= 0))
        return SPH_E_NUMERIC;
    for (int n = 0; n < 200 && b - a > 4e-16 * fmax(1, fabs(a)); n++) {
        x = fa == fb ? a : (a * fb - b * fa) / (fb - fa);
        if (!(x > a && x < b))
            x = 0.5 * (a + b);
        const double f = closing(q, exp(x));
        if (f == 0)
            break;
        if (f > 0) {
            a = x;
            fa = f;
            fb *= 0.5;
        } else {
            b = x;
            fb = f;
            fa *= 0.5;
        }
    }
    *out = exp(x);
    return SPH_OK;
}

/* The wave's speeds [5, 6]. */
static void finish(struct wave *w, double gamma, double pi)
{
    w->behind = behind(gamma, &w->before, pi);
    w->shock = pi > w->before.pi;
    if (w->shock) {
        const double flux = w->before.rho * w->before.v - w->behind.rho * w->behind.v;
        w->head = w->tail = flux / (w->before.rho - w->behind.rho);
    } else {
        w->head = w->before.v - sound(gamma, &w->before);
        w->tail = w->behind.v - sound(gamma, &w->behind);
    }
}

/* Left of the contact at speed s = (x - x0) / t, in the wave's own sense. */
static struct gas sample_wave(const struct wave *w, double gamma, double s)
{
    if (s <= w->head)
        return w->before;
    if (s >= w->tail)
        return w->behind;
    /* Inside the fan v - c = s, and v + 2 c / (gamma - 1) is the same on both sides [4]. */
    const double c0 = sound(gamma, &w->before);
    const double c = ((gamma - 1) * (w->before.v - s) + 2 * c0) / (gamma + 1);
    const double z = pow(c / c0, 2 * gamma / (gamma - 1));
    return (struct gas){w->before.rho * pow(z, 1 / gamma), s + c, w->before.pi * z};
}

static struct gas sample(const struct problem *q, double distance, double time)
{
    if (!(time > 0))
        return distance < 0
                   ? q->left.before
                   : (struct gas){q->right.before.rho, -q->right.before.v, q->right.before.pi};
    const double s = distance / time;
    const struct wave *w = s <= q->left.behind.v ? &q->left : &q->right;
    struct gas out = sample_wave(w, q->gamma, w->turn * s);
    out.v *= w->turn;
    return out;
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    double value[sizeof params / sizeof params[0]];
    double pi = 0;

    (void)dim;
    for (size_t i = 0; i < sizeof value / sizeof value[0]; i++)
        value[i] = host->param(c, params[i].name);
    struct problem q = {.gamma = value[GAMMA], .p_inf = value[P_INF], .x0 = value[X0]};
    q.left.before = (struct gas){value[RHO_L], value[V_L], value[P_L] + q.p_inf};
    q.right.before = (struct gas){value[RHO_R], -value[V_R], value[P_R] + q.p_inf};
    q.left.turn = 1;
    q.right.turn = -1;
    if (!(q.left.before.pi > 0) || !(q.right.before.pi > 0))
        return host->fail(host, SPH_E_INVALID,
                          "p_l and p_r must be greater than -p_inf: there the liquid tears");
    if (meet(&q, &pi) != SPH_OK)
        return host->fail(host, SPH_E_NUMERIC,
                          "v_r - v_l is so large that the two part: no pressure joins them");
    finish(&q.left, q.gamma, pi);
    finish(&q.right, q.gamma, pi);
    struct problem *kept = malloc(sizeof *kept);
    if (!kept)
        return SPH_E_NOMEM;
    *kept = q;
    *state = kept;
    return SPH_OK;
}

static void destroy(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}

/* A column that the comparison does not ask for is not there. */
static void put(const sph_column *column, uint32_t c, uint64_t i, double value)
{
    if (column->data)
        ((double *)column->data)[(size_t)c * column->plane + i] = value;
}

static sph_status run(const sph_batch *b)
{
    const struct problem *q = b->state;

    if (b->real != SPH_F64)
        return b->host->fail(b->host, SPH_E_UNKNOWN, "stiffened-riemann works in double precision");
    const double *x = b->dst[X].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        const struct gas g = sample(q, x[i] - q->x0, b->time);
        const double p = g.pi - q->p_inf;
        put(&b->dst[RHO], 0, i, g.rho);
        put(&b->dst[P], 0, i, p);
        put(&b->dst[U], 0, i, (p + q->gamma * q->p_inf) / ((q->gamma - 1) * g.rho));
        for (uint32_t c = 0; c < b->dim; c++)
            put(&b->dst[V], c, i, c == 0 ? g.v : 0);
    }
    return SPH_OK;
}

static const sph_life life = {
    .size = (uint32_t)sizeof(sph_life),
    .create = create,
    .destroy = destroy,
};

static const sph_item item = {
    .size = (uint32_t)sizeof(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "stiffened-riemann",
    .doc = "Riemann's problem of a stiffened gas along x",
    .source = "Menikoff & Plohr 1989, doi:10.1103/RevModPhys.61.75",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

static const sph_exact exact = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .life = &life,
    .run = run,
};

static sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_EXACT, &exact);
}

SPH_PLUGIN("stiffened-riemann", "0.1", "BSD-3-Clause", "exact shock tubes of a stiffened gas", init,
           NULL)
