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

/* Periodic sides come in pairs. */
static inline bool sides_periodic(const struct box *box, int axis)
{
    return box->bounded && box->side[axis][0] == SIDE_PERIODIC &&
           box->side[axis][1] == SIDE_PERIODIC;
}

static inline bool sides_mirror(const struct box *box, int axis, int high)
{
    return box->bounded && box->side[axis][high] == SIDE_MIRROR;
}

struct ghosts {
    uint32_t *parent; /* [n_ghost]: real particle that ghost n + k copies */
    uint8_t *image;   /* [n_ghost]: 2 bits an axis: it stands 1 below the low side, 2 above the
                         * high side, 0 neither */
    size_t n, capacity;
};

void ghosts_fini(struct ghosts *g);
/* Room for n of them. */
int ghosts_reserve(struct ghosts *g, size_t n, struct error *e);
/* Into a checkpoint or out of it: of the ghosts of n real particles. */
int ghosts_store(struct ghosts *g, struct store *s, size_t n, struct error *e);

/* Whether component k of a property (SPH_VECTOR ...) changes sign at a mirror across `axis`. */
bool sides_turn(uint32_t type, int dim, uint32_t k, int axis);

/* Wraps positions across periodic sides (to min <= x < max) and reflects those that crossed a
 * mirror, however far they went; a reflection turns vectors and tensors too, in every `state`
 * column but x. Positions that are not finite stay as they are. Returns the number of particles
 * moved. */
size_t sides_wrap(const struct box *box, struct particles *p);

/* Makes ghosts of every real particle that is nearer than `margin` to a side behind which its
 * image stands: the largest support of any particle of any array, skin included, so that a pair
 * within reach of either is seen. Wrap first. Appends to p (resizes), in cell order (neighbours.h)
 * of cells as wide as the margin, and fills x and h.
 *
 * There is one layer of images, so a domain between two periodic or two mirror sides must be as
 * wide as the margin: else fails, "... use a larger box". Between one and two margins a particle
 * may see a neighbour and its image, or its own image; that is what an endless row looks like. */
int ghosts_make(struct ghosts *g, const struct box *box, struct particles *p, double margin,
                struct error *e);

/* Whether the domain is so wide along an axis; `name` is the array's, for the sentence. */
int sides_check_width(const struct box *box, int axis, double margin, const char *name,
                      struct error *e);

/* An image's code: two bits an axis, IMAGE_LOW: below the low side, IMAGE_HIGH: above the high one. */
#define IMAGE_LOW 1u
#define IMAGE_HIGH 2u
/* Whether there is one across that side of an axis. */
bool sides_has_image(const struct box *box, int axis, unsigned image);
/* A coordinate as it is there. */
double sides_image(const struct box *box, int axis, unsigned image, double x);
/* The bits of codes by which component k of a real column is another in an image. */
unsigned sides_changing(const struct box *box, int dim, const struct column *c, uint32_t k);
/* Component k of a real column's value as it is in an image with that code. */
double sides_value(const struct box *box, int dim, const struct column *c, uint32_t k,
                   unsigned code, double value);

/* Copies column `c` from parents to ghosts; x is shifted or reflected, vectors and tensors are
 * reflected across mirrors. */
void ghosts_refresh(const struct ghosts *g, const struct box *box, struct particles *p, int c);

#endif
