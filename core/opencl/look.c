/* opencl/look.c -- launches look.cl and adds up what its blocks came to (see look.h). */
#include "config.h"

#include "opencl/look.h"

#include "opencl/embed.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Particles that a work item takes: as run/totals.c; a GPU wants more work items. */
#define BLOCK 4096u
#define BLOCK_OF_MANY 256u
#define SUMS 10u /* as look.cl */

EMBED("look_text", "opencl/look.cl");
extern EMBEDDED look_text[];

/* As in look.cl. */
struct entry {
    uint64_t at;
    double least, most;
    uint32_t size, reserved;
};

struct look {
    struct device *d;
    struct device_program *program;
    struct device_kernel *columns, *totals, *groups;
    struct device_buffer entries, wrong, part;
    uint32_t block;
    bool asked; /* something was looked at since `wrong` was read */
};

int look_open(struct look **out, struct device *d, int dim, struct error *e)
{
    struct look *l = *out = calloc(1, sizeof(*l));
    char options[64];

    if (!l)
        return error_memory(e, "the look at a device", sizeof(*l));
    l->d = d;
    l->block = device_facts(d)->cpu ? BLOCK : BLOCK_OF_MANY;
    snprintf(options, sizeof(options), "-DDIM=%d", dim);
    if (device_build(d, &l->program, look_text, options, "the look at columns", e) ||
        device_kernel(d, l->program, "look_columns", "look", &l->columns, e) ||
        device_kernel(d, l->program, "look_totals", "totals", &l->totals, e) ||
        device_kernel(d, l->program, "look_groups", "look", &l->groups, e) ||
        device_reserve(d, &l->wrong, sizeof(uint32_t), "flags", e) ||
        device_fill(d, &l->wrong, 0, 0, sizeof(uint32_t), e))
        return -1;
    return 0;
}

void look_close(struct look *l)
{
    if (!l)
        return;
    device_release(l->d, &l->entries);
    device_release(l->d, &l->wrong);
    device_release(l->d, &l->part);
    device_program_free(l->d, l->program);
    free(l);
}

static uint64_t at(const struct arena *a, int column)
{
    return column < 0 ? 0 : (uint64_t)a->place[column].slot * a->plane;
}

static uint32_t size_of(const struct arena *a, int column)
{
    return column < 0 ? 0 : a->place[column].size;
}

/* -- Columns -------- */

static size_t fill_entries(struct entry *entry, const struct arena *a, const struct look_column *c,
                           size_t n)
{
    size_t k = 0;

    for (size_t i = 0; i < n; i++) {
        const struct column *column = &a->p->column[c[i].column];
        const struct arena_place *place = &a->place[c[i].column];
        const double largest = place->size == sizeof(double) ? DBL_MAX : (double)FLT_MAX;
        for (uint32_t q = 0; q < column->ncomp; q++)
            entry[k++] =
                (struct entry){.at = (uint64_t)(place->slot + q) * a->plane,
                               .least = fmax(c[i].least, c[i].finite ? -largest : -INFINITY),
                               .most = c[i].finite ? largest : INFINITY,
                               .size = place->size};
    }
    return k;
}

int look_at_columns(struct look *l, const struct arena *a, const struct look_column *c, size_t n,
                    struct error *e)
{
    const uint32_t particles = (uint32_t)a->n, block = l->block,
                   blocks = (particles + block - 1) / block;
    size_t most = 0;
    struct entry *entry;
    uint32_t n_entry;
    int status;

    for (size_t i = 0; i < n; i++)
        most += a->p->column[c[i].column].ncomp;
    if (!most || !particles)
        return 0;
    entry = malloc(most * sizeof(*entry));
    if (!entry)
        return error_memory(e, "the look at columns", most * sizeof(*entry));
    n_entry = (uint32_t)fill_entries(entry, a, c, n);
    status = device_reserve(l->d, &l->entries, most * sizeof(*entry), "flags", e) ||
                     device_write(l->d, &l->entries, 0, entry, n_entry * sizeof(*entry), e)
                 ? -1
                 : 0;
    free(entry);
    l->asked = true;
    const struct device_arg arg[] = {DEVICE_BUFFER(&a->wide),    DEVICE_BUFFER(&a->narrow),
                                     DEVICE_BUFFER(&l->entries), DEVICE_VALUE(n_entry),
                                     DEVICE_VALUE(particles),    DEVICE_VALUE(block),
                                     DEVICE_VALUE(blocks),       DEVICE_BUFFER(&l->wrong)};
    return status ? -1
                  : device_launch(l->d, l->columns, (size_t)n_entry * blocks, arg,
                                  sizeof(arg) / sizeof(arg[0]), e);
}

int look_wrong(struct look *l, bool *wrong, struct error *e)
{
    uint32_t flag = 0;

    *wrong = false;
    if (!l->asked)
        return 0;
    l->asked = false;
    if (device_read(l->d, &l->wrong, 0, &flag, sizeof(flag), e) ||
        (flag && device_fill(l->d, &l->wrong, 0, 0, sizeof(flag), e)))
        return -1;
    *wrong = flag != 0;
    return 0;
}

int look_groups(struct look *l, const struct arena *a, int column, uint64_t *n, struct error *e)
{
    const uint32_t particles = (uint32_t)a->n, block = l->block,
                   blocks = (particles + block - 1) / block;
    const uint64_t from = at(a, column);
    const size_t bytes = blocks * sizeof(uint32_t);
    uint32_t *part;
    int status;

    *n = 0;
    if (!particles)
        return 0;
    if (device_reserve(l->d, &l->part, bytes, "flags", e))
        return -1;
    const struct device_arg arg[] = {DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(from),
                                     DEVICE_VALUE(particles), DEVICE_VALUE(block),
                                     DEVICE_BUFFER(&l->part)};
    part = malloc(bytes);
    status = part ? device_launch(l->d, l->groups, blocks, arg, sizeof(arg) / sizeof(arg[0]), e)
                  : error_memory(e, "flags", bytes);
    if (!status)
        status = device_read(l->d, &l->part, 0, part, bytes, e);
    for (uint32_t b = 0; !status && b < blocks; b++)
        *n += part[b];
    free(part);
    return status;
}

/* -- Totals -------- */

static void add(struct look_totals *t, const double *part)
{
    t->mass += part[0];
    t->kinetic += part[1];
    t->momentum_scale += part[2];
    t->angular_scale += part[3];
    for (int c = 0; c < 3; c++) {
        t->momentum[c] += part[4 + c];
        t->angular[c] += part[7 + c];
    }
}

int look_totals(struct look *l, const struct arena *a, int mass, int position, int velocity,
                struct look_totals *t, struct error *e)
{
    const uint32_t n = (uint32_t)a->n, block = l->block, blocks = (n + block - 1) / block;
    const uint32_t m_size = size_of(a, mass), v_size = size_of(a, velocity);
    const uint64_t m_at = at(a, mass), x_at = at(a, position), v_at = at(a, velocity),
                   plane = a->plane;
    const size_t bytes = (size_t)blocks * SUMS * sizeof(double);
    double *part;
    int status;

    *t = (struct look_totals){0};
    if (!n)
        return 0;
    if (device_reserve(l->d, &l->part, bytes, "totals", e))
        return -1;
    const struct device_arg arg[] = {
        DEVICE_BUFFER(&a->wide), DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(m_at),
        DEVICE_VALUE(m_size),    DEVICE_VALUE(x_at),        DEVICE_VALUE(v_at),
        DEVICE_VALUE(v_size),    DEVICE_VALUE(plane),       DEVICE_VALUE(n),
        DEVICE_VALUE(block),     DEVICE_BUFFER(&l->part)};
    part = malloc(bytes);
    status = part ? device_launch(l->d, l->totals, blocks, arg, sizeof(arg) / sizeof(arg[0]), e)
                  : error_memory(e, "totals", bytes);
    if (!status)
        status = device_read(l->d, &l->part, 0, part, bytes, e);
    for (uint32_t b = 0; !status && b < blocks; b++)
        add(t, part + (size_t)b * SUMS);
    free(part);
    return status;
}
