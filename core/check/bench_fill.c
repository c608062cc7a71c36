/* check/bench_fill.c -- positions and values of a bench's particles: random but the same each time,
 * and physical as far as names tell: what a scene knows by name (x, h, m) and the usual names of a
 * gas are given values that fit each other; others are near their declared initial value, or 1. */
#include "check/bench.h"

#include "scene/random.h"

#include <math.h>
#include <string.h>

#define SPACING 0.1
#define JITTER 0.15

/* Cells of the lattice along each axis: for 1000 particles a box that is as long as it can be. */
static void cells(const struct bench_shape *shape, size_t out[3])
{
    static const size_t thousand[4][3] = {{1, 1, 1}, {1000, 1, 1}, {40, 25, 1}, {10, 10, 10}};
    const size_t side = shape->dim == 3 ? 2 : 3;

    if (shape->n == 1000) {
        memcpy(out, thousand[shape->dim], sizeof(thousand[0]));
        return;
    }
    out[0] = shape->dim == 1 ? shape->n + 1 : side;
    out[1] = shape->dim < 2 ? 1 : shape->dim == 2 ? shape->n / side + 1 : side;
    out[2] = shape->dim < 3 ? 1 : shape->n / (side * side) + 1;
}

static double jitter(struct random *random, double most)
{
    return most * (2 * random_unit(random) - 1);
}

static double *plane(const struct particles *p, int column, uint32_t c)
{
    return (double *)p->column[column].data + c * p->column[column].plane;
}

static void place(struct bench *b, struct particles *p, struct random *random, double offset,
                  double spread)
{
    size_t n[3];

    cells(&b->shape, n);
    for (size_t i = 0; i < p->n; i++) {
        const size_t at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
        for (int c = 0; c < b->shape.dim; c++)
            plane(p, b->x, (uint32_t)c)[i] =
                b->box.min[c] +
                spread * b->spacing * ((double)at[c] + offset + jitter(random, JITTER / spread));
    }
}

void bench_place(struct bench *b)
{
    const double spread = b->shape.layout == LAYOUT_ALONE ? 1000 : 1;
    struct random random;
    size_t n[3];
    double narrowest = INFINITY;

    random_init(&random, 1);
    b->spacing = SPACING;
    cells(&b->shape, n);
    b->box.dim = b->shape.dim;
    b->box.bounded = b->shape.layout == LAYOUT_REGULAR;
    for (int c = 0; c < b->shape.dim; c++) {
        const double length = (double)n[c] * b->spacing;
        b->box.min[c] = -0.5 * length + b->shape.shift * length;
        b->box.max[c] = 0.5 * length + b->shape.shift * length;
        narrowest = fmin(narrowest, length);
        b->box.side[c][0] = b->box.side[c][1] = b->box.bounded ? SIDE_PERIODIC : SIDE_OPEN;
    }
    if (b->x < 0)
        return;
    place(b, &b->own, &random, 0.5, spread);
    place(b, &b->other, &random, b->shape.layout == LAYOUT_ALONE ? 0.75 : 1.0, spread);
    if (b->h < 0)
        return;
    for (int k = 0; k < 2; k++) {
        const struct particles *p = k ? &b->other : &b->own;
        for (size_t i = 0; i < p->n; i++) {
            double h = 1.3 * b->spacing * (1 + jitter(&random, 0.05));
            if (b->box.bounded) /* one layer of images must do, also when h grows */
                h = fmin(h, 0.45 * narrowest / b->support);
            plane(p, b->h, 0)[i] = h;
        }
    }
}

/* -- Values -------- */

static bool is(const struct column *c, const char *name, uint32_t type)
{
    return c->type == type && strcmp(c->name, name) == 0;
}

/* A gas of pressure and density near 1; the rest follows from them. */
static bool known(const struct bench *b, const struct column *c, size_t n, double *value,
                  struct random *random)
{
    const bool rho = is(c, "rho", SPH_SCALAR), p = is(c, "p", SPH_SCALAR);
    const bool m = is(c, "m", SPH_SCALAR), cs = is(c, "cs", SPH_SCALAR);
    const bool u = is(c, "u", SPH_SCALAR);

    if (!rho && !p && !m && !cs && !u)
        return false;
    for (size_t i = 0; i < n; i++) {
        const double noise = 1 + jitter(random, 0.02);
        value[i] = noise * (m ? pow(b->spacing, b->shape.dim) : cs ? sqrt(5. / 3) : u ? 1.5 : 1);
    }
    return true;
}

static void chosen(const struct setting *s, const struct column *c, double *value, size_t n,
                   struct random *random)
{
    (void)c;
    for (size_t i = 0; i < n; i++)
        value[i] = s->low + (s->high - s->low) * random_unit(random);
}

static void generic(const sph_prop *prop, const struct column *c, double *value, size_t n,
                    struct random *random)
{
    const double start = isfinite(prop->start) ? prop->start : c->type == SPH_SCALAR ? 1 : 0;
    const double width = 0.1 * fmax(fabs(start), 1);

    for (size_t i = 0; i < n; i++)
        value[i] =
            start + (c->type == SPH_SCALAR ? width * random_unit(random) : jitter(random, width));
}

static void integers(const struct bench *b, struct column *c, size_t n)
{
    const bool ones = b->spec->ones && strcmp(c->name, b->spec->ones) == 0;

    for (size_t i = 0; i < n; i++)
        if (c->type == SPH_INT32)
            ((int32_t *)c->data)[i] = ones;
        else
            ((int64_t *)c->data)[i] = (int64_t)i;
}

static void fill_column(struct bench *b, struct particles *p, int column, const sph_prop *prop,
                        struct random *random)
{
    struct column *c = &p->column[column];
    const struct setting *setting = subject_setting(b->subject, c->name);

    if (column == b->x || column == b->h)
        return;
    if (c->type == SPH_INT32 || c->type == SPH_INT64) {
        integers(b, c, p->n);
        return;
    }
    for (uint32_t k = 0; k < c->ncomp; k++) {
        double *value = plane(p, column, k);
        if (setting && !isnan(setting->low))
            chosen(setting, c, value, p->n, random);
        else if (!known(b, c, p->n, value, random))
            generic(prop, c, value, p->n, random);
    }
}

void bench_values(struct bench *b)
{
    struct random random;

    random_init(&random, 2);
    for (uint32_t k = 0; k < bench_count(b); k++) {
        if (b->own_column[k] >= 0)
            fill_column(b, &b->own, b->own_column[k], bench_prop(b, k), &random);
        if (b->other_column[k] >= 0)
            fill_column(b, &b->other, b->other_column[k], bench_prop(b, k), &random);
    }
}
