/* opencl/ops.c -- opens the core's own kernels on a device; columns' mirrors and order; what kernels have left
 * behind. */
#include "base/text.h"
#include "opencl/ops_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* By enum ops_kernel: its name, and what its time counts as. */
static const struct {
    const char *name, *timed;
} kernels[OPS_KERNELS] = {
    [K_MIRROR] = {"mirror_floats", "mirror"},
    [K_PLACES] = {"mirror_places", "mirror"},
    [K_PERMUTE] = {"permute", "permute"},
    [K_ADVANCE] = {"advance", "integrate"},
    [K_REDUCE] = {"reduce_column", "reduce"},
    [K_SKIN_KEEP] = {"skin_keep", "skin"},
    [K_SKIN] = {"skin_change", "skin"},
    [K_PARTS] = {"reduce_parts", "reduce"},
    [K_WRAP] = {"wrap", "sides"},
    [K_GHOSTS_COUNT] = {"ghosts_count", "sides"},
    [K_SCAN] = {"scan", "sides"},
    [K_GHOSTS_FILL] = {"ghosts_fill", "sides"},
    [K_REFRESH_POSITION] = {"refresh_position", "ghosts"},
    [K_REFRESH_WIDE] = {"refresh_wide", "ghosts"},
    [K_REFRESH_NARROW] = {"refresh_narrow", "ghosts"},
    [K_PACK_WIDE] = {"pack_wide", "pack"},
    [K_PACK_NARROW] = {"pack_narrow", "pack"},
};

/* A set's texts: what is for LANES particles once for one and once for eight. */
static const char *const texts[OPS_SETS][8] = {
    [OPS_COLUMNS] = {ops_words_text, "\n#define LANES 1\n", ops_lanes_text,
                     "\n#undef LANES\n#define LANES 8\n", ops_lanes_text, ops_columns_text,
                     ops_reduce_text},
    [OPS_SIDES] = {ops_words_text, ops_sides_text}};

int ops_build(struct ops *o, enum ops_kernel k, struct error *e)
{
    const int set = k < K_WRAP ? OPS_COLUMNS : OPS_SIDES;
    const size_t first = set == OPS_COLUMNS ? 0 : K_WRAP,
                 end = set == OPS_COLUMNS ? K_WRAP : OPS_KERNELS;
    char options[64], *text;
    if (o->kernel[k])
        return 0;
    text = text_join(texts[set]);
    if (!text)
        return error_memory(e, "the text of kernels", 1);
    snprintf(options, sizeof options, "-DDIM=%d -DWIDE=%zu", o->dim, o->wide);
    int status = device_build(o->d, &o->program[set], text, options, "the core's own kernels", e);
    free(text);
    for (size_t i = first; !status && i < end; i++)
        status = device_kernel(o->d, o->program[set], kernels[i].name, kernels[i].timed,
                               &o->kernel[i], e);
    return status;
}

int ops_open_wide(struct ops **out, struct device *d, int dim, size_t wide, struct error *e)
{
    struct ops *o = calloc(1, sizeof *o);
    const size_t bytes = sizeof(struct ops_words) + OPS_RESULTS * sizeof(double);
    *out = o;
    if (!o)
        return error_memory(e, "kernels", sizeof *o);
    o->d = d;
    o->dim = dim;
    o->wide = wide;
    if (ops_build(o, K_ADVANCE, e) || device_reserve(d, &o->words, bytes, "results", e) ||
        device_fill(d, &o->words, 0, 0, bytes, e)) {
        ops_close(o);
        *out = NULL;
        return -1;
    }
    return 0;
}

int ops_open(struct ops **out, struct device *d, int dim, struct error *e)
{
    return ops_open_wide(out, d, dim, device_facts(d)->cpu ? 8 : 1, e);
}

void ops_close(struct ops *o)
{
    if (!o)
        return;
    struct device_buffer *all[] = {&o->words, &o->part,  &o->scratch,
                                   &o->count, &o->sides, &o->table};
    ops_forget_programs(o);
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++)
        device_release(o->d, all[k]);
    for (int set = 0; set < OPS_SETS; set++)
        device_program_free(o->d, o->program[set]);
    free(o->box);
    free(o->turned);
    free(o);
}

int ops_results(struct ops *o, double *out, size_t n, uint32_t *flags, struct error *e)
{
    struct {
        struct ops_words words;
        double result[OPS_RESULTS];
    } all;
    if (device_read(o->d, &o->words, 0, &all, sizeof all.words + n * sizeof(double), e))
        return -1;
    if (n)
        memcpy(out, all.result, n * sizeof *out);
    if (!flags)
        return 0;
    *flags = all.words.flags;
    return *flags ? device_fill(o->d, &o->words, offsetof(struct ops_words, flags), 0,
                                sizeof(uint32_t), e)
                  : 0;
}

int ops_flags(struct ops *o, uint32_t *flags, struct error *e)
{
    return ops_results(o, NULL, 0, flags, e);
}

/* -- Mirrors -------- */

int ops_mirror(struct ops *o, struct arena *a, int column, struct error *e)
{
    const struct arena_place *at = &a->place[column];
    const uint64_t plane = a->plane, n = a->n + a->n_ghost;
    const uint32_t to = (uint32_t)at->mirror, ncomp = a->p->column[column].ncomp;
    if (at->mirror < 0)
        return 0;
    return OPS_LAUNCH(o, K_MIRROR, ops_items(o, n), e, DEVICE_BUFFER(&a->wide),
                      DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(plane), DEVICE_VALUE(at->slot),
                      DEVICE_VALUE(to), DEVICE_VALUE(ncomp), DEVICE_VALUE(n));
}

int ops_mirror_places(struct ops *o, struct arena *a, int column, const double *centre,
                      double quantum, struct error *e)
{
    const struct arena_place *at = &a->place[column];
    const uint64_t plane = a->plane, n = a->n + a->n_ghost;
    const uint32_t to = (uint32_t)at->mirror;
    const double c[3] = {centre[0], o->dim > 1 ? centre[1] : 0.0, o->dim > 2 ? centre[2] : 0.0};
    const double inverse = 1.0 / quantum;
    if (at->mirror < 0)
        return 0;
    return OPS_LAUNCH(o, K_PLACES, ops_items(o, n), e, DEVICE_BUFFER(&a->wide),
                      DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(plane), DEVICE_VALUE(at->slot),
                      DEVICE_VALUE(to), DEVICE_VALUE(c[0]), DEVICE_VALUE(c[1]), DEVICE_VALUE(c[2]),
                      DEVICE_VALUE(inverse), DEVICE_VALUE(n), DEVICE_BUFFER(&o->words));
}

/* -- Order -------- */

int ops_copy(struct ops *o, struct arena *a, int from, int to, struct error *e)
{
    const struct column *c = &a->p->column[from], *other = &a->p->column[to];
    const struct arena_place *x = &a->place[from], *y = &a->place[to];
    struct device_buffer *buffer = x->size == 8 ? &a->wide : &a->narrow;
    if (x->size != y->size || c->ncomp != other->ncomp)
        return error_set(e, EXIT_RUN, "%s.%s cannot hold what %s is", a->p->name, other->name,
                         c->name);
    if (from == to)
        return 0;
    if (ops_bring(a, from, e))
        return -1;
    for (uint32_t k = 0; k < c->ncomp; k++)
        if (device_copy(o->d, buffer, (y->slot + k) * a->plane * y->size, buffer,
                        (x->slot + k) * a->plane * x->size, a->n * x->size, e))
            return -1;
    arena_written_here(a, to);
    return 0;
}

static int permute_plane(struct ops *o, struct arena *a, size_t size, uint32_t slot,
                         const struct device_buffer *order, struct error *e)
{
    const uint64_t plane = a->plane;
    const uint32_t n = (uint32_t)a->n, from = slot | (size == 4 ? SLOT_NARROW : 0u);
    struct device_buffer *buffer = size == 8 ? &a->wide : &a->narrow;
    return OPS_LAUNCH(o, K_PERMUTE, n, e, DEVICE_BUFFER(&a->wide), DEVICE_BUFFER(&a->narrow),
                      DEVICE_VALUE(plane), DEVICE_VALUE(from), DEVICE_BUFFER(order),
                      DEVICE_BUFFER(&o->scratch), DEVICE_VALUE(n), DEVICE_BUFFER(&o->words)) ||
                   device_copy(o->d, buffer, slot * plane * size, &o->scratch, 0, n * size, e)
               ? -1
               : 0;
}

int ops_permute(struct ops *o, struct arena *a, const struct device_buffer *order, struct error *e)
{
    a->n_ghost = 0;
    if (a->n == 0)
        return 0;
    if (device_reserve(o->d, &o->scratch, a->n * 8, "sorting particles", e))
        return -1;
    for (size_t c = 0; c < a->p->n_column; c++) {
        const struct column *column = &a->p->column[c];
        const struct arena_place *at = &a->place[c];
        if (column->state && ops_bring(a, (int)c, e))
            return -1;
        for (uint32_t k = 0; column->state && k < column->ncomp; k++)
            if (permute_plane(o, a, at->size, at->slot + k, order, e))
                return -1;
        a->here[c] = column->state;
        a->there[c] = false;
    }
    return 0;
}
