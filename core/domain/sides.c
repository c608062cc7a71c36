/* domain/sides.c -- wraps particles at the sides of the domain and makes their ghosts. Touches the
 * particles' position and state columns, and what stands behind the real particles. */
#include "domain/sides.h"

#include "neighbours/neighbours.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- Wrapping ---------------------------------------------------------------------------------- */

static double wrap_periodic(double x, double min, double max)
{
    double length = max - min;

    x -= length * floor((x - min) / length);
    /* Rounding may leave it on the far side, or a hair before the near one. */
    return x < min || x >= max ? min : x;
}

/* Reflects x into the box; *flipped says whether the direction is turned. */
static double wrap_mirror(const struct box *box, int axis, double x, bool *flipped)
{
    double min = box->min[axis], max = box->max[axis], length = max - min;
    bool low = sides_mirror(box, axis, 0), high = sides_mirror(box, axis, 1);

    *flipped = false;
    if (low && high && (x < min || x > max)) {
        /* Both: the images repeat every two lengths, and every second one is turned. */
        double t = fmod(x - min, 2 * length);

        t = t < 0 ? t + 2 * length : t;
        *flipped = t > length;
        return *flipped ? fmin(fmax(max - (t - length), min), max) : min + t;
    }
    if ((low && x < min) || (high && x > max)) {
        *flipped = true;
        return 2 * (x < min ? min : max) - x;
    }
    return x;
}

bool sides_turn(uint32_t type, int dim, uint32_t k, int axis)
{
    /* Of a symmetric tensor, in the order xx, xy, xz, yy, yz, zz as present. */
    static const int row[4][6] = {{0}, {0}, {0, 0, 1}, {0, 0, 0, 1, 1, 2}};
    static const int column[4][6] = {{0}, {0}, {0, 1, 1}, {0, 1, 2, 1, 2, 2}};

    switch (type) {
    case SPH_VECTOR:
        return (int)k == axis;
    case SPH_SYM:
        return (row[dim][k] == axis) != (column[dim][k] == axis);
    case SPH_MATRIX:
        return ((int)k / dim == axis) != ((int)k % dim == axis);
    default:
        return false;
    }
}

/* The position, or what an integrator has kept of it ("x.0"): points, not directions. */
static bool is_position(const struct column *c)
{
    return c->name[0] == 'x' && (c->name[1] == '\0' || c->name[1] == '.');
}

/* Moves what an integrator has kept of the position as the position itself was moved. */
static void move_kept(struct particles *p, size_t i, int axis, double from, double to, bool flipped)
{
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];

        if (c->type == SPH_VECTOR && c->name[0] == 'x' && c->name[1] == '.') {
            double kept = column_get(c, (uint32_t)axis, i);

            column_set(c, (uint32_t)axis, i, flipped ? from + to - kept : kept + (to - from));
        }
    }
}

/* Turns what a mirror across `axis` turns, in every state column but the position. */
static void turn_state(struct particles *p, size_t i, int axis)
{
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];

        for (uint32_t q = 0; c->state && !is_position(c) && q < c->ncomp; q++) {
            if (sides_turn(c->type, p->dim, q, axis)) {
                column_set(c, q, i, -column_get(c, q, i));
            }
        }
    }
}

/* Brings particle i back along one axis; true if it moved. */
static bool wrap_axis(const struct box *box, struct particles *p, double *x, size_t i, int axis)
{
    double old = x[i];
    bool flipped = false;

    if (old >= box->min[axis] && old < box->max[axis]) {
        return false;
    }
    if (!isfinite(old)) {
        return false; /* the neighbour search names it */
    }
    x[i] = sides_periodic(box, axis) ? wrap_periodic(old, box->min[axis], box->max[axis])
                                     : wrap_mirror(box, axis, old, &flipped);
    move_kept(p, i, axis, old, x[i], flipped);
    if (flipped) {
        turn_state(p, i, axis);
    }
    return flipped || x[i] < old || x[i] > old;
}

size_t sides_wrap(const struct box *box, struct particles *p)
{
    size_t moved = 0;
    double *x[3];
    bool any = false;

    for (int a = 0; a < p->dim; a++) {
        x[a] = particles_real(p, "x", (uint32_t)a);
        any = any || sides_periodic(box, a) || sides_mirror(box, a, 0) || sides_mirror(box, a, 1);
    }
    if (!any || !x[0]) {
        return 0;
    }
    for (size_t i = 0; i < p->n; i++) {
        bool here = false;

        for (int a = 0; a < p->dim; a++) {
            here = wrap_axis(box, p, x[a], i, a) || here;
        }
        moved += here;
    }
    return moved;
}

/* -- Ghosts ------------------------------------------------------------------------------------ */

void ghosts_fini(struct ghosts *g)
{
    free(g->parent);
    free(g->image);
    memset(g, 0, sizeof *g);
}

/* One layer of images must be enough. Images of a pair of such sides repeat every length (two, for
 * mirrors, but then turned ones stand between), so the first layer that is missing begins a length
 * away: that must be out of reach. A particle may well see a neighbour and its image, or its own
 * image, when the length is less than twice the margin: that is what an endless row looks like. */
int sides_check_width(const struct box *box, int axis, double margin, const char *name,
                      struct error *e)
{
    double length = box->max[axis] - box->min[axis];
    bool pair =
        sides_periodic(box, axis) || (sides_mirror(box, axis, 0) && sides_mirror(box, axis, 1));

    if (pair && !(length >= margin)) {
        return error_set(e, EXIT_RUN,
                         "%s: the domain is %g wide along %c, between %s sides, but particles "
                         "reach as far as %g: use a larger box or a smaller smoothing length",
                         name, length, "xyz"[axis],
                         sides_periodic(box, axis) ? "periodic" : "mirror", margin);
    }
    return 0;
}

int ghosts_store(struct ghosts *g, struct store *s, size_t n, struct error *e)
{
    size_t parents = g->n, images = g->n;

    if (store_array(s, "parent", STORE_U32, &g->parent, &parents, 0, e) != 0 ||
        store_array(s, "image", STORE_U8, &g->image, &images, 0, e) != 0) {
        return -1;
    }
    g->n = parents;
    g->capacity = s->reading ? parents : g->capacity;
    for (size_t k = 0; s->reading && k < parents; k++) {
        if (images != parents || g->parent[k] >= n) {
            g->n = 0;
            return store_broken(s, e, "ghost %zu copies nothing", k);
        }
    }
    return 0;
}

int ghosts_reserve(struct ghosts *g, size_t n, struct error *e)
{
    size_t capacity = n + n / 8;
    uint32_t *parent;
    uint8_t *image;

    if (n <= g->capacity) {
        return 0;
    }
    parent = realloc(g->parent, capacity * sizeof *parent);
    if (!parent) {
        return error_memory(e, "ghosts", capacity * sizeof *parent);
    }
    g->parent = parent;
    image = realloc(g->image, capacity * sizeof *image);
    if (!image) {
        return error_memory(e, "ghosts", capacity * sizeof *image);
    }
    g->image = image;
    g->capacity = capacity;
    return 0;
}

/* Whether a coordinate is near enough to the side opposite to (periodic) or at (mirror) which its
 * image stands. */
static bool near_side(const struct box *box, int axis, unsigned image, double x, double margin)
{
    bool at_low = (image == IMAGE_LOW) != sides_periodic(box, axis);

    return (at_low ? x - box->min[axis] : box->max[axis] - x) < margin;
}

bool sides_has_image(const struct box *box, int axis, unsigned image)
{
    return sides_periodic(box, axis) || sides_mirror(box, axis, image == IMAGE_HIGH);
}

double sides_image(const struct box *box, int axis, unsigned image, double x)
{
    double min = box->min[axis], max = box->max[axis];

    if (sides_periodic(box, axis)) {
        return image == IMAGE_LOW ? x - (max - min) : x + (max - min);
    }
    return image == IMAGE_LOW ? 2 * min - x : 2 * max - x;
}

/* Appends the images across one side of all that stands there, ghosts of earlier axes included. */
static int add_layer(struct ghosts *g, const struct box *box, struct particles *p, int axis,
                     unsigned image, size_t present, double margin, struct error *e)
{
    double *x[3] = {0};
    size_t more = 0;

    x[axis] = particles_real(p, "x", (uint32_t)axis);
    for (size_t i = 0; i < present; i++) {
        more += near_side(box, axis, image, x[axis][i], margin);
    }
    if (more == 0) {
        return 0;
    }
    if (ghosts_reserve(g, g->n + more, e) != 0 || particles_resize(p, p->n, g->n + more, e) != 0) {
        return -1;
    }
    for (int a = 0; a < p->dim; a++) {
        x[a] = particles_real(p, "x", (uint32_t)a); /* after the resize, which moves them */
    }
    for (size_t i = 0; i < present; i++) {
        if (near_side(box, axis, image, x[axis][i], margin)) {
            bool real = i < p->n;
            uint32_t parent = real ? (uint32_t)i : g->parent[i - p->n];
            unsigned before = real ? 0 : g->image[i - p->n];

            g->parent[g->n] = parent;
            g->image[g->n] = (uint8_t)(before | image << 2 * axis);
            for (int a = 0; a < p->dim; a++) {
                x[a][p->n + g->n] = a == axis ? sides_image(box, axis, image, x[a][i]) : x[a][i];
            }
            g->n++;
        }
    }
    return 0;
}

/* Puts the ghosts into cell order, by their positions. Where those are no numbers they stay as they
 * are: the neighbour search names the particle. */
static int sort_ghosts(struct ghosts *g, const struct box *box, struct particles *p, double cell,
                       struct error *e)
{
    struct cloud cloud = {.dim = p->dim, .n = g->n};
    size_t bytes = g->n * (sizeof(uint32_t) + sizeof *g->parent + sizeof *g->image);
    uint32_t *order = malloc(bytes + 1), *parent = order + g->n;
    uint8_t *image = (uint8_t *)(parent + g->n);

    if (!order) {
        return error_memory(e, "the order of ghosts", bytes);
    }
    for (int a = 0; a < p->dim; a++) {
        cloud.x[a] = particles_real(p, "x", (uint32_t)a) + p->n;
    }
    if (cell_order(&cloud, NULL, cell, 1, order, NULL) == 0) {
        memcpy(parent, g->parent, g->n * sizeof *parent);
        memcpy(image, g->image, g->n * sizeof *image);
        for (size_t k = 0; k < g->n; k++) {
            g->parent[k] = parent[order[k]];
            g->image[k] = image[order[k]];
        }
        ghosts_refresh(g, box, p, particles_find(p, "x"));
    }
    free(order);
    return 0;
}

int ghosts_make(struct ghosts *g, const struct box *box, struct particles *p, double margin,
                struct error *e)
{
    int h = particles_find(p, "h");

    g->n = 0;
    if (particles_resize(p, p->n, 0, e) != 0) {
        return -1;
    }
    if (!particles_real(p, "x", 0)) {
        return error_set(e, EXIT_RUN, "%s has no positions", p->name);
    }
    for (int a = 0; a < p->dim && p->n > 0; a++) {
        size_t present = p->n + p->n_ghost;
        bool pair = sides_periodic(box, a);

        if (sides_check_width(box, a, margin, p->name, e) != 0) {
            return -1;
        }
        if ((pair || sides_mirror(box, a, 0)) &&
            add_layer(g, box, p, a, IMAGE_LOW, present, margin, e) != 0) {
            return -1;
        }
        if ((pair || sides_mirror(box, a, 1)) &&
            add_layer(g, box, p, a, IMAGE_HIGH, present, margin, e) != 0) {
            return -1;
        }
    }
    if (g->n > 0 && sort_ghosts(g, box, p, margin, e) != 0) {
        return -1;
    }
    if (h >= 0) {
        ghosts_refresh(g, box, p, h);
    }
    return 0;
}

/* The image bits that change the sign of component k. */
static unsigned turning_of(const struct box *box, int dim, const struct column *c, uint32_t k)
{
    unsigned turning = 0;

    for (int a = 0; a < dim; a++) {
        if (!sides_periodic(box, a) && sides_turn(c->type, dim, k, a)) {
            turning |= 3u << 2 * a;
        }
    }
    return turning;
}

/* A component of a tensor turns once for each of its two axes that is mirrored. */
static double turn(double value, unsigned turned)
{
    int times = ((turned & 3u) != 0) + ((turned & 12u) != 0) + ((turned & 48u) != 0);

    return times % 2 ? -value : value;
}

double sides_value(const struct box *box, int dim, const struct column *c, uint32_t k,
                   unsigned code, double value)
{
    if (strcmp(c->name, "x") == 0) {
        code = code >> 2 * k & 3u;
        return code ? sides_image(box, (int)k, code, value) : value;
    }
    return turn(value, code & turning_of(box, dim, c, k));
}

unsigned sides_changing(const struct box *box, int dim, const struct column *c, uint32_t k)
{
    return strcmp(c->name, "x") == 0 ? 3u << 2 * k : turning_of(box, dim, c, k);
}

static void copy_parents(char *plane, size_t size, const struct ghosts *g, size_t n)
{
    if (size == sizeof(double)) {
        for (size_t q = 0; q < g->n; q++) {
            memcpy(plane + 8 * (n + q), plane + 8 * (size_t)g->parent[q], 8);
        }
    } else {
        for (size_t q = 0; q < g->n; q++) {
            memcpy(plane + 4 * (n + q), plane + 4 * (size_t)g->parent[q], 4);
        }
    }
}

/* Component k of a real column; what an image is: a position shifts, a direction turns. Most are as their
 * parents are. */
static void refresh_real(const struct ghosts *g, const struct box *box, struct particles *p,
                         const struct column *c, uint32_t k)
{
    const unsigned changing = sides_changing(box, p->dim, c, k);

    copy_parents((char *)c->data + k * c->plane * c->size, c->size, g, p->n);
    if (c->low) {
        copy_parents((char *)(c->low + k * c->plane), sizeof *c->low, g, p->n);
    }
    for (size_t q = 0; changing && q < g->n; q++) {
        if (g->image[q] & changing) {
            column_set(c, k, p->n + q,
                       sides_value(box, p->dim, c, k, g->image[q], column_get(c, k, g->parent[q])));
        }
    }
}

void ghosts_refresh(const struct ghosts *g, const struct box *box, struct particles *p, int c)
{
    const struct column *column = &p->column[c];

    if (column->type == SPH_INT32) {
        int32_t *x = column->data;

        for (size_t q = 0; q < g->n; q++) {
            x[p->n + q] = x[g->parent[q]];
        }
    } else if (column->type == SPH_INT64) {
        int64_t *x = column->data;

        for (size_t q = 0; q < g->n; q++) {
            x[p->n + q] = x[g->parent[q]];
        }
    } else {
        for (uint32_t k = 0; k < column->ncomp; k++) {
            refresh_real(g, box, p, column, k);
        }
    }
}
