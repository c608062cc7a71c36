/* registry/copy.c -- copies descriptors across the border of the ABI (see copy.h). What
 * comes from a plugin is read with memcpy: its structs may be smaller than ours, or not aligned. */
#include "registry/copy.h"

#include "registry/check.h"
#include "registry/reach.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The size up to and including a struct's last member in its first version. Never edit one. */
#define UP_TO(type, member) (offsetof(type, member) + sizeof(((type *)0)->member))

static const size_t first_param = UP_TO(sph_param, choices);
static const size_t first_prop = UP_TO(sph_prop, start);
static const size_t first_rate = UP_TO(sph_rate, reserved);
static const size_t first_reduction = UP_TO(sph_reduction, use);
static const size_t first_step = UP_TO(sph_step, name);
static const size_t first_term = UP_TO(sph_kernel_term, reserved);
static const size_t first_value = UP_TO(sph_device_value, type);
static const size_t first_device = UP_TO(sph_device_body, param);
static const size_t first_point = UP_TO(sph_device_point, fail);
static const size_t first_item = UP_TO(sph_item, props);
static const size_t first_life = UP_TO(sph_life, destroy);
static const size_t first_population = UP_TO(sph_population, born_props);
static const size_t first_fusion = UP_TO(sph_fusion, parts);
static const size_t first_state = UP_TO(sph_state, restore);

static const struct {
    size_t host, first;
} size_of[KIND_COUNT] = {
    [KIND_FUNCTION] = {sizeof(sph_function), UP_TO(sph_function, device)},
    [KIND_EOS] = {sizeof(sph_eos), UP_TO(sph_eos, inverse_props)},
    [KIND_BOUNDARY] = {sizeof(sph_boundary), UP_TO(sph_boundary, steps)},
    [KIND_KERNEL] = {sizeof(sph_kernel), UP_TO(sph_kernel, terms)},
    [KIND_SCHEME] = {sizeof(sph_scheme), UP_TO(sph_scheme, rates)},
    [KIND_EXACT] = {sizeof(sph_exact), UP_TO(sph_exact, run)},
};

struct block {
    struct block *next;
    max_align_t data[];
};

/* Zeroed memory that lives as long as the chain. */
static void *take(void **memory, size_t size, struct error *e)
{
    struct block *b = calloc(1, sizeof(*b) + size);

    if (!b) {
        error_memory(e, "a descriptor", size);
        return NULL;
    }
    b->next = *memory;
    *memory = b;
    return b->data;
}

void copy_free(void *memory)
{
    struct block *b = memory;

    while (b) {
        struct block *next = b->next;
        free(b);
        b = next;
    }
}

int copy_struct(void *out, size_t host, const void *in, size_t first, const char *what,
                struct error *e)
{
    uint32_t size;
    uint32_t today = (uint32_t)host;

    if (!reach_bytes(in, sizeof(size)))
        return error_set(e, EXIT_REFUSED, "pointer to the %s is %p, where nothing is", what, in);
    memcpy(&size, in, sizeof(size));
    if (size < first)
        return error_set(e, EXIT_REFUSED,
                         "size of the %s is %u bytes, but its first version had %zu", what, size,
                         first);
    if (size > COPY_LARGEST)
        return error_set(e, EXIT_REFUSED, "size of the %s is %u bytes, which is absurd (limit %u)",
                         what, size, COPY_LARGEST);
    if (!reach_bytes(in, size < host ? size : host))
        return error_set(e, EXIT_REFUSED, "size of the %s is %u bytes, but there are fewer", what,
                         size);
    memset(out, 0, host);
    memcpy(out, in, size < host ? size : host);
    memcpy(out, &today, sizeof(today));
    return 0;
}

/* Replaces a list over the plugin's elements by one over copies of today's size. */
static int copy_list(void **memory, sph_list *list, size_t host, size_t first, const char *what,
                     struct error *e)
{
    const sph_list in = *list;
    const size_t part = in.stride < host ? in.stride : host;
    char *out;

    *list = (sph_list){NULL, 0, (uint32_t)host};
    if (in.count == 0)
        return 0;
    if (!in.data)
        return error_set(e, EXIT_REFUSED, "list of %s says %u elements, but its data is NULL", what,
                         in.count);
    if (in.count > COPY_LONGEST)
        return error_set(e, EXIT_REFUSED, "list of %s says %u elements, which is absurd (limit %u)",
                         what, in.count, COPY_LONGEST);
    if (in.stride < first || in.stride > COPY_LARGEST)
        return error_set(e, EXIT_REFUSED,
                         "list of %s has a stride of %u bytes, but an element's first version had "
                         "%zu",
                         what, in.stride, first);
    if (!reach_bytes(in.data, (size_t)(in.count - 1) * in.stride + part))
        return error_set(e, EXIT_REFUSED,
                         "list of %s says %u elements at %p, where there are not so many", what,
                         in.count, in.data);
    out = take(memory, in.count * host, e);
    if (!out)
        return -1;
    for (uint32_t i = 0; i < in.count; i++)
        memcpy(out + i * host, (const char *)in.data + (size_t)i * in.stride, part);
    list->data = out;
    list->count = in.count;
    return 0;
}

static const char *text_or_empty(const char *s)
{
    return s ? s : "";
}

static int copy_props(void **memory, sph_list *list, const char *what, struct error *e)
{
    sph_prop *prop;

    if (copy_list(memory, list, sizeof(sph_prop), first_prop, what, e))
        return -1;
    prop = (sph_prop *)list->data;
    for (uint32_t i = 0; i < list->count; i++) {
        prop[i].unit = text_or_empty(prop[i].unit);
        prop[i].doc = text_or_empty(prop[i].doc);
    }
    return 0;
}

static const sph_item *copy_item(void **memory, const sph_item *in, struct error *e)
{
    sph_item *out;
    sph_param *param;

    if (!in) {
        error_set(e, EXIT_REFUSED, "item is NULL");
        return NULL;
    }
    out = take(memory, sizeof(*out), e);
    if (!out || copy_struct(out, sizeof(*out), in, first_item, "item", e) ||
        copy_list(memory, &out->params, sizeof(sph_param), first_param, "params", e) ||
        copy_props(memory, &out->props, "props", e))
        return NULL;
    out->source = text_or_empty(out->source);
    param = (sph_param *)out->params.data;
    for (uint32_t i = 0; i < out->params.count; i++) {
        param[i].unit = text_or_empty(param[i].unit);
        param[i].doc = text_or_empty(param[i].doc);
    }
    return out;
}

static int copy_life(void **memory, const sph_life **life, struct error *e)
{
    sph_life *out;

    if (!*life)
        return 0;
    out = take(memory, sizeof(*out), e);
    if (!out || copy_struct(out, sizeof(*out), *life, first_life, "life", e))
        return -1;
    *life = out;
    return 0;
}

static int copy_rates(void **memory, sph_list *list, struct error *e)
{
    return copy_list(memory, list, sizeof(sph_rate), first_rate, "rates", e);
}

static int copy_steps(void **memory, sph_list *list, struct error *e)
{
    return copy_list(memory, list, sizeof(sph_step), first_step, "steps", e);
}

static int copy_values(void **memory, sph_list *list, const char *what, struct error *e)
{
    return copy_list(memory, list, sizeof(sph_device_value), first_value, what, e);
}

static int copy_device(void **memory, const sph_device_body **device, struct error *e)
{
    sph_device_body *out;

    if (!*device)
        return 0;
    out = take(memory, sizeof(*out), e);
    if (!out || copy_struct(out, sizeof(*out), *device, first_device, "device body", e) ||
        copy_values(memory, &out->i, "i of the device body", e) ||
        copy_values(memory, &out->j, "j of the device body", e) ||
        copy_values(memory, &out->sum, "sum of the device body", e) ||
        copy_values(memory, &out->min, "min of the device body", e) ||
        copy_values(memory, &out->max, "max of the device body", e) ||
        copy_values(memory, &out->param, "param of the device body", e))
        return -1;
    *device = out;
    return 0;
}

/* `of`: which member of the descriptor. */
static int copy_point(void **memory, const sph_device_point **point, const char *of,
                      struct error *e)
{
    static const char *const names[] = {"in", "out", "inout", "param", "state"};
    sph_device_point *out;
    char what[64];

    if (!*point)
        return 0;
    out = take(memory, sizeof(*out), e);
    if (!out || copy_struct(out, sizeof(*out), *point, first_point, of, e))
        return -1;
    sph_list *const lists[] = {&out->in, &out->out, &out->inout, &out->param, &out->state};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        snprintf(what, sizeof(what), "%s of %s", names[i], of);
        if (copy_values(memory, lists[i], what, e))
            return -1;
    }
    snprintf(what, sizeof(what), "fail of %s", of);
    if (copy_list(memory, &out->fail, sizeof(const char *), sizeof(const char *), what, e))
        return -1;
    *point = out;
    return 0;
}

static int copy_function(void **memory, sph_function *f, struct error *e)
{
    if (copy_life(memory, &f->life, e) || copy_device(memory, &f->device, e) ||
        copy_point(memory, &f->device_run, "device_run", e) ||
        copy_point(memory, &f->device_before, "device_before", e) ||
        copy_point(memory, &f->device_after, "device_after", e) || copy_rates(memory, &f->rates, e))
        return -1;
    /* Left out, that is zero, it is its default. */
    if (f->reach_scale == 0)
        f->reach_scale = 1;
    return copy_list(memory, &f->reductions, sizeof(sph_reduction), first_reduction, "reductions",
                     e);
}

static int copy_eos(void **memory, sph_eos *eos, struct error *e)
{
    if (copy_life(memory, &eos->life, e) || copy_point(memory, &eos->device, "device", e))
        return -1;
    return copy_props(memory, &eos->inverse_props, "inverse_props", e);
}

static int copy_kernel(void **memory, sph_kernel *k, struct error *e)
{
    for (int dim = 1; dim <= 3; dim++)
        if (copy_list(memory, &k->terms[dim], sizeof(sph_kernel_term), first_term, "terms", e))
            return -1;
    return 0;
}

static int copy_scheme(void **memory, sph_scheme *s, struct error *e)
{
    return copy_steps(memory, &s->steps, e) ? -1 : copy_rates(memory, &s->rates, e);
}

const sph_population *copy_population(void **memory, const sph_population *in, struct error *e)
{
    sph_population *out = take(memory, sizeof(*out), e);

    if (!out || copy_struct(out, sizeof(*out), in, first_population, "descriptor", e) ||
        copy_props(memory, &out->born_props, "born_props", e))
        return NULL;
    return out;
}

const sph_state *copy_state(void **memory, const sph_state *in, struct error *e)
{
    sph_state *out = take(memory, sizeof(*out), e);

    return !out || copy_struct(out, sizeof(*out), in, first_state, "descriptor", e) ? NULL : out;
}

const sph_fusion *copy_fusion(void **memory, const sph_fusion *in, struct error *e)
{
    sph_fusion *out = take(memory, sizeof(*out), e);

    if (!out || copy_struct(out, sizeof(*out), in, first_fusion, "descriptor", e) ||
        copy_list(memory, &out->parts, sizeof(const char *), sizeof(const char *), "parts", e))
        return NULL;
    return out;
}

/* Where a descriptor keeps its item, by kind. */
static const sph_item **item_of(enum kind kind, void *descriptor)
{
    switch (kind) {
    case KIND_FUNCTION:
        return &((sph_function *)descriptor)->item;
    case KIND_EOS:
        return &((sph_eos *)descriptor)->item;
    case KIND_BOUNDARY:
        return &((sph_boundary *)descriptor)->item;
    case KIND_KERNEL:
        return &((sph_kernel *)descriptor)->item;
    case KIND_SCHEME:
        return &((sph_scheme *)descriptor)->item;
    case KIND_EXACT:
        return &((sph_exact *)descriptor)->item;
    case KIND_COUNT:
        break;
    }
    return NULL;
}

const sph_item *copy_item_of(enum kind kind, const void *copy)
{
    return *item_of(kind, (void *)copy);
}

static int copy_rest(enum kind kind, void **memory, void *out, struct error *e)
{
    switch (kind) {
    case KIND_FUNCTION:
        return copy_function(memory, out, e);
    case KIND_EOS:
        return copy_eos(memory, out, e);
    case KIND_BOUNDARY:
        return copy_steps(memory, &((sph_boundary *)out)->steps, e);
    case KIND_KERNEL:
        return copy_kernel(memory, out, e);
    case KIND_SCHEME:
        return copy_scheme(memory, out, e);
    case KIND_EXACT:
        return copy_life(memory, &((sph_exact *)out)->life, e);
    case KIND_COUNT:
        break;
    }
    return error_set(e, EXIT_REFUSED, "unknown kind");
}

const void *copy_descriptor(enum kind kind, const void *descriptor, void **memory, struct error *e)
{
    const sph_item **item;
    void *out;

    *memory = NULL;
    out = take(memory, size_of[kind].host, e);
    if (!out ||
        copy_struct(out, size_of[kind].host, descriptor, size_of[kind].first, "descriptor", e))
        return NULL;
    item = item_of(kind, out);
    *item = copy_item(memory, *item, e);
    if (!*item)
        return NULL;
    if (copy_rest(kind, memory, out, e)) {
        /* The name is there, if only for the sentence. */
        if (check_is_name((*item)->name))
            error_prefix(e, "\"%s\"", (*item)->name);
        return NULL;
    }
    return out;
}
