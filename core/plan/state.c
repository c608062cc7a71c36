/* plan/state.c -- a plugin's own state (sph/state.h) as bytes, for checkpoints. */
#include "plan/plan.h"
#include <stdlib.h>
#include <string.h>

struct buffer {
    char *bytes;
    uint64_t n, capacity;
};

static sph_status append(const sph_writer *w, const void *bytes, uint64_t n)
{
    struct buffer *b = w->context;
    if (n > UINT64_MAX / 4 - b->n)
        return SPH_E_NOMEM;
    if (b->n + n > b->capacity) {
        const uint64_t capacity = 2 * (b->n + n);
        char *grown = realloc(b->bytes, capacity);
        if (!grown)
            return SPH_E_NOMEM;
        b->bytes = grown;
        b->capacity = capacity;
    }
    if (n > 0)
        memcpy(b->bytes + b->n, bytes, n);
    b->n += n;
    return SPH_OK;
}

bool use_has_state(const struct use *u)
{
    return u->entry && u->entry->state && u->life && u->life->create;
}

static int failed(struct registry *r, const struct use *u, const char *what, sph_status status,
                  struct error *e)
{
    char why[512];
    registry_reason(r, status, why, sizeof why);
    return error_set(e, EXIT_RUN, "%s: its state cannot be %s: %s", u->item->name, what, why);
}

int use_save(const struct use *u, struct registry *r, struct use_state *out, struct error *e)
{
    struct buffer b = {0};
    const sph_writer writer = {sizeof writer, 0, &b, append};
    const sph_status status = u->entry->state->save(&r->host, u->state, &writer);
    if (status != SPH_OK) {
        free(b.bytes);
        return failed(r, u, "saved", status, e);
    }
    *out = (struct use_state){b.bytes, b.n, u->entry->state->format};
    return 0;
}

int use_restore(struct use *u, struct registry *r, const struct use_state *in, struct error *e)
{
    const sph_status status =
        u->entry->state->restore(&r->host, u->state, in->format, in->bytes, in->n);
    return status == SPH_OK ? 0 : failed(r, u, "restored", status, e);
}
