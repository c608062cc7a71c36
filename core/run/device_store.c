/* run/device_store.c -- what a run keeps on its device beside the particles goes into a checkpoint and comes back:
 * ghosts, lists, and the places that these were made from. So a run that goes on adds up in the same order. */
#include "run/device.h"

#include <stdlib.h>

/* n elements of a buffer. */
static int buffer_store(struct run *r, struct store *s, const char *name, enum store_type type,
                        struct device_buffer *b, size_t n, struct error *e)
{
    const size_t size = store_size(type);
    size_t there = n;
    void *data = NULL;
    int status = 0;

    if (!s->reading) {
        data = malloc(n * size + 1);
        status = data ? 0 : error_memory(e, "a checkpoint", n * size);
        if (!status && n)
            status = device_read(r->device->d, b, 0, data, n * size, e);
    }
    if (!status)
        status = store_array(s, name, type, &data, &there, 0, e);
    if (!status && there != n)
        status = store_broken(s, e, "%s has %zu elements, not %zu", name, there, n);
    if (!status && s->reading && n)
        status = device_reserve(r->device->d, b, n * size, "a checkpoint's lists", e) ||
                         device_write(r->device->d, b, 0, data, n * size, e)
                     ? -1
                     : 0;
    free(data);
    return status;
}

static int ghosts_of_store(struct run *r, struct store *s, size_t array, struct error *e)
{
    struct ops_ghosts *g = &r->device->ghosts[array];
    const struct particles *p = &r->plan->array[array].p;

    if (store_count(s, "n_ghost", &g->n, e) ||
        buffer_store(r, s, "parent", STORE_U32, &g->parent, g->n, e) ||
        buffer_store(r, s, "image", STORE_U8, &g->image, g->n, e))
        return -1;
    if (!s->reading)
        return 0;
    if (arena_resize(&r->device->arena[array], p->n, g->n, e))
        return -1;
    for (size_t c = 0; c < p->n_column; c++) {
        r->stale[array][c] = g->n > 0;
        r->mirror_old[array][c] = MIRROR_OLD;
    }
    return 0;
}

static int list_store(struct run *r, struct store *s, size_t k, struct error *e)
{
    struct device_list *l = &r->device->list[k];
    const size_t n = r->plan->array[r->plan->list[k].dst].p.n;
    size_t begins;

    if (store_count(s, "n_group", &l->n_group, e) || store_u64(s, "n_entry", &l->n_entry, e) ||
        store_u64(s, "n_pair", &l->n_pair, e) || store_f64(s, "share", &r->device->share[k], e))
        return -1;
    if (s->reading && l->n_group && l->n_group != (n + SPH_LANES - 1) / SPH_LANES)
        return store_broken(s, e, "a list has %zu groups of %zu particles", l->n_group, n);
    begins = l->n_group ? l->n_group + 1 : 0;
    return buffer_store(r, s, "begin", STORE_U32, &l->begin, begins, e) ||
                   buffer_store(r, s, "common", STORE_U32, &l->common, l->n_group, e) ||
                   buffer_store(r, s, "step", STORE_U32, &l->step, (size_t)l->n_entry, e)
               ? -1
               : 0;
}

static int skin_of_store(struct run *r, struct store *s, struct ops_skin *skin, struct error *e)
{
    if (store_count(s, "n", &skin->n, e))
        return -1;
    const size_t stride = skin->n ? ops_skin_stride(skin) : 0;
    return buffer_store(r, s, "x", STORE_F64, &skin->x, stride * (size_t)r->plan->dim, e) ||
                   buffer_store(r, s, "h", STORE_F64, &skin->h, stride, e)
               ? -1
               : 0;
}

int run_device_store(struct run *r, struct store *s, struct error *e)
{
    const struct plan *plan = r->plan;
    int status = s->reading ? run_device_put(r, e) : 0;

    for (size_t a = 0; !status && a < plan->n_array; a++) {
        store_enter(s, "device_array", a);
        status = ghosts_of_store(r, s, a, e);
        store_leave(s);
    }
    for (size_t k = 0; !status && k < plan->n_list; k++) {
        store_enter(s, "device_list", k);
        status = list_store(r, s, k, e);
        store_leave(s);
    }
    for (size_t k = 0; !status && k < plan->n_array * plan->n_frame; k++) {
        store_enter(s, "device_skin", k);
        status = skin_of_store(r, s, &r->device->skin[k], e);
        store_leave(s);
    }
    return status;
}
