/* check/check_state.c -- the check `state`: what an item saves, a fresh use of it restores and
 * saves again as the same bytes (sph/state.h). */
#include "check/checks.h"

#include <stdlib.h>
#include <string.h>

struct saved {
    char *bytes;
    size_t n;
};

static sph_status append(const sph_writer *w, const void *bytes, uint64_t n)
{
    struct saved *s = w->context;
    char *grown = realloc(s->bytes, s->n + n + 1);

    if (!grown)
        return SPH_E_NOMEM;
    s->bytes = grown;
    memcpy(grown + s->n, bytes, n);
    s->n += n;
    return SPH_OK;
}

static int save(const struct subject *s, const struct use *use, struct saved *out, struct error *e)
{
    const sph_writer writer = {(uint32_t)sizeof(writer), 0, out, append};
    char why[512];
    sph_status status;

    stage(s, "save");
    status = s->entry->state->save(&s->registry->host, use->state, &writer);
    if (status == SPH_OK)
        return 0;
    registry_reason(s->registry, status, why, sizeof(why));
    return error_set(e, EXIT_RUN, "save fails: %s", why);
}

/* The bytes lie before memory that nobody may touch, and are gone after the call. */
static int restore(const struct subject *s, struct use *use, const struct saved *from,
                   struct error *e)
{
    const sph_state *state = s->entry->state;
    char *bytes = watch_memory(from->n, "the saved bytes");
    char why[512];
    sph_status status;

    if (!bytes)
        return error_memory(e, "a copy", from->n);
    if (from->n)
        memcpy(bytes, from->bytes, from->n);
    stage(s, "restore of %zu bytes", from->n);
    status = state->restore(&s->registry->host, use->state, state->format, bytes, from->n);
    watch_release(bytes);
    if (status == SPH_OK)
        return 0;
    registry_reason(s->registry, status, why, sizeof(why));
    return error_set(e, EXIT_RUN, "restore of what it has saved fails: %s", why);
}

/* A step on, where the item has a way to go on: prepare alone changes a state. */
static void go_on(const struct subject *s, const struct use *use)
{
    const sph_function *f = s->entry->kind == KIND_FUNCTION ? entry_function(s->entry) : NULL;
    struct pass_spec spec[2];
    const struct bench_shape shape = {0, LAYOUT_CLUSTER, 0, false, 0};
    struct bench b = {.subject = s, .spec = spec, .shape = shape, .use = *use};

    if (!f || !f->prepare || passes_of(s->entry, spec) == 0)
        return;
    spec[0].shape = SPH_POINT; /* no particles, so no columns */
    b.dst = watch_memory(bench_count(&b) * sizeof(sph_column), "batch->dst");
    b.param = use->config.value;
    stage(s, "prepare");
    for (int i = 0; i < 3; i++) {
        sph_batch batch = bench_batch(&b);
        batch.dim = 2;
        batch.kernel = NULL;
        batch.step = (uint64_t)i;
        batch.time = i * batch.dt;
        f->prepare(&batch);
    }
}

static int twice(const struct subject *s, int dim, struct saved out[2], struct error *e)
{
    struct use use[2] = {{0}, {0}};
    int status = 0;

    for (int i = 0; !status && i < 2; i++) {
        status = subject_configure(s, &use[i], e);
        stage(s, "create");
        if (!status)
            status = use_create(&use[i], s->registry, dim, e);
    }
    if (!status)
        go_on(s, &use[0]);
    if (!status)
        status = save(s, &use[0], &out[0], e) || restore(s, &use[1], &out[0], e) ||
                         save(s, &use[1], &out[1], e)
                     ? -1
                     : 0;
    if (!status &&
        s->entry->state->restore(&s->registry->host, use[1].state, s->entry->state->format + 1000,
                                 out[0].bytes, out[0].n) == SPH_OK)
        status = error_set(e, EXIT_RUN,
                           "restore takes format %u, which it has never written: it must fail",
                           s->entry->state->format + 1000);
    for (int i = 0; i < 2; i++)
        if (use[i].item)
            use_fini(&use[i], s->registry);
    return status;
}

void check_state(const struct subject *s)
{
    struct saved saved[2] = {{NULL, 0}, {NULL, 0}};
    struct error e = {0};
    int dim = 1;
    size_t i = 0;

    if (!s->entry->state)
        return;
    while (!subject_works_in(s, dim))
        dim++;
    if (twice(s, dim, saved, &e)) {
        say(s, VERDICT_FAIL, "%s", e.text);
        return;
    }
    while (i < saved[0].n && i < saved[1].n && saved[0].bytes[i] == saved[1].bytes[i])
        i++;
    if (i < saved[0].n || i < saved[1].n)
        say(s, VERDICT_FAIL,
            "saved, restored and saved again: %zu bytes became %zu, different from byte %zu on",
            saved[0].n, saved[1].n, i);
    else
        say(s, VERDICT_OK, "its state of %zu bytes comes back the same", saved[0].n);
    free(saved[0].bytes);
    free(saved[1].bytes);
}
