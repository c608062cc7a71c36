/* scene/fill_region.c -- regions and the lattices that fill them. Pure geometry: knows shapes
 * and the domain, no columns. */
#include "scene/expression.h"
#include "scene/fill_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- Regions --------------------------------------------------------------------------------- */

bool region_holds(const struct region *r, const double x[3])
{
    return !r->shape || shape_inside(r->shape, x);
}

/* Of the shape within its bounds, by a fine grid of samples. */
static double sampled_volume(const struct region *r)
{
    static const size_t samples[] = {0, 65536, 1024, 128};
    size_t side = samples[r->dim], total = 1, inside = 0;
    double volume = 1;
    for (int i = 0; i < r->dim; i++) {
        total *= side;
        volume *= r->max[i] - r->min[i];
    }
    for (size_t k = 0; k < total; k++) {
        double x[3] = {0, 0, 0};
        size_t rest = k;
        for (int i = 0; i < r->dim; i++, rest /= side)
            x[i] =
                r->min[i] + (r->max[i] - r->min[i]) * ((double)(rest % side) + .5) / (double)side;
        inside += region_holds(r, x);
    }
    return volume * (double)inside / (double)total;
}

int region_init(struct region *r, const struct scene *s, const struct scene_fill *f,
                struct error *e)
{
    *r = (struct region){.dim = s->dim, .shape = f->shape, .volume = 1};
    for (int i = 0; i < s->dim; i++) {
        r->min[i] = s->box.min[i];
        r->max[i] = s->box.max[i];
    }
    if (f->shape) {
        double min[3], max[3];
        shape_bounds(f->shape, min, max);
        for (int i = 0; i < s->dim; i++) { /* the domain bounds what the shape leaves open */
            r->min[i] = isfinite(min[i]) ? min[i] : s->box.min[i];
            r->max[i] = isfinite(max[i]) ? max[i] : s->box.max[i];
        }
    }
    for (int i = 0; i < s->dim; i++) {
        r->volume *= r->max[i] - r->min[i];
        if (!(r->min[i] < r->max[i]))
            return document_fail(s->doc, json_get(f->node, "in"), e,
                                 "there are no particles inside this shape: it is empty along %c",
                                 "xyz"[i]);
    }
    if (r->shape && !shape_is_box(r->shape))
        r->volume = sampled_volume(r);
    if (!(r->volume > 0))
        return document_fail(s->doc, json_get(f->node, "in"), e,
                             "there are no particles inside this shape: it is empty");
    return 0;
}

/* -- Lattices -------------------------------------------------------------------------------- */

/* The points of a cell. Each set is centred, so that a lattice in a box keeps the same distance
 * from opposite faces. */
static const double basis_square[1][3] = {{.5, .5, .5}};
static const double basis_hexagonal[2][3] = {{.25, .25, .5}, {.75, .75, .5}};
static const double basis_hcp[4][3] = {
    {.25, 1. / 6, .25}, {.75, 2. / 3, .25}, {.75, 1. / 3, .75}, {.25, 5. / 6, .75}};
static const double basis_bcc[2][3] = {{.25, .25, .25}, {.75, .75, .75}};
static const double basis_fcc[4][3] = {
    {.25, .25, .25}, {.75, .75, .25}, {.75, .25, .75}, {.25, .75, .75}};

/* Cell edges for a volume of 1 per particle, and the cell's points. */
static void cell_of(enum lattice lattice, int dim, struct grid *g, double edge[3])
{
    edge[0] = edge[1] = edge[2] = 1;
    g->basis = basis_square;
    g->n_basis = 1;
    if (lattice == LATTICE_HEXAGONAL && dim == 2) {
        edge[0] = sqrt(2 / sqrt(3));
        edge[1] = edge[0] * sqrt(3);
        g->basis = basis_hexagonal;
        g->n_basis = 2;
    } else if (lattice == LATTICE_HEXAGONAL && dim == 3) { /* a^3 / sqrt 2 a particle */
        edge[0] = pow(2, 1. / 6);
        edge[1] = edge[0] * sqrt(3);
        edge[2] = edge[0] * sqrt(8. / 3);
        g->basis = basis_hcp;
        g->n_basis = 4;
    } else if (lattice == LATTICE_BCC) {
        edge[0] = edge[1] = edge[2] = cbrt(2);
        g->basis = basis_bcc;
        g->n_basis = 2;
    } else if (lattice == LATTICE_FCC) {
        edge[0] = edge[1] = edge[2] = cbrt(4);
        g->basis = basis_fcc;
        g->n_basis = 4;
    }
}

/* Where a fill says how fine it is, for messages. */
static const cJSON *size_node(const struct scene_fill *f)
{
    static const char *const keys[] = {"spacing", "count", "mass"};
    for (size_t i = 0; i < 3; i++)
        if (json_get(f->node, keys[i]))
            return json_get(f->node, keys[i]);
    return f->node;
}

int grid_init(struct grid *g, const struct scene *s, const struct scene_fill *f,
              const struct region *r, double spacing, struct error *e)
{
    double edge[3], cells = 1, volume = 1;
    *g = (struct grid){.dim = r->dim, .n = {1, 1, 1}};
    cell_of(f->lattice, r->dim, g, edge);
    for (int i = 0; i < r->dim; i++) {
        double width = r->max[i] - r->min[i], n = round(width / (edge[i] * spacing));
        g->min[i] = r->min[i];
        g->max[i] = r->max[i];
        if (n < 1)
            return document_fail(
                s->doc, size_node(f), e,
                "a spacing of %.4g is too coarse: the region is %.4g wide along %c", spacing, width,
                "xyz"[i]);
        cells *= n;
        volume *= width;
        g->n[i] = n < 9e15 ? (uint64_t)n : (uint64_t)9e15;
    }
    g->volume = volume / (cells * g->n_basis);
    return 0;
}

double grid_total(const struct grid *g)
{
    return (double)g->n[0] * (double)g->n[1] * (double)g->n[2] * g->n_basis;
}

void grid_point(const struct grid *g, uint64_t index, double x[3])
{
    const double *point = g->basis[index % (uint64_t)g->n_basis];
    index /= (uint64_t)g->n_basis;
    for (int i = 0; i < 3; i++) {
        if (i >= g->dim) {
            x[i] = 0;
            continue;
        }
        /* Weighted so that mirrored points of a mirrored box come out mirrored in the last bit. */
        double n = (double)g->n[i], t = (double)(index % g->n[i]) + point[i];
        x[i] = (g->min[i] * (n - t) + g->max[i] * t) / n;
        index /= g->n[i];
    }
}

/* -- Sizes ----------------------------------------------------------------------------------- */

/* "rho" must be one number within the region. */
static int constant_density(const struct scene *s, size_t a, size_t k, const struct region *r,
                            double *rho, struct error *e)
{
    enum { SIDE = 9, TOTAL = SIDE * SIDE * SIDE };
    const struct scene_array *array = &s->array[a];
    const struct scene_fill *f = &array->fill[k];
    const struct scene_field *field = fill_field(array, k, "rho");
    double x[3][TOTAL], spacing[TOTAL], value[TOTAL];
    const double *const at[3] = {x[0], x[1], x[2]};
    if (!field)
        return document_fail(s->doc, size_node(f), e,
                             "particles of equal mass need the field \"rho\" for their spacing");
    size_t n = 0;
    for (size_t i = 0; i < TOTAL; i++) {
        size_t index[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        double point[3] = {0, 0, 0};
        for (int c = 0; c < r->dim; c++)
            point[c] = r->min[c] + (r->max[c] - r->min[c]) * ((double)index[c] + .5) / SIDE;
        if (!region_holds(r, point) || (r->dim < 3 && index[2]) || (r->dim < 2 && index[1]))
            continue;
        for (int c = 0; c < 3; c++)
            x[c][n] = point[c];
        spacing[n++] = 1;
    }
    if (!n) { /* a thin shape: anywhere will do */
        for (int c = 0; c < 3; c++)
            x[c][0] = c < r->dim ? .5 * (r->min[c] + r->max[c]) : 0;
        spacing[n++] = 1;
    }
    if (field_values(s, "rho", field->node, 0, at, spacing, n, value, e) < 0)
        return -1;
    *rho = value[0];
    for (size_t i = 0; i < n; i++) {
        if (!(value[i] > 0))
            return document_fail(s->doc, field->node, e, "the density is %.6g; give a positive one",
                                 value[i]);
        if (fabs(value[i] - *rho) > 1e-9 * *rho)
            return document_fail(s->doc, size_node(f), e,
                                 "\"rho\" varies within this fill (%.6g, %.6g); "
                                 "equal masses need one fill a density",
                                 *rho, value[i]);
    }
    return 0;
}

int fill_spacing(const struct scene *s, size_t a, size_t k, const struct region *r, double *spacing,
                 struct error *e)
{
    const struct scene_fill *f = &s->array[a].fill[k];
    double volume = 0, rho = 0;
    if (f->spacing > 0) {
        *spacing = f->spacing;
        return 0;
    }
    if (f->count) {
        volume = r->volume / (double)f->count;
    } else {
        if (constant_density(s, a, k, r, &rho, e) < 0)
            return -1;
        volume = f->mass / rho;
    }
    *spacing = pow(volume, 1. / r->dim);
    return 0;
}

/* The least that a particle takes: its columns and its part of the neighbour lists. */
#define BYTES_PER_PARTICLE 300.

int fill_guard(const struct scene *s, const struct scene_fill *f, double n, struct error *e)
{
    if (n <= (double)s->limit)
        return 0;
    return document_fail(
        s->doc, size_node(f), e,
        "this would make %.4g particles, some %.3g GiB; the limit is %.4g (for more, "
        "give \"limits\": {\"particles\": %.0f})",
        n, n * BYTES_PER_PARTICLE / 1073741824., (double)s->limit, ceil(n));
}

/* -- Points ---------------------------------------------------------------------------------- */

int points_add(struct points *q, const double x[3], double spacing, struct error *e)
{
    if (q->n == q->capacity) {
        size_t capacity = q->capacity ? 2 * q->capacity : 1024;
        size_t bytes = capacity * (size_t)q->dim * sizeof(double);
        double *grown = realloc(q->x, bytes);
        if (grown)
            q->x = grown;
        double *wider = grown ? realloc(q->spacing, capacity * sizeof(double)) : NULL;
        if (!wider)
            return error_memory(e, "particles", bytes);
        q->spacing = wider;
        q->capacity = capacity;
    }
    memcpy(q->x + q->n * (size_t)q->dim, x, (size_t)q->dim * sizeof(double));
    q->spacing[q->n++] = spacing;
    return 0;
}

void points_fini(struct points *q)
{
    free(q->x);
    free(q->spacing);
    *q = (struct points){0};
}
