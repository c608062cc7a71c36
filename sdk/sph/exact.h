/* sph/exact.h -- an exact solution, for error norms: fields at given positions and a given time. */
#ifndef SPH_EXACT_H
#define SPH_EXACT_H

#include <sph/batch.h>
#include <sph/item.h>

SPH_BEGIN_DECLS

#define SPH_KIND_EXACT "sph.exact/0"
typedef struct sph_exact {
    uint32_t size, reserved;
    const sph_item *item; /* props: x (read) and the fields it knows (write) */
    const sph_life *life;
    sph_range_fn run; /* at batch->time */
} sph_exact;

SPH_END_DECLS
#endif
