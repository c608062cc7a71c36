/* opencl/kernels_private.h -- between kernels.c (builds, launches) and kernels_text.c, kernels_sweep.c (write). */
#ifndef OPENCL_KERNELS_PRIVATE_H
#define OPENCL_KERNELS_PRIVATE_H

#include "opencl/kernels.h"
#include <stdio.h>

#define KERNELS_GROUPS 16u  /* groups that a work item takes, of vectors */
#define KERNELS_POINTS 512u /* destinations, where nothing is swept */
#define KERNELS_ITEMS 64u   /* of a work group, a destination each */
/* What a body fails of is told by one number: 1 + FAILURES * pass + that of its sentence, behind those of the
 * roles before its own (before, after, point). */
#define FAILURES 256u
static inline uint32_t failures_before(int role)
{
    return (uint32_t)role * (FAILURES / 4);
}

/* What a stage's kernel does: all, or, of a phased one, one part. */
enum kernel_part { PART_ALL, PART_BEFORE, PART_SWEEP, PART_AFTER, PART_COUNT };

/* Sources that some pass of a stage sweeps over. */
struct sweep_source {
    size_t array, list;
};

/* A stage, and what its kernels are handed: n, time, dt, quantum, step, sweep, numbers, table, failure; then
 * of each array wide, narrow, plane; then of each source begin, common, step. */
struct stage_shape {
    const struct stage *stage;
    size_t number;
    size_t *array; /* the first: destinations' */
    size_t n_array;
    struct sweep_source *source;
    size_t n_source;
    bool phased;
};
int stage_shape_make(struct stage_shape *shape, const struct plan *plan, const struct stage *stage,
                     size_t number, struct error *e);
void stage_shape_free(struct stage_shape *shape);
/* "stage_3", "stage_3_sweep" */
void stage_kernel_name(char *out, size_t size, const struct stage_shape *shape,
                       enum kernel_part part);

/* Where a pass has its numbers: parameters, then what its bodies read of its state. */
struct pass_numbers {
    size_t param, state;
    uint32_t n_param, n_state;
};
/* [plan->n_pass]; *total of them. */
struct pass_numbers *pass_numbers_make(const struct plan *plan, size_t *total);

/* A pass's bodies for devices; NULL: it has none there, or needs none. */
const sph_device_body *pass_body(const struct pass *p);
const sph_device_point *pass_before(const struct pass *p);
const sph_device_point *pass_after(const struct pass *p);
const sph_device_point *pass_point(const struct pass *p);

/* What a text is written from. */
struct kernel_text {
    FILE *out;
    const struct plan *plan;
    const struct arena *arena;
    const struct pass_numbers *numbers;
    const struct stage_shape *shape;
    bool vectors;
};
static inline const struct pass *text_pass(const struct kernel_text *t, size_t k)
{
    return &t->plan->pass[t->shape->stage->pass[k]];
}

/* kernels_words.c: words, and the form of W, for a set of lanes: "f64x8". */
void put_words(struct kernel_text *t, const char *set, int width, bool floats);
/* A text of a plugin under the name of its file; in_floats: its numbers without a suffix are floats. */
void put_body(FILE *out, const char *text, const char *file, bool in_floats);
/* Macros in front of a body, and their end. */
void put_prelude(FILE *out, const char *text, const char *file, bool in_floats);
void put_prelude_end(FILE *out, const char *text);

/* kernels_sweep.c: the sweeps over all sources, and what they come to. */
void put_sweeps(struct kernel_text *t);
void put_sums(struct kernel_text *t, size_t k);
void put_accumulators(struct kernel_text *t);

/* kernels_text.c: the whole; the caller frees it. */
char *kernels_text(const struct plan *plan, const struct arena *arena,
                   const struct stage_shape *shape, size_t n, const struct pass_numbers *numbers,
                   bool vectors, struct error *e);

#endif
