/* run/device_domain.c -- a run on several ranks, each with a device: particles that move to another rank, ghosts
 * of others' particles, and columns brought up to date in them. Who needs whom the host finds out; columns are
 * packed on the device, read at once, sent, and written at once. */
#include "run/device.h"

#include "run/domain.h"
#include "run/frames.h"
#include "run/watch.h"

#include <stdlib.h>
#include <string.h>

int run_device_domain_open(struct run *r, struct error *e)
{
    struct run_device *d = r->device;
    const int mine = (int)d->number;

    if (!run_shared(r))
        return 0;
    const size_t ranks = (size_t)wire_size(r->domain->wire);
    d->taken = calloc(ranks, sizeof(*d->taken));
    d->send = calloc(r->plan->n_array + 1, sizeof(*d->send));
    d->met = calloc(r->plan->n_array * r->plan->n_frame + 1, sizeof(*d->met));
    if (!d->taken || !d->send || !d->met)
        return error_memory(e, "the domain", ranks * sizeof(*d->taken));
    return ops_need_halo(d->ops, e) ||
                   wire_gather(r->domain->wire, &mine, sizeof(mine), d->taken, e)
               ? -1
               : 0;
}

void run_device_domain_close(struct run *r)
{
    struct run_device *d = r->device;

    for (size_t a = 0; d->send && d->ops && a < r->plan->n_array; a++)
        ops_sends_release(d->ops, &d->send[a]);
    for (size_t k = 0; d->met && d->ops && k < r->plan->n_array * r->plan->n_frame; k++)
        ops_skin_release(d->ops, &d->met[k]);
    if (d->d) {
        device_release(d->d, &d->out);
        device_release(d->d, &d->in);
    }
    free(d->send);
    free(d->met);
    free(d->taken);
    free(d->packed);
}

/* -- Particles that move -------- */

void run_device_weigh(struct run *r, size_t list, double times, float *weight)
{
    struct run_device *d = r->device;
    const struct device_list *l = &d->list[list];
    const size_t n = r->plan->array[r->plan->list[list].dst].p.n;
    uint32_t *begin = malloc((l->n_group + 1) * sizeof(*begin));
    struct error ignored = {0};

    /* Without them it is as if there were no pairs. */
    if (begin && l->n_group && l->n_group == (n + SPH_LANES - 1) / SPH_LANES &&
        !device_read(d->d, &l->begin, 0, begin, (l->n_group + 1) * sizeof(*begin), &ignored))
        for (size_t i = 0; i < n; i++) {
            const size_t g = i / SPH_LANES, first = g * SPH_LANES;
            const size_t in_group = n - first < SPH_LANES ? n - first : SPH_LANES;
            const double pairs = d->share[list] * (double)(begin[g + 1] - begin[g]);
            weight[i] += (float)(times * pairs / (double)in_group);
        }
    free(begin);
}

int run_device_move(struct run *r, struct error *e)
{
    if (!run_shared(r))
        return 0;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct particles *p = &r->plan->array[a].p;
        for (size_t c = 0; c < p->n_column; c++)
            if (p->column[c].state && run_device_get(r, a, (int)c, e))
                return -1;
    }
    if (run_domain_move(r, e) || run_device_put(r, e))
        return -1;
    /* What is no state somebody makes anew. */
    for (size_t a = 0; a < r->plan->n_array; a++)
        for (size_t c = 0; c < r->plan->array[a].p.n_column; c++)
            if (!r->plan->array[a].p.column[c].state)
                r->device->arena[a].there[c] = false;
    return 0;
}

/* -- Ghosts -------- */

/* All places that neighbours are looked for in are on the host. */
static int places_of_all_frames(struct run *r, struct error *e)
{
    for (size_t f = 0; f < r->plan->n_frame; f++)
        for (size_t a = 0; a < r->plan->n_array; a++)
            if (frame_has(r, f, a) && (run_device_get(r, a, frame_place(r, f, a), e) ||
                                       run_device_get(r, a, frame_reach(r, f, a), e)))
                return -1;
    return 0;
}

/* Those that all peers want of an array, one after the other. */
static int put_sends(struct run *r, size_t array, struct error *e)
{
    const struct halo *h = &r->domain->halo;
    const size_t all = halo_sent(h, array);
    uint32_t *index = malloc(all * sizeof(*index) + 1);
    uint8_t *image = malloc(all + 1);
    size_t n = 0;
    int status = index && image ? 0 : error_memory(e, "ghosts", all * sizeof(*index));

    for (size_t k = 0; !status && k < h->n_peer; k++) {
        const struct halo_part *p = &h->peer[k].part[array];
        if (p->n_send) {
            memcpy(index + n, p->send, p->n_send * sizeof(*index));
            memcpy(image + n, p->image, p->n_send);
        }
        n += p->n_send;
    }
    if (!status)
        status = ops_sends_set(r->device->ops, &r->device->send[array], index, image, n, e);
    free(index);
    free(image);
    return status;
}

static int put_ghosts(struct run *r, size_t array, struct error *e)
{
    struct run_device *d = r->device;
    const struct plan_array *a = &r->plan->array[array];
    const struct ghosts *own = &r->ghosts[array];

    if (ops_ghosts_set(d->ops, &d->ghosts[array], own->parent, own->image, own->n, e) ||
        arena_resize(&d->arena[array], a->p.n, r->domain->halo.n_ghost[array], e) ||
        put_sends(r, array, e))
        return -1;
    for (size_t c = 0; c < a->p.n_column; c++) {
        r->stale[array][c] = true;
        r->mirror_old[array][c] = MIRROR_OLD;
    }
    return run_device_refresh(r, array, a->position, e) ||
                   run_device_refresh(r, array, a->smoothing, e)
               ? -1
               : 0;
}

int run_device_halo(struct run *r, struct error *e)
{
    if (places_of_all_frames(r, e) || run_domain_meet(r, e))
        return -1;
    for (size_t a = 0; a < r->plan->n_array; a++)
        if (put_ghosts(r, a, e))
            return -1;
    return run_device_trade(r, e);
}

/* -- Their columns -------- */

/* Room for what goes and what comes, here and there. */
static int make_room(struct run *r, size_t out, size_t in, struct error *e)
{
    struct run_device *d = r->device;

    if (!d->packed || out + in > d->packed_bytes) {
        free(d->packed);
        d->packed_bytes = 0;
        d->packed = malloc(out + in + 1);
        if (!d->packed)
            return error_memory(e, "messages", out + in);
        d->packed_bytes = out + in;
    }
    return (out > d->out.bytes && device_reserve(d->d, &d->out, out + out / 8, "messages", e)) ||
                   (in > d->in.bytes && device_reserve(d->d, &d->in, in + in / 8, "messages", e))
               ? -1
               : 0;
}

/* All columns packed one behind the other, and read. */
static int pack(struct run *r, size_t bytes, struct error *e)
{
    struct run_device *d = r->device;
    size_t at = 0;

    for (size_t i = 0; i < r->domain->n_column; i++) {
        const struct halo_column *c = &r->domain->column[i];
        struct arena *arena = &d->arena[c->array];
        if (ops_pack(d->ops, arena, &d->send[c->array], &r->plan->scene->box, c->column, &d->out,
                     at, e))
            return -1;
        at += ops_packed(arena, c->column, d->send[c->array].n);
    }
    return bytes ? device_read(d->d, &d->out, 0, d->packed, bytes, e) : 0;
}

/* From the host's room to the ghosts that are others', and their mirrors are old. */
static int unpack(struct run *r, const char *in, size_t bytes, struct error *e)
{
    struct run_device *d = r->device;
    size_t at = 0;

    if (bytes && device_write(d->d, &d->in, 0, in, bytes, e))
        return -1;
    for (size_t i = 0; i < r->domain->n_column; i++) {
        const struct halo_column *c = &r->domain->column[i];
        struct arena *arena = &d->arena[c->array];
        const size_t n = halo_received(&r->domain->halo, c->array);
        if (ops_unpack(d->ops, arena, c->column, d->ghosts[c->array].n, n, &d->in, at, e))
            return -1;
        at += ops_packed(arena, c->column, n);
        r->mirror_old[c->array][c->column] = MIRROR_OLD;
    }
    return 0;
}

/* The columns' planes in the host's room; how many. plane NULL: they are counted alone. */
static size_t planes(const struct run *r, struct halo_plane *plane, char *in)
{
    const struct run_device *d = r->device;
    const char *out = d->packed;
    size_t n = 0;

    for (size_t i = 0; i < r->domain->n_column; i++) {
        const struct halo_column *c = &r->domain->column[i];
        const struct arena *arena = &d->arena[c->array];
        const size_t size = arena->place[c->column].size, n_out = d->send[c->array].n;
        const size_t n_in = halo_received(&r->domain->halo, c->array);
        for (uint32_t k = 0; k < c->p->column[c->column].ncomp; k++, n++)
            if (plane)
                plane[n] = (struct halo_plane){c->array, size, out + k * n_out * size,
                                               in + k * n_in * size};
        if (plane) {
            out += ops_packed(arena, c->column, n_out);
            in += ops_packed(arena, c->column, n_in);
        }
    }
    return n;
}

static int trade(struct run *r, struct error *e)
{
    struct run_device *d = r->device;
    size_t out = 0, in = 0;

    for (size_t i = 0; i < r->domain->n_column; i++) {
        const struct halo_column *c = &r->domain->column[i];
        const struct arena *arena = &d->arena[c->array];
        out += ops_packed(arena, c->column, d->send[c->array].n);
        in += ops_packed(arena, c->column, halo_received(&r->domain->halo, c->array));
    }
    struct halo_plane *plane = malloc((planes(r, NULL, NULL) + 1) * sizeof(*plane));
    if (!plane)
        return error_memory(e, "messages", sizeof(*plane));
    int status = make_room(r, out, in, e) || pack(r, out, e) ? -1 : 0;
    if (!status)
        status = halo_trade(&r->domain->halo, plane, planes(r, plane, d->packed + out), e);
    if (!status)
        status = unpack(r, d->packed + out, in, e);
    free(plane);
    return status;
}

int run_device_trade(struct run *r, struct error *e)
{
    if (!run_shared(r) || !r->domain->n_column)
        return 0;
    const size_t before = device_span(r->device->d, SPAN_LISTS);
    const int status = trade(r, e);
    device_span(r->device->d, before);
    r->domain->n_column = 0;
    return status;
}
