/* planar_impact.c -- two half-spaces meet at x0 at time 0; a shock runs from the contact into each.
 * Rankine and Hugoniot's jumps, with a shock that runs at c + s up relative to what is ahead of it,
 * up the jump of velocity: M. A. Meyers, Dynamic Behavior of Materials (1994), chapters 4, 7,
 * doi:10.1002/9780470172278. Without strength, and until a wave comes back from a far side. */
#include "exact.h"

#include <stdlib.h>

static const sph_item item;

/* The defaults: aluminium on steel, with the constants of PySPH's examples. */
static const sph_param params[] = {
    SPH_PARAM("rho_l", "kg/m^d", "density at rest, left of x0", 2785, 1e-300, 1e300),
    SPH_PARAM("c_l", "m/s", "speed of sound at rest, left", 5328, 1e-300, 1e300),
    SPH_PARAM("s_l", "", "slope of the shock's speed, left", 1.338, 0, 100),
    SPH_PARAM("v_l", "m/s", "velocity, left", 3100, -1e300, 1e300),
    SPH_PARAM("rho_r", "kg/m^d", "density at rest, right of x0", 7900, 1e-300, 1e300),
    SPH_PARAM("c_r", "m/s", "speed of sound at rest, right", 4600, 1e-300, 1e300),
    SPH_PARAM("s_r", "", "slope of the shock's speed, right", 1.49, 0, 100),
    SPH_PARAM("v_r", "m/s", "velocity, right; less than v_l", 0, -1e300, 1e300),
    SPH_PARAM("x0", "m", "where the two meet", 0, -1e300, 1e300),
};

static const sph_prop props[] = {
    EXACT_X, EXACT_RHO, EXACT_P, EXACT_V, EXACT_U,
};

struct half {
    double rho, c, s, v; /* ahead of the shock */
    double up, shock;    /* jump of velocity, speed of the shock relative to what is ahead */
};

struct impact {
    struct half l, r;
    double x0, v; /* of the contact */
};

static double speed(const struct half *k, double up)
{
    return k->c + k->s * up;
}

/* Pressure of the right half less that of the left, if the contact moves with v. */
static double excess(const void *of, double v, double *derivative)
{
    const struct impact *m = of;
    const double l = m->l.v - v, r = v - m->r.v;

    *derivative = m->r.rho * (m->r.c + 2 * m->r.s * r) + m->l.rho * (m->l.c + 2 * m->l.s * l);
    return m->r.rho * speed(&m->r, r) * r - m->l.rho * speed(&m->l, l) * l;
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    struct impact m = {
        .l = {host->param(c, "rho_l"), host->param(c, "c_l"), host->param(c, "s_l"),
              host->param(c, "v_l"), 0, 0},
        .r = {host->param(c, "rho_r"), host->param(c, "c_r"), host->param(c, "s_r"),
              host->param(c, "v_r"), 0, 0},
        .x0 = host->param(c, "x0"),
    };

    (void)dim;
    if (!(m.l.v > m.r.v))
        return exact_fail(host, SPH_E_INVALID,
                          "the two do not meet: v_l, %g, must be above v_r, %g", m.l.v, m.r.v);
    m.v = exact_root(excess, &m, m.r.v, m.l.v);
    m.l.up = m.l.v - m.v;
    m.r.up = m.v - m.r.v;
    m.l.shock = speed(&m.l, m.l.up);
    m.r.shock = speed(&m.r, m.r.up);
    if (!(m.l.shock > m.l.up && m.r.shock > m.r.up))
        return exact_fail(host, SPH_E_INVALID,
                          "the shock would not run ahead of the contact: %s is too small for so "
                          "fast an impact",
                          m.l.shock > m.l.up ? "s_r" : "s_l");
    struct impact *kept = malloc(sizeof(*kept));
    if (!kept)
        return SPH_E_NOMEM;
    *kept = m;
    *state = kept;
    return SPH_OK;
}

struct moment {
    const struct impact *impact;
    double t;
};

static void at(const void *of, struct exact_point *q)
{
    const struct moment *m = of;
    const struct impact *i = m->impact;
    const double x = q->x[0] - i->x0;
    const int left = x < i->v * m->t;
    const struct half *k = left ? &i->l : &i->r;

    q->rho = k->rho;
    q->v[0] = k->v;
    if (left ? x < (k->v - k->shock) * m->t : x >= (k->v + k->shock) * m->t)
        return;
    q->rho = k->rho * k->shock / (k->shock - k->up);
    q->p = k->rho * k->shock * k->up;
    q->u = k->up * k->up / 2;
    q->v[0] = i->v;
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
    .name = "planar-impact",
    .doc = "two half-spaces meet along x, and a shock runs into each; u counts from the state at "
           "rest",
    .source = "Meyers 1994, doi:10.1002/9780470172278, chapters 4, 7",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_exact planar_impact = {
    .size = (uint32_t)sizeof(sph_exact),
    .item = &item,
    .life = &life,
    .run = run,
};
