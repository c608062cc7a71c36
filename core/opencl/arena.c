/* opencl/arena.c -- a particle array's columns on a device: where each stands, room for more particles, and
 * transfers. Touches the device's memory and, where asked to, the host's columns. */
#include "opencl/arena.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Successive slots begin so many elements apart, modulo a page of them: a multiple of a cache line's, yet so
 * that what one particle has in many slots never shares a few sets of a cache. */
#define PLANE_UNIT 512u
#define PLANE_SHIFT 208u

static size_t plane_for(size_t capacity)
{
    const size_t need = capacity + PARTICLES_PAD;
    return need <= PLANE_SHIFT
               ? PLANE_SHIFT
               : (need - PLANE_SHIFT + PLANE_UNIT - 1) / PLANE_UNIT * PLANE_UNIT + PLANE_SHIFT;
}

static struct device_buffer *buffer_of(struct arena *a, uint32_t size)
{
    return size == 8 ? &a->wide : &a->narrow;
}

static void place_columns(struct arena *a)
{
    for (size_t k = 0; k < a->p->n_column; k++) {
        const struct column *c = &a->p->column[k];
        struct arena_place *at = &a->place[k];
        uint32_t *next = c->size == 8 ? &a->n_wide : &a->n_narrow;
        *at = (struct arena_place){.size = (uint32_t)c->size, .slot = *next, .mirror = -1};
        *next += c->ncomp;
        if (c->mirror) {
            at->mirror = (int32_t)a->n_narrow;
            a->n_narrow += c->ncomp;
        }
    }
}

int arena_plan(struct arena *a, struct particles *p, struct error *e)
{
    const size_t n = p->n_column + 1;
    *a = (struct arena){.p = p};
    for (size_t k = 0; k < p->n_column; k++)
        if (p->column[k].low)
            return error_set(e, EXIT_RUN,
                             "%s.%s is held in two parts, which a device does not know", p->name,
                             p->column[k].name);
    a->place = calloc(n, sizeof *a->place);
    a->here = calloc(n, sizeof *a->here);
    a->there = calloc(n, sizeof *a->there);
    if (!a->place || !a->here || !a->there) {
        arena_fini(a);
        return error_memory(e, p->name, n * sizeof *a->place);
    }
    memset(a->there, true, n * sizeof *a->there);
    place_columns(a);
    return 0;
}

int arena_init(struct arena *a, struct device *d, struct particles *p, struct error *e)
{
    if (arena_plan(a, p, e))
        return -1;
    a->d = d;
    if (arena_resize(a, p->n, 0, e)) {
        arena_fini(a);
        return -1;
    }
    return 0;
}

void arena_fini(struct arena *a)
{
    if (a->d) {
        device_release(a->d, &a->wide);
        device_release(a->d, &a->narrow);
    }
    free(a->place);
    free(a->here);
    free(a->there);
    memset(a, 0, sizeof *a);
}

size_t arena_bytes(const struct arena *a, size_t n)
{
    return plane_for(n) * ((size_t)a->n_wide * 8 + (size_t)a->n_narrow * 4);
}

/* The slots with the first `keep` elements of each in a new buffer with planes of `plane`. */
static int grow(struct arena *a, struct device_buffer *grown, uint32_t size, size_t plane,
                size_t keep, struct error *e)
{
    const struct device_buffer *old = buffer_of(a, size);
    const size_t slots = size == 8 ? a->n_wide : a->n_narrow;
    const size_t bytes = slots ? slots * plane * size : 64; /* none: something to be handed over */
    char what[192];
    snprintf(what, sizeof what, "columns of \"%s\"", a->p->name);
    if (device_reserve(a->d, grown, bytes, what, e))
        return -1;
    for (size_t s = 0; keep && s < slots; s++)
        if (device_copy(a->d, grown, s * plane * size, old, s * a->plane * size, keep * size, e))
            return -1;
    return 0;
}

int arena_resize(struct arena *a, size_t n, size_t n_ghost, struct error *e)
{
    /* As on the host: ghosts are forgotten if the number of particles changes. */
    const size_t both = a->n_ghost < n_ghost ? a->n_ghost : n_ghost;
    const size_t keep = n == a->n ? n + both : n < a->n ? n : a->n;
    const size_t need = n + n_ghost;
    if (need < n || need > UINT32_MAX)
        return error_set(e, EXIT_RUN, "%s: more than %u particles and ghosts", a->p->name,
                         UINT32_MAX);
    if (need + PARTICLES_PAD > a->plane) {
        struct device_buffer wide = {0}, narrow = {0};
        const size_t plane = plane_for(a->plane ? need + need / 8 : need);
        if (grow(a, &wide, 8, plane, keep, e) || grow(a, &narrow, 4, plane, keep, e)) {
            device_release(a->d, &wide);
            device_release(a->d, &narrow);
            return -1;
        }
        device_release(a->d, &a->wide);
        device_release(a->d, &a->narrow);
        a->wide = wide;
        a->narrow = narrow;
        a->plane = plane;
    }
    a->n = n;
    a->n_ghost = n_ghost;
    return 0;
}

int arena_room(struct arena *a, size_t n_ghost, struct error *e)
{
    const size_t n = a->n;
    device_release(a->d, &a->wide);
    device_release(a->d, &a->narrow);
    a->plane = a->n = 0; /* nothing to keep */
    return arena_resize(a, n, n_ghost, e) || arena_resize(a, n, 0, e) ? -1 : 0;
}

int arena_put(struct arena *a, int column, struct error *e)
{
    const struct column *c = &a->p->column[column];
    const struct arena_place *at = &a->place[column];
    if (a->n != a->p->n && arena_resize(a, a->p->n, 0, e))
        return -1;
    if (a->here[column])
        return 0;
    /* Where neither is right, somebody is about to make it anew. */
    for (uint32_t k = 0; a->there[column] && a->n && k < c->ncomp; k++)
        if (device_write(a->d, buffer_of(a, at->size), (at->slot + k) * a->plane * at->size,
                         (const char *)c->data + k * c->plane * c->size, a->n * c->size, e))
            return -1;
    a->here[column] = true;
    return 0;
}

int arena_get(struct arena *a, int column, struct error *e)
{
    const struct column *c = &a->p->column[column];
    const struct arena_place *at = &a->place[column];
    if (a->p->n != a->n && particles_resize(a->p, a->n, 0, e))
        return -1;
    if (a->there[column])
        return 0;
    for (uint32_t k = 0; a->here[column] && a->n && k < c->ncomp; k++)
        if (device_read(a->d, buffer_of(a, at->size), (at->slot + k) * a->plane * at->size,
                        (char *)c->data + k * c->plane * c->size, a->n * c->size, e))
            return -1;
    a->there[column] = true;
    return 0;
}
