/* run/frames.h -- what lists.c and device_lists.c ask of a plan's frames: where neighbours are looked for, how far,
 * and for whom. */
#ifndef RUN_FRAMES_H
#define RUN_FRAMES_H

#include "run/run.h"

/* Lists are made so often between two sorts of the particles. */
#define BUILDS_PER_SORT 16

/* Reach in units of h. */
static inline double frame_support(const struct plan *plan)
{
    return plan->kernel.support * plan->reach_scale;
}

/* The columns in which a frame's neighbours are looked for: places, and h. */
static inline int frame_place(const struct run *r, size_t frame, size_t array)
{
    const struct plan_array *a = &r->plan->array[array];
    const struct frame *f = &r->plan->frame[frame];
    return frame == 0 ? a->position : particles_find(&a->p, f->frozen ? f->kept : f->name);
}

static inline int frame_reach(const struct run *r, size_t frame, size_t array)
{
    const struct plan_array *a = &r->plan->array[array];
    const struct frame *f = &r->plan->frame[frame];
    return f->frozen ? particles_find(&a->p, f->kept_h) : a->smoothing;
}

/* Does any list of this frame have this array? */
static inline bool frame_has(const struct run *r, size_t frame, size_t array)
{
    for (size_t k = 0; k < r->plan->n_list; k++) {
        const struct plan_list *l = &r->plan->list[k];
        if (l->frame == frame && (l->dst == array || l->src == array))
            return true;
    }
    return false;
}

#endif
