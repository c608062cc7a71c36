/* opencl/ops_sides.c -- on a device: particles that have left the domain, and ghosts, as domain/sides.c has
 * them. */
#include "opencl/ops_private.h"

#include <stdlib.h>
#include <string.h>

/* As in ops_sides.cl, read there byte for byte. */
enum { OPEN, PERIODIC, MIRROR };
struct sides {
    double min[4], max[4];
    uint32_t low[4], high[4];
};
#define IMAGE_LOW 1u
#define IMAGE_HIGH 2u
#define SHARE 64u

static struct sides sides_of(const struct ops *o, const struct box *box)
{
    struct sides s = {{0}, {0}, {0}, {0}};
    for (int c = 0; box->bounded && c < o->dim; c++) {
        s.min[c] = box->min[c];
        s.max[c] = box->max[c];
        s.low[c] = sides_periodic(box, c) ? PERIODIC : sides_mirror(box, c, 0) ? MIRROR : OPEN;
        s.high[c] = sides_periodic(box, c) ? PERIODIC : sides_mirror(box, c, 1) ? MIRROR : OPEN;
    }
    return s;
}

int ops_put_sides(struct ops *o, const struct box *box, struct error *e)
{
    const struct sides s = sides_of(o, box);
    if (o->sides.mem && o->box && memcmp(o->box, &s, sizeof s) == 0)
        return 0;
    if (!o->box)
        o->box = malloc(sizeof s);
    if (!o->box)
        return error_memory(e, "the domain", sizeof s);
    memcpy(o->box, &s, sizeof s);
    if (!device_reserve(o->d, &o->sides, sizeof s, "domain", e) &&
        !device_write(o->d, &o->sides, 0, &s, sizeof s, e))
        return 0;
    free(o->box); /* not there */
    o->box = NULL;
    return -1;
}

static int find_position(const struct arena *a, struct error *e)
{
    const int x = particles_find(a->p, "x");
    return x >= 0 && a->place[x].size == 8
               ? x
               : error_set(e, EXIT_RUN, "%s has no positions", a->p->name);
}

/* -- Wrapping -------- */

/* The position, or what an integrator has kept of it ("x.0"): points, not directions. */
static bool is_kept(const struct column *c)
{
    return c->type == SPH_VECTOR && c->name[0] == 'x' && c->name[1] == '.';
}

/* Axes whose mirrors turn component k, a bit each. */
static uint32_t turning_axes(const struct column *c, int dim, uint32_t k)
{
    uint32_t axes = 0;
    for (int axis = 0; axis < dim; axis++)
        axes |= (uint32_t)sides_turn(c->type, dim, k, axis) << axis;
    return axes;
}

struct wrapping {
    uint32_t *table; /* see wrap_axis in ops_sides.cl */
    uint32_t n_kept, n_turned;
};

static void list_kept(struct wrapping *w, struct arena *a)
{
    for (size_t c = 0; c < a->p->n_column; c++)
        if (is_kept(&a->p->column[c])) {
            w->table[w->n_kept++] = ops_slot(a, (int)c);
            arena_written_here(a, (int)c);
        }
}

static void list_turned(struct wrapping *w, struct arena *a)
{
    uint32_t *to = w->table + w->n_kept;
    for (size_t c = 0; c < a->p->n_column; c++) {
        const struct column *column = &a->p->column[c];
        const bool position = column->name[0] == 'x' && //
                              (column->name[1] == '\0' || column->name[1] == '.');
        for (uint32_t k = 0; column->state && !position && k < column->ncomp; k++) {
            const uint32_t axes = turning_axes(column, a->p->dim, k);
            if (!axes)
                continue;
            *to++ = ops_slot(a, (int)c) + k;
            *to++ = axes;
            w->n_turned++;
            arena_written_here(a, (int)c);
        }
    }
}

/* All that is moved or turned is here. */
static int bring(struct arena *a, struct error *e)
{
    for (size_t c = 0; c < a->p->n_column; c++)
        if ((a->p->column[c].state || is_kept(&a->p->column[c])) && ops_bring(a, (int)c, e))
            return -1;
    return 0;
}

/* The table is there; already, unless it is another one. */
static int put_table(struct ops *o, struct arena *a, struct wrapping *w, struct error *e)
{
    const size_t most = 1 + 2 * (size_t)(a->n_wide + a->n_narrow), bytes = most * sizeof *w->table;
    w->table = calloc(most, sizeof *w->table);
    if (!w->table)
        return error_memory(e, "the sides of the domain", bytes);
    list_kept(w, a);
    list_turned(w, a);
    if (o->turned_bytes == bytes && memcmp(o->turned, w->table, bytes) == 0) {
        free(w->table);
        return 0;
    }
    free(o->turned);
    o->turned = w->table;
    o->turned_bytes = 0; /* until it is there */
    if (device_reserve(o->d, &o->table, bytes, "sides", e) ||
        device_write(o->d, &o->table, 0, w->table, bytes, e))
        return -1;
    o->turned_bytes = bytes;
    return 0;
}

int ops_need_sides(struct ops *o, const struct box *box, struct error *e)
{
    const struct sides s = sides_of(o, box);
    uint32_t any = 0;
    for (int c = 0; c < o->dim; c++)
        any |= s.low[c] | s.high[c];
    return any ? ops_build(o, K_WRAP, e) : 0;
}

int ops_wrap(struct ops *o, struct arena *a, const struct box *box, size_t *moved, struct error *e)
{
    const struct sides s = sides_of(o, box);
    const uint64_t plane = a->plane, n = a->n;
    const size_t at = offsetof(struct ops_words, moved);
    struct wrapping w = {0};
    uint32_t count = 0, any = 0;
    if (moved)
        *moved = 0;
    for (int c = 0; c < o->dim; c++)
        any |= s.low[c] | s.high[c];
    if (!any || n == 0)
        return 0;
    const int x = find_position(a, e);
    if (x < 0 || bring(a, e) || ops_put_sides(o, box, e) || put_table(o, a, &w, e))
        return -1;
    const uint32_t position = ops_slot(a, x);
    if ((moved && device_fill(o->d, &o->words, at, 0, sizeof count, e)) ||
        OPS_LAUNCH(o, K_WRAP, n, e, DEVICE_BUFFER(&a->wide), DEVICE_BUFFER(&a->narrow),
                   DEVICE_VALUE(plane), DEVICE_VALUE(position), DEVICE_BUFFER(&o->sides),
                   DEVICE_BUFFER(&o->table), DEVICE_VALUE(w.n_kept), DEVICE_VALUE(w.n_turned),
                   DEVICE_VALUE(n), DEVICE_BUFFER(&o->words)))
        return -1;
    arena_written_here(a, x);
    if (moved && device_read(o->d, &o->words, at, &count, sizeof count, e))
        return -1;
    if (moved)
        *moved = count;
    return 0;
}

/* -- Ghosts -------- */

/* Room for n; the first g->n are kept. */
static int reserve(struct ops *o, struct ops_ghosts *g, size_t n, struct error *e)
{
    struct device_buffer parent = {0}, image = {0};
    const size_t most = n + n / 8;
    if (g->parent.mem && g->image.mem && n * sizeof(uint32_t) <= g->parent.bytes &&
        n <= g->image.bytes)
        return 0;
    if (device_reserve(o->d, &parent, most * sizeof(uint32_t), "ghosts", e) ||
        device_reserve(o->d, &image, most, "ghosts", e) ||
        device_copy(o->d, &parent, 0, &g->parent, 0, g->n * sizeof(uint32_t), e) ||
        device_copy(o->d, &image, 0, &g->image, 0, g->n, e)) {
        device_release(o->d, &parent);
        device_release(o->d, &image);
        return -1;
    }
    device_release(o->d, &g->parent);
    device_release(o->d, &g->image);
    g->parent = parent;
    g->image = image;
    return 0;
}

void ops_ghosts_release(struct ops *o, struct ops_ghosts *g)
{
    device_release(o->d, &g->parent);
    device_release(o->d, &g->image);
    g->n = 0;
}

/* An axis's images of all that stands there, ghosts of earlier axes included. */
static int add_layers(struct ops *o, struct arena *a, struct ops_ghosts *g, int x, uint32_t axis,
                      uint32_t images, double margin, struct error *e)
{
    const uint64_t n = a->n, present = n + g->n;
    const uint32_t position = ops_slot(a, x), shares = (uint32_t)((present + SHARE - 1) / SHARE);
    const uint32_t counts = 2 * shares;
    uint64_t plane = a->plane;
    uint32_t more = 0;
    if (device_reserve(o->d, &o->count, (counts + (size_t)1) * sizeof more, "ghosts", e) ||
        OPS_LAUNCH(o, K_GHOSTS_COUNT, shares, e, DEVICE_BUFFER(&a->wide), DEVICE_VALUE(plane),
                   DEVICE_VALUE(position), DEVICE_BUFFER(&o->sides), DEVICE_VALUE(axis),
                   DEVICE_VALUE(images), DEVICE_VALUE(margin), DEVICE_VALUE(present),
                   DEVICE_VALUE(shares), DEVICE_BUFFER(&o->count)) ||
        OPS_LAUNCH(o, K_SCAN, 1, e, DEVICE_BUFFER(&o->count), DEVICE_VALUE(counts)) ||
        device_read(o->d, &o->count, counts * sizeof more, &more, sizeof more, e))
        return -1;
    if (more == 0)
        return 0;
    if (reserve(o, g, g->n + more, e) || arena_resize(a, a->n, g->n + more, e))
        return -1;
    plane = a->plane;
    if (OPS_LAUNCH(o, K_GHOSTS_FILL, shares, e, DEVICE_BUFFER(&a->wide), DEVICE_VALUE(plane),
                   DEVICE_VALUE(position), DEVICE_BUFFER(&o->sides), DEVICE_VALUE(axis),
                   DEVICE_VALUE(images), DEVICE_VALUE(margin), DEVICE_VALUE(present),
                   DEVICE_VALUE(shares), DEVICE_BUFFER(&o->count), DEVICE_VALUE(n),
                   DEVICE_BUFFER(&g->parent), DEVICE_BUFFER(&g->image)))
        return -1;
    g->n += more;
    return 0;
}

int ops_ghosts_make(struct ops *o, struct arena *a, struct ops_ghosts *g, const struct box *box,
                    double margin, struct error *e)
{
    const int x = find_position(a, e), h = particles_find(a->p, "h");
    g->n = 0;
    if (x < 0 || arena_resize(a, a->n, 0, e) || ops_bring(a, x, e) || ops_put_sides(o, box, e))
        return -1;
    for (int axis = 0; axis < o->dim && a->n > 0; axis++) {
        const bool pair = sides_periodic(box, axis);
        const uint32_t images = (pair || sides_mirror(box, axis, 0) ? IMAGE_LOW : 0u) |
                                (pair || sides_mirror(box, axis, 1) ? IMAGE_HIGH : 0u);
        if (sides_check_width(box, axis, margin, a->p->name, e) ||
            (images && add_layers(o, a, g, x, (uint32_t)axis, images, margin, e)))
            return -1;
    }
    if (h < 0)
        return 0;
    return ops_bring(a, h, e) ? -1 : ops_ghosts_refresh(o, a, g, box, h, e);
}

/* -- Their columns -------- */

void ops_turning(const struct box *box, const struct column *c, int dim, uint64_t turning[2])
{
    turning[0] = turning[1] = 0;
    for (uint32_t k = 0; k < c->ncomp; k++)
        for (int axis = 0; axis < dim; axis++)
            if (!sides_periodic(box, axis) && sides_turn(c->type, dim, k, axis))
                turning[k / 8] |= (uint64_t)(3u << 2 * axis) << 8 * (k % 8);
}

int ops_ghosts_refresh(struct ops *o, struct arena *a, const struct ops_ghosts *g,
                       const struct box *box, int column, struct error *e)
{
    const struct column *c = &a->p->column[column];
    const struct arena_place *at = &a->place[column];
    const uint64_t plane = a->plane, n = a->n, n_ghost = g->n;
    const uint32_t mirror = (uint32_t)at->mirror;
    uint64_t turning[2];
    if (n_ghost == 0)
        return 0;
    if (strcmp(c->name, "x") == 0)
        return ops_put_sides(o, box, e)
                   ? -1
                   : OPS_LAUNCH(o, K_REFRESH_POSITION, n_ghost, e, DEVICE_BUFFER(&a->wide),
                                DEVICE_VALUE(plane), DEVICE_VALUE(at->slot),
                                DEVICE_BUFFER(&o->sides), DEVICE_VALUE(n), DEVICE_VALUE(n_ghost),
                                DEVICE_BUFFER(&g->parent), DEVICE_BUFFER(&g->image));
    ops_turning(box, c, o->dim, turning);
    if (at->size == 4)
        return OPS_LAUNCH(o, K_REFRESH_NARROW, n_ghost, e, DEVICE_BUFFER(&a->narrow),
                          DEVICE_VALUE(plane), DEVICE_VALUE(at->slot), DEVICE_VALUE(c->ncomp),
                          DEVICE_VALUE(turning[0]), DEVICE_VALUE(turning[1]), DEVICE_VALUE(n),
                          DEVICE_VALUE(n_ghost), DEVICE_BUFFER(&g->parent),
                          DEVICE_BUFFER(&g->image));
    return OPS_LAUNCH(o, K_REFRESH_WIDE, n_ghost, e, DEVICE_BUFFER(&a->wide), DEVICE_VALUE(plane),
                      DEVICE_VALUE(at->slot), DEVICE_VALUE(c->ncomp), DEVICE_VALUE(turning[0]),
                      DEVICE_VALUE(turning[1]), DEVICE_VALUE(n), DEVICE_VALUE(n_ghost),
                      DEVICE_BUFFER(&g->parent), DEVICE_BUFFER(&g->image),
                      DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(mirror));
}
