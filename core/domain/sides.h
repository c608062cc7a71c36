/* domain/sides.h -- the domain's box and its sides: open, periodic or mirror, and the ghosts that
 * they make. A ghost is a copy of a real particle, shifted or reflected; which one and how is kept,
 * so that its columns can be refreshed when a pass has changed them. Edges and corners are images
 * of images, axis by axis. */
#ifndef DOMAIN_SIDES_H
#define DOMAIN_SIDES_H

#include "particles/particles.h"

enum side { SIDE_OPEN, SIDE_PERIODIC, SIDE_MIRROR };

struct box {
    int dim;
    bool bounded; /* false: no domain was given; all sides open */
    double min[3], max[3];
    enum side side[3][2]; /* [axis][0 low, 1 high] */
};

struct ghosts {
    uint32_t *parent;   /* [n_ghost]: real particle that ghost n + k copies */
    uint8_t *image;     /* [n_ghost]: 2 bits an axis: 0 none, 1 across the low side, 2 across the high */
    size_t n, capacity;
};

void ghosts_fini(struct ghosts *g);

/* Wraps positions across periodic sides and reflects those that crossed a mirror (velocity too:
 * every SPH_VECTOR `state` column but x). Returns the number moved. */
size_t sides_wrap(const struct box *box, struct particles *p);

/* Makes ghosts of every real particle within reach of a side: reach[i] is the distance up to which
 * particle i must be seen (its own support and that of its neighbours: see below), margin the
 * largest support of any particle of any array, both with skin. A particle gets a ghost across a
 * side if it is nearer to it than max(reach[i], margin). Appends to p (resizes) and fills x and h.
 * Fails when a periodic box is narrower than twice the margin: "... use a larger box". */
int ghosts_make(struct ghosts *g, const struct box *box, struct particles *p, double margin,
                struct error *e);

/* Copies column `c` from parents to ghosts; x is shifted or reflected, vectors and tensors are
 * reflected across mirrors. */
void ghosts_refresh(const struct ghosts *g, const struct box *box, struct particles *p, int c);

#endif
