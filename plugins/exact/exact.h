/* exact.h -- the exact solutions of this plugin, and what they share: columns by number. */
#ifndef EXACT_H
#define EXACT_H

#include <sph/exact.h>

#include <stddef.h>

extern const sph_exact riemann;
extern const sph_exact noh;

/* Component c of declared property k, or NULL if the host did not ask for it. */
static inline double *exact_column(const sph_batch *b, uint32_t k, uint32_t c)
{
    return b->dst[k].data ? (double *)b->dst[k].data + c * b->dst[k].plane : NULL;
}

#endif
