/* opencl/ops_halo.c -- on a device: what other ranks want of its particles, and what comes from them, as
 * domain/halo_columns.c has it on the host. */
#include "opencl/ops_private.h"

#include <string.h>

int ops_need_halo(struct ops *o, struct error *e)
{
    return ops_build(o, K_PACK_WIDE, e);
}

/* Of n elements each. */
static int set(struct ops *o, struct device_buffer *index, struct device_buffer *image,
               const uint32_t *from, const uint8_t *as, size_t n, struct error *e)
{
    const size_t most = n + n / 8;
    if (n == 0)
        return 0;
    if ((n * sizeof *from > index->bytes &&
         device_reserve(o->d, index, most * sizeof *from, "ghosts", e)) ||
        (n > image->bytes && device_reserve(o->d, image, most, "ghosts", e)))
        return -1;
    return device_write(o->d, index, 0, from, n * sizeof *from, e) ||
                   device_write(o->d, image, 0, as, n, e)
               ? -1
               : 0;
}

int ops_ghosts_set(struct ops *o, struct ops_ghosts *g, const uint32_t *parent,
                   const uint8_t *image, size_t n, struct error *e)
{
    g->n = 0;
    if (set(o, &g->parent, &g->image, parent, image, n, e))
        return -1;
    g->n = n;
    return 0;
}

void ops_sends_release(struct ops *o, struct ops_sends *s)
{
    device_release(o->d, &s->index);
    device_release(o->d, &s->image);
    s->n = 0;
}

int ops_sends_set(struct ops *o, struct ops_sends *s, const uint32_t *index, const uint8_t *image,
                  size_t n, struct error *e)
{
    s->n = 0;
    if (set(o, &s->index, &s->image, index, image, n, e))
        return -1;
    s->n = n;
    return 0;
}

size_t ops_packed(const struct arena *a, int column, size_t n)
{
    return (n * a->p->column[column].ncomp * a->place[column].size + 7) / 8 * 8;
}

int ops_pack(struct ops *o, struct arena *a, const struct ops_sends *s, const struct box *box,
             int column, struct device_buffer *out, size_t at, struct error *e)
{
    const struct column *c = &a->p->column[column];
    const struct arena_place *place = &a->place[column];
    const uint32_t is_position = strcmp(c->name, "x") == 0;
    const uint64_t plane = a->plane, n = s->n, first = at / place->size;
    uint64_t turning[2];
    if (n == 0)
        return 0;
    if (ops_bring(a, column, e) || ops_put_sides(o, box, e))
        return -1;
    ops_turning(box, c, o->dim, turning);
    if (place->size == 4)
        return OPS_LAUNCH(o, K_PACK_NARROW, n, e, DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(plane),
                          DEVICE_VALUE(place->slot), DEVICE_VALUE(c->ncomp),
                          DEVICE_VALUE(turning[0]), DEVICE_VALUE(turning[1]), DEVICE_VALUE(n),
                          DEVICE_BUFFER(&s->index), DEVICE_BUFFER(&s->image), DEVICE_BUFFER(out),
                          DEVICE_VALUE(first));
    return OPS_LAUNCH(o, K_PACK_WIDE, n, e, DEVICE_BUFFER(&a->wide), DEVICE_VALUE(plane),
                      DEVICE_VALUE(place->slot), DEVICE_VALUE(c->ncomp), DEVICE_VALUE(turning[0]),
                      DEVICE_VALUE(turning[1]), DEVICE_BUFFER(&o->sides), DEVICE_VALUE(is_position),
                      DEVICE_VALUE(n), DEVICE_BUFFER(&s->index), DEVICE_BUFFER(&s->image),
                      DEVICE_BUFFER(out), DEVICE_VALUE(first));
}

int ops_unpack(struct ops *o, struct arena *a, int column, size_t first, size_t n,
               const struct device_buffer *in, size_t at, struct error *e)
{
    const struct arena_place *place = &a->place[column];
    const size_t size = place->size;
    struct device_buffer *to = size == 8 ? &a->wide : &a->narrow;
    for (uint32_t k = 0; n && k < a->p->column[column].ncomp; k++)
        if (device_copy(o->d, to, ((place->slot + k) * a->plane + a->n + first) * size, in,
                        at + k * n * size, n * size, e))
            return -1;
    return 0;
}
