/* sph/exact.h -- an exact solution, for error norms: fields at given positions and a given time. */
#ifndef SPH_EXACT_H
#define SPH_EXACT_H

#include <sph/batch.h>
#include <sph/item.h>

SPH_BEGIN_DECLS

#define SPH_KIND_EXACT "sph.exact/0"

/* What register_item takes for SPH_KIND_EXACT. Its parameters are set where a scene compares. */
typedef struct sph_exact {
    uint32_t size, reserved;
    const sph_item *item; /* props: x (read) and the fields it knows (write); no sources */
    const sph_life *life; /* or NULL */
    sph_range_fn run;     /* the fields at x and batch->time; what it writes are no particles'
                           * columns but its own. [worker] */
} sph_exact;

SPH_END_DECLS
#endif
