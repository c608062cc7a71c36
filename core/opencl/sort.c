/* opencl/sort.c -- running sums and sorts on a device (see sort.h; the kernels are sort.cl). A
 * processor's work items take few long stretches, with digits of 11 bits, a GPU's many short ones
 * with digits of 4. */
#include "config.h"

#include "opencl/sort.h"

#include "opencl/search_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WHOLE 16384 /* sums of so few are one work group's */

/* Sorts are a program of their own, built when first asked for: most runs need none. */
enum { SCAN_WHOLE, SCAN_SUMS, SCAN_PARTS, SCAN_OUT, COUNT4, MOVE4, COUNT8, MOVE8, KERNELS };

struct device_sort {
    struct device *d;
    bool cpu;
    uint32_t units, bits;
    struct device_program *program[2];
    struct device_kernel *kernel[KERNELS];
    struct device_buffer part, count, zero, key, value;
};

/* Running sums, or sorts. */
static int build(struct device_sort *s, int sorts, struct error *e)
{
    static const char *const name[KERNELS] = {
        "scan_whole",      "scan_sums",      "scan_parts",       "scan_out",
        "sort_count_uint", "sort_move_uint", "sort_count_ulong", "sort_move_ulong"};
    char options[64];

    if (s->program[sorts]) {
        return 0;
    }
    snprintf(options, sizeof options, "-DWG=%d -DSORT_BITS=%u -DSORTS=%d", s->cpu ? 1 : 64, s->bits,
             sorts);
    if (device_build(s->d, &s->program[sorts], sort_text, options, "sorting", e) != 0) {
        return -1;
    }
    for (int k = sorts ? COUNT4 : 0; k < (sorts ? KERNELS : COUNT4); k++) {
        if (device_kernel(s->d, s->program[sorts], name[k], "sort", &s->kernel[k], e) != 0) {
            return -1;
        }
    }
    return 0;
}

int device_sort_open(struct device_sort **out, struct device *d, bool cpu, struct error *e)
{
    const struct device_facts *f = device_facts(d);
    struct device_sort *s = calloc(1, sizeof *s);

    *out = s;
    if (!s) {
        return error_memory(e, "sorting on a device", sizeof *s);
    }
    s->d = d;
    s->cpu = cpu;
    s->units = f->units ? f->units : 1;
    s->bits = cpu ? 11 : 4;
    if (build(s, 0, e) != 0 ||
        device_reserve(d, &s->zero, 2 * sizeof(uint64_t), "sorting", e) != 0) {
        device_sort_close(s);
        *out = NULL;
        return -1;
    }
    return 0;
}

void device_sort_close(struct device_sort *s)
{
    if (!s) {
        return;
    }
    device_release(s->d, &s->part);
    device_release(s->d, &s->count);
    device_release(s->d, &s->zero);
    device_release(s->d, &s->key);
    device_release(s->d, &s->value);
    device_program_free(s->d, s->program[0]);
    device_program_free(s->d, s->program[1]);
    free(s);
}

/* How many of n elements a work item takes. */
static uint32_t share(const struct device_sort *s, size_t n)
{
    size_t each = s->cpu ? n / (4 * (size_t)s->units) + 1 : 512;

    each = s->cpu && each < 4096 ? 4096 : each;
    return (uint32_t)each;
}

#define LAUNCH(k, items, ...)                                                                      \
    device_launch(s->d, s->kernel[k], items, (struct device_arg[]){__VA_ARGS__},                   \
                  sizeof((struct device_arg[]){__VA_ARGS__}) / sizeof(struct device_arg), e)

int device_scan(struct device_sort *s, const struct device_buffer *in, size_t in_at, size_t n,
                const struct device_buffer *out, size_t out_at, const struct device_buffer *total,
                size_t slot, struct error *e)
{
    const uint32_t in_at4 = (uint32_t)in_at, n4 = (uint32_t)n, out_at4 = (uint32_t)out_at;
    const uint32_t slot4 = (uint32_t)slot, each = share(s, n);
    const uint32_t parts = (uint32_t)((n + each - 1) / each);
    const size_t group = s->cpu ? 1 : 64;

    if (n <= WHOLE || parts < 2) {
        return LAUNCH(SCAN_WHOLE, group, DEVICE_BUFFER(in), DEVICE_VALUE(in_at4), DEVICE_VALUE(n4),
                      DEVICE_BUFFER(out), DEVICE_VALUE(out_at4), DEVICE_BUFFER(total),
                      DEVICE_VALUE(slot4));
    }
    if (device_reserve(s->d, &s->part, parts * sizeof(uint64_t), "sorting", e) != 0 ||
        LAUNCH(SCAN_SUMS, parts, DEVICE_BUFFER(in), DEVICE_VALUE(in_at4), DEVICE_VALUE(n4),
               DEVICE_VALUE(each), DEVICE_BUFFER(&s->part)) != 0 ||
        LAUNCH(SCAN_PARTS, group, DEVICE_BUFFER(&s->part), DEVICE_VALUE(parts),
               DEVICE_BUFFER(total), DEVICE_VALUE(slot4)) != 0) {
        return -1;
    }
    return LAUNCH(SCAN_OUT, parts, DEVICE_BUFFER(in), DEVICE_VALUE(in_at4), DEVICE_VALUE(n4),
                  DEVICE_VALUE(each), DEVICE_BUFFER(&s->part), DEVICE_BUFFER(out),
                  DEVICE_VALUE(out_at4));
}

static void trade(struct device_buffer *a, struct device_buffer *b)
{
    struct device_buffer t = *a;

    *a = *b;
    *b = t;
}

int device_sort_pairs(struct device_sort *s, struct device_buffer *key, struct device_buffer *value,
                      size_t n, size_t key_bytes, unsigned bits, struct error *e)
{
    const int count = key_bytes == 4 ? COUNT4 : COUNT8, move = count + 1;
    const uint32_t n4 = (uint32_t)n, each = share(s, n);
    const uint32_t stretches = (uint32_t)((n + each - 1) / each);
    const size_t counts = ((size_t)1 << s->bits) * stretches;

    if (n < 2) {
        return 0;
    }
    if (build(s, 1, e) != 0) {
        return -1;
    }
    /* As large as the caller's, which they may become. */
    if (device_reserve(s->d, &s->key, key->bytes, "sorting", e) != 0 ||
        device_reserve(s->d, &s->value, value->bytes, "sorting", e) != 0 ||
        device_reserve(s->d, &s->count, (counts + 1) * sizeof(uint32_t), "sorting", e) != 0) {
        return -1;
    }
    for (uint32_t shift = 0; shift < bits; shift += s->bits) {
        if (LAUNCH(count, stretches, DEVICE_BUFFER(key), DEVICE_VALUE(n4), DEVICE_VALUE(each),
                   DEVICE_VALUE(stretches), DEVICE_VALUE(shift), DEVICE_BUFFER(&s->count)) != 0 ||
            device_scan(s, &s->count, 0, counts, &s->count, 0, &s->zero, 0, e) != 0 ||
            LAUNCH(move, stretches, DEVICE_BUFFER(key), DEVICE_BUFFER(value), DEVICE_VALUE(n4),
                   DEVICE_VALUE(each), DEVICE_VALUE(stretches), DEVICE_VALUE(shift),
                   DEVICE_BUFFER(&s->count), DEVICE_BUFFER(&s->key),
                   DEVICE_BUFFER(&s->value)) != 0) {
            return -1;
        }
        trade(key, &s->key);
        trade(value, &s->value);
    }
    return 0;
}
