/* run/sums.h -- sums over the particles of all ranks, taken one number at a time in the particles' order: where the
 * order of sums is strict they are exact, so that no bit depends on who holds which particle. */
#ifndef RUN_SUMS_H
#define RUN_SUMS_H

#include "base/exact_sum.h"
#include "run/run.h"

struct sums {
    size_t n;
    double *value;           /* [n]: so far, of this rank; behind sums_share of all */
    struct exact_sum *exact; /* [n], or NULL */
};

/* n zeros; to be closed in any case. */
int sums_open(struct sums *s, const struct run *r, size_t n, struct error *e);
void sums_close(struct sums *s);
/* All ranks call it, once. */
int sums_share(struct sums *s, const struct run *r, struct error *e);

static inline void sums_add(struct sums *s, size_t k, double more)
{
    if (s->exact)
        exact_add(&s->exact[k], more);
    else
        s->value[k] += more;
}

#endif
