/* opencl/ops_private.h -- what the files ops*.c share: the kernels, and words by which they are called. */
#ifndef OPENCL_OPS_PRIVATE_H
#define OPENCL_OPS_PRIVATE_H

#include "opencl/embed.h"

#include "opencl/ops.h"

/* Texts of the files of that name; in ops_text.c. */
#define OPS_TEXT(name) extern EMBEDDED name##_text[];
OPS_TEXT(ops_words)
OPS_TEXT(ops_lanes)
OPS_TEXT(ops_columns)
OPS_TEXT(ops_reduce)
OPS_TEXT(ops_sides)

enum ops_kernel {
    K_MIRROR,
    K_PLACES,
    K_PERMUTE,
    K_ADVANCE,
    K_REDUCE,
    K_SKIN_KEEP,
    K_SKIN,
    K_PARTS,
    K_WRAP,
    K_GHOSTS_COUNT,
    K_SCAN,
    K_GHOSTS_FILL,
    K_REFRESH_POSITION,
    K_REFRESH_WIDE,
    K_REFRESH_NARROW,
    K_PACK_WIDE,
    K_PACK_NARROW,
    OPS_KERNELS
};

/* Kernels are built in two programs, the second when one of its own is first asked for: domains without sides
 * never do. */
enum { OPS_COLUMNS, OPS_SIDES, OPS_SETS };

/* A program of the integrator as it is on the device: actions, for any step. */
#define OPS_PROGRAMS 32
struct ops_program {
    void *actions; /* the same on the host */
    size_t bytes;
    struct device_buffer buffer;
};

struct ops {
    struct device *d;
    int dim;
    size_t wide; /* particles of a work item */
    struct device_program *program[OPS_SETS];
    struct device_kernel *kernel[OPS_KERNELS];
    struct device_buffer words; /* struct ops_words, then OPS_RESULTS doubles */
    struct device_buffer part, scratch, count, sides, table;
    void *box;    /* what `sides` holds; in ops_sides.c */
    void *turned; /* what `table` holds; likewise */
    size_t turned_bytes;
    struct ops_program advance[OPS_PROGRAMS];
    size_t n_advance; /* ever made; the oldest gives way */
};

/* Numbers that kernels leave in words a device can add to. */
struct ops_words {
    uint32_t flags, moved;
};

/* A slot as kernels know it: see ops_words.cl. */
#define SLOT_NARROW 0x80000000u
#define SLOT_MISSING 0xffffffffu
static inline uint32_t ops_slot(const struct arena *a, int column)
{
    if (column < 0)
        return SLOT_MISSING;
    const struct arena_place *at = &a->place[column];
    return at->slot | (at->size == 4 ? SLOT_NARROW : 0u);
}

/* Kernel `k` is built. */
int ops_build(struct ops *o, enum ops_kernel k, struct error *e);
/* Launches it for `items` work items with DEVICE_... arguments. */
#define OPS_LAUNCH(o, k, items, e, ...)                                                            \
    (ops_build(o, k, e)                                                                            \
         ? -1                                                                                      \
         : device_launch(                                                                          \
               (o)->d, (o)->kernel[k], items, (const struct device_arg[]){__VA_ARGS__},            \
               sizeof((const struct device_arg[]){__VA_ARGS__}) / sizeof(struct device_arg), e))

/* Work items for n particles where each takes o->wide of them. */
static inline size_t ops_items(const struct ops *o, size_t n)
{
    return (n + o->wide - 1) / o->wide;
}

/* The device's copy is right: put there if only the host's is. */
static inline int ops_bring(struct arena *a, int column, struct error *e)
{
    return column >= 0 && !a->here[column] && a->there[column] ? arena_put(a, column, e) : 0;
}

/* ops_open with work items of `wide` particles, 8 or 1, whatever suits the device. */
int ops_open_wide(struct ops **out, struct device *d, int dim, size_t wide, struct error *e);

/* The box in the device's own words; there already, unless it is another one. In ops_sides.c, as the next. */
int ops_put_sides(struct ops *o, const struct box *box, struct error *e);
/* Image bits that turn each component of a column, a byte each. */
void ops_turning(const struct box *box, const struct column *c, int dim, uint64_t turning[2]);

/* Programs are gone; in ops_advance.c. */
void ops_forget_programs(struct ops *o);

#endif
