/* neighbours/skin.h -- whether neighbour lists are still right: where particles were when the
 * lists were made, kept compactly, against where they are.
 *
 * Positions are kept in 16 bits an axis within the box of 64 particles, h in 16 bits with 11
 * digits unless they are all the same: some 7 to 9 bytes a particle in 3D. What rounding can have
 * hidden is added to the displacement and taken off h, so the answer errs on the safe side: by less
 * than 0.001 of the
 * reach, 1 % of a skin of 0.1. Blocks that are too wide for that (with a particle that has flown
 * away) or whose h differ too much are kept as they are. On several ranks all are kept as they are besides. */
#ifndef NEIGHBOURS_SKIN_H
#define NEIGHBOURS_SKIN_H

#include "neighbours/neighbours.h"

struct skin_block;

enum skin_form {
    SKIN_SHORT,  /* rounded wherever that is safe */
    SKIN_PLACES, /* the same, and beside it what there was before rounding, for skin_places */
    SKIN_EXACT /* nothing is rounded: changes are those of the particles alone, however they stand in blocks */
};

struct skin {
    int dim;
    bool even;           /* all h were the same, and are not kept one by one */
    enum skin_form form; /* set by who owns it */
    size_t n, n_block, n_exact;
    struct skin_block *block;
    uint16_t *code; /* [n_block][dim, and 1 unless even][64]: positions and h */
    double *exact;  /* [n_exact][dim + 1][64] */
    size_t block_capacity, exact_capacity;
};

/* What has happened since, in units of length. NAN once a number is none. */
struct skin_change {
    double moved; /* no particle has moved further */
    double room;  /* the least of (1 + skin) * reach then - reach now */
};

/* Begin with zeros; keeping again uses the memory again. A change is also told of a cloud whose h is NULL:
 * its h are what they were. */
int skin_keep(struct skin *s, const struct cloud *c, int threads, struct error *e);
struct skin_change skin_change(const struct skin *s, const struct cloud *c, double relative,
                               int threads);
/* What was kept of n particles from `first` on, a multiple of SKIN_PIECE; memory is s's. */
#define SKIN_PIECE 512
struct skin skin_part(const struct skin *s, size_t first, size_t n);
/* Of two sets of particles: what has happened to both. A NaN comes through. */
static inline struct skin_change skin_both(struct skin_change a, struct skin_change b)
{
    const double none = (a.moved + b.moved) * 0;

    return (struct skin_change){(a.moved > b.moved ? a.moved : b.moved) + none,
                                a.room < b.room ? a.room : b.room};
}
/* Whether lists still hold all pairs of the particles that this is of; not if a number is none. */
static inline bool skin_holds(struct skin_change all)
{
    return 2 * all.moved <= all.room;
}
/* The places and h of n particles from `first` on, if nothing of them was rounded: false otherwise. x: [dim]. */
bool skin_places(const struct skin *s, size_t first, size_t n, double *const *x, double *h);
/* Into a checkpoint or out of it, as it is. */
int skin_store(struct skin *s, struct store *store, struct error *e);
void skin_fini(struct skin *s);
size_t skin_bytes(const struct skin *s);

#endif
