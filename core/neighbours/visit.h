/* neighbours/visit.h -- an order of sources that depends on nothing but who they are: by id, and of one id the
 * particle before its images, which go by their codes. Lists that follow it give the same sums however
 * particles stand in their array, and on whichever process they are. */
#ifndef NEIGHBOURS_VISIT_H
#define NEIGHBOURS_VISIT_H

#include "base/error.h"
#include <stddef.h>
#include <stdint.h>

/* place[i]: when source i is visited; source[k]: the k-th that is. Begin with zeros. */
struct visits {
    uint32_t *place, *source;
    size_t n, capacity;
};

/* Of n particles, and behind them n_ghost ghosts with their image codes (not 0, or 0: a particle that lives
 * elsewhere). */
int visits_make(struct visits *v, const int64_t *id, const uint8_t *image, size_t n, size_t n_ghost,
                int threads, struct error *e);
void visits_fini(struct visits *v);

#endif
