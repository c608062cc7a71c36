/* opencl/arena.h -- a particle array on a device: its columns in two buffers, and which side's copy is right.
 *
 * Column c, component k of particle i is element (place.slot + k) * plane + i of the buffer of its element
 * size: `wide` (8 bytes) or `narrow` (4). Mirrors (floats; whole numbers of a quantum for the position)
 * stand in `narrow` as well. Ghosts follow the real particles as on the host. All that a column holds on the
 * host it holds here, bit for bit: a transfer converts nothing. */
#ifndef OPENCL_ARENA_H
#define OPENCL_ARENA_H

#include "opencl/device.h"
#include "particles/particles.h"

struct arena_place {
    uint32_t size;  /* bytes of an element: 8 or 4 */
    uint32_t slot;  /* of component 0 */
    int32_t mirror; /* slot in `narrow`, or -1 */
};

struct arena {
    struct device *d;
    struct particles *p; /* the host's: names, types, n */
    struct device_buffer wide, narrow;
    size_t plane;              /* elements of a slot: at least n + n_ghost + PARTICLES_PAD */
    uint32_t n_wide, n_narrow; /* slots */
    size_t n, n_ghost;         /* on the device */
    struct arena_place *place; /* [column] */
    bool *here;                /* [column]: the device's copy is right */
    bool *there;               /* [column]: the host's is */
};

/* Places for all columns as they are held on the host now (particles_hold, particles_mirror: before). Nothing is
 * copied yet: all is there, nothing here. */
int arena_init(struct arena *a, struct device *d, struct particles *p, struct error *e);
/* The places alone, without a device: for texts. */
int arena_plan(struct arena *a, struct particles *p, struct error *e);
void arena_fini(struct arena *a);
/* Bytes that it will need on the device for so many particles. */
size_t arena_bytes(const struct arena *a, size_t n);

/* Room for n + n_ghost particles on the device; what real particles have is kept. */
int arena_resize(struct arena *a, size_t n, size_t n_ghost, struct error *e);
/* Room for so many ghosts from the start, while nothing is here yet: later, columns would move to a larger buffer
 * beside the old one. */
int arena_room(struct arena *a, size_t n_ghost, struct error *e);
/* The device's copy is right afterwards, if either is (real particles, not ghosts, not the mirror). */
int arena_put(struct arena *a, int column, struct error *e);
/* The host's copy is, likewise: of real particles. Resizes the host's array to the device's n, with no ghosts there, if the
 * two differ. */
int arena_get(struct arena *a, int column, struct error *e);
/* One side has written it: the other's is old. */
static inline void arena_written_here(struct arena *a, int column)
{
    a->here[column] = true;
    a->there[column] = false;
}
static inline void arena_written_there(struct arena *a, int column)
{
    a->here[column] = false;
    a->there[column] = true;
}

#endif
