/* motion.c -- where the piston is at a given time: at constant speed, or along the table "path". */
#include <math.h>
#include <stdlib.h>

#include "piston.h"

struct path {
    struct motion now;      /* at the time of the pass */
    const sph_table *table; /* NULL: the speed is constant */
    const double *t, *v;
};

static sph_status check(const sph_host *host, const struct path *p)
{
    if (!p->t || !p->v)
        return host->fail(host, SPH_E_INVALID, "path needs two columns, t and v");
    for (uint64_t i = 1; i < p->table->n_rows; i++)
        if (!(p->t[i] > p->t[i - 1]))
            return host->fail(host, SPH_E_INVALID, "t of path must rise from row to row");
    return SPH_OK;
}

static sph_status create(const sph_host *host, const sph_config *c, uint32_t dim, void **state)
{
    const sph_tables *tables = host->extension(host, SPH_EXT_TABLES);
    struct path p = {.table = tables ? tables->get(c, "path") : NULL};

    (void)dim;
    if (!tables)
        return host->fail(host, SPH_E_UNKNOWN, "this sph has no tables, which \"path\" needs");
    if (p.table) {
        p.t = sph_table_column(p.table, "t");
        p.v = sph_table_column(p.table, "v");
        const sph_status status = check(host, &p);
        if (status != SPH_OK)
            return status;
    }
    struct path *kept = malloc(sizeof *kept);
    if (!kept)
        return SPH_E_NOMEM;
    *kept = p;
    *state = kept;
    return SPH_OK;
}

static void destroy(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}

const sph_life piston_life = {.size = SIZE(sph_life), .create = create, .destroy = destroy};

/* Way from the first row to `time`, and what goes with it. Beyond the ends the speed is the end's. */
static struct motion along(const struct path *p, double time)
{
    const uint64_t last = p->table->n_rows - 1;
    struct motion m = {0, p->v[0], 0};

    if (time < p->t[0])
        return (struct motion){p->v[0] * (time - p->t[0]), p->v[0], 0};
    for (uint64_t i = 0; i < last && time > p->t[i]; i++) {
        const double dt = p->t[i + 1] - p->t[i];
        const double slope = (p->v[i + 1] - p->v[i]) / dt;
        const double s = fmin(time - p->t[i], dt);
        m.way += s * (p->v[i] + 0.5 * slope * s);
        m.speed = p->v[i] + slope * s;
        m.acceleration = s < dt ? slope : 0;
    }
    if (time >= p->t[last]) {
        m.way += (time - p->t[last]) * p->v[last];
        m.speed = p->v[last];
        m.acceleration = 0;
    }
    return m;
}

sph_status piston_prepare(const sph_batch *b)
{
    struct path *p = b->state;

    if (p->table) {
        p->now = along(p, b->time);
        p->now.way -= along(p, 0).way;
    } else {
        p->now = (struct motion){b->param[SPEED] * b->time, b->param[SPEED], 0};
    }
    return SPH_OK;
}
