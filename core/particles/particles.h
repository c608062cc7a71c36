/* particles/particles.h -- a particle array: named property columns, structure of arrays.
 *
 * Real particles stand first, [0, n); their ghosts follow, [n, n + n_ghost). Each component of a
 * column is 64-byte aligned and readable PARTICLES_PAD elements past `capacity`. A real column is
 * held in doubles, in floats, or in two floats of which the second is what the first leaves out: 48 bits,
 * of which sweeps in floats read the first half as it stands. One in doubles may have a mirror besides:
 * a copy of 4-byte elements, which whoever reads it keeps up to date. Positions may be held in whole
 * numbers of a quantum and a float for the rest, of which such sweeps read the first. Knows nothing of neighbours, scenes or
 * physics. */
#ifndef PARTICLES_PARTICLES_H
#define PARTICLES_PARTICLES_H

#include "base/error.h"
#include "base/store.h"
#include <float.h>
#include <math.h>
#include <sph/batch.h>
#include <sph/item.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define PARTICLES_PAD 64

struct column {
    char *name, *unit, *doc;
    uint32_t type;  /* SPH_SCALAR ... */
    uint32_t ncomp; /* components in this dimension */
    size_t size;    /* bytes of an element: 8 or 4; 4 of a real: floats */
    size_t plane;   /* elements from one component to the next */
    bool state;     /* carried from step to step: initial, integrated or user's; saved and sorted.
                     * Others are made anew at each evaluation. */
    bool output;    /* goes to snapshots */
    void *data;
    float *low; /* NULL, or of a real in floats: what they leave out; value = data + low */
    double quantum,
        centre[3]; /* quantum > 0: data are int32_t, value = centre + quantum (data + low) */
    void *mirror;  /* NULL, or as many elements of 4 bytes; ghosts included */
};

static inline bool column_is_real(const struct column *c)
{
    return c->type != SPH_INT32 && c->type != SPH_INT64;
}

/* What `high` leaves out of a value; nothing where there is no more to tell. */
static inline float column_rest(double value, float high)
{
    const float rest = (float)(value - (double)high);
    return fabsf(rest) <= FLT_MAX ? rest : 0.0f;
}

/* Component k of particle i of a real column, however it is held. */
static inline double column_get(const struct column *c, uint32_t k, size_t i)
{
    const size_t at = k * c->plane + i;
    if (c->size == sizeof(double))
        return ((const double *)c->data)[at];
    if (c->quantum > 0.0)
        return c->centre[k] +
               c->quantum * ((double)((const int32_t *)c->data)[at] + (double)c->low[at]);
    const double high = (double)((const float *)c->data)[at];
    return c->low ? high + (double)c->low[at] : high;
}

/* The whole number nearest to a number of quanta, without a branch: what is added leaves it in the last bits.
 * Of what is too far away, or no number, it is any; the rest makes up for that. */
static inline int32_t quanta_whole(double quanta)
{
    const double shifted = quanta + 0x1.8p52;
    uint64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    return (int32_t)(uint32_t)bits;
}

static inline void column_set(const struct column *c, uint32_t k, size_t i, double value)
{
    const size_t at = k * c->plane + i;
    if (c->size == sizeof(double)) {
        ((double *)c->data)[at] = value;
        return;
    }
    if (c->quantum > 0.0) {
        const double quanta = (value - c->centre[k]) * (1.0 / c->quantum);
        const int32_t whole = quanta_whole(quanta);
        ((int32_t *)c->data)[at] = whole;
        c->low[at] = (float)(quanta - (double)whole);
        return;
    }
    const float high = (float)value;
    ((float *)c->data)[at] = high;
    if (c->low)
        c->low[at] = column_rest(value, high);
}

/* The same of n particles from `first` on. */
void column_load(const struct column *c, uint32_t k, size_t first, size_t n, double *to);
void column_store(const struct column *c, uint32_t k, size_t first, size_t n, const double *from);
/* A hint that component k of these will be wanted soon: work that goes through columns in pieces asks for
 * the next one, since no processor sees that many columns coming by itself. */
void column_expect(const struct column *c, uint32_t k, size_t first, size_t n);

struct particles {
    char *name;
    int dim;
    size_t n, n_ghost, capacity;
    struct column *column;
    size_t n_column;
    size_t arena_bytes; /* all memory held */
    bool guarded;       /* each column on pages of its own: see particles_guard */
};

/* An empty array named `name`. Takes the name by copy. */
int particles_init(struct particles *p, const char *name, int dim, struct error *e);
void particles_fini(struct particles *p);
bool particles_is_valid(const struct particles *p);

/* Components of a type in a dimension, and bytes of an element. */
uint32_t property_ncomp(uint32_t type, int dim);
size_t property_size(uint32_t type);

/* Adds a column of zeros, or checks that the one of that name has this type. Index, or -1. */
int particles_add(struct particles *p, const char *name, const char *unit, const char *doc,
                  uint32_t type, struct error *e);
/* Index of a column, or -1. */
int particles_find(const struct particles *p, const char *name);
/* Component c of a real column, or NULL if there is no such column. */
double *particles_real(const struct particles *p, const char *name, uint32_t c);

/* From now on a real column is held in doubles (size 8) or floats (4), or with `rest` in two floats; its
 * values are kept, as well as that can be. What it pointed to is gone. */
int particles_hold(struct particles *p, int column, size_t size, bool rest, struct error *e);
/* From now on a column of positions is held in quanta. */
int particles_hold_quanta(struct particles *p, int column, const double *centre, double quantum,
                          struct error *e);
/* Gives a column held in doubles a mirror; its contents are the caller's business. */
int particles_mirror(struct particles *p, int column, struct error *e);

/* Room for n + n_ghost particles; contents are kept, new elements are zero. When n changes, what
 * the ghosts held is lost. Columns may move: fetch pointers anew. */
int particles_resize(struct particles *p, size_t n, size_t n_ghost, struct error *e);
/* Two columns of one kind, held alike, trade their elements; a mirror stays with its column, and is old. */
void particles_swap(struct particles *p, int a, int b);
/* new[i] = old[order[i]] for all real particles, in every `state` column (others become stale). */
int particles_permute(struct particles *p, const uint32_t *order, struct error *e);
/* new[i] = old[index[i]] for i < n, in every column; an index may come again, or not at all. Ghosts
 * are lost. */
int particles_gather(struct particles *p, const uint32_t *index, size_t n, struct error *e);
/* Into a checkpoint or out of it, every column as it is held, ghosts included; mirrors are not. Reading, the
 * array has its columns already. */
int particles_store(struct particles *p, struct store *s, struct error *e);
/* Out of a checkpoint, of an array that was stored there: its particles [first, first + n) become those from `at` on,
 * for which there is room. Called for at = 0 before any other, with n = 0 if need be: columns are then held as
 * they are there. */
int particles_restore(struct particles *p, struct store *s, size_t at, size_t first, size_t n,
                      struct error *e);
/* The column as the ABI hands it over; its mirror likewise, or the column itself if it is held in 4
 * bytes. */
sph_column particles_column(const struct particles *p, int column);
sph_column particles_column4(const struct particles *p, int column);
/* Bytes of a particle over all columns, mirrors included. */
size_t particles_bytes(const struct particles *p);

/* The audit: with `guarded` set before any column is added, every column lives on pages of its own;
 * particles_guard sets what may be done with it: 0 nothing, 1 read, 2 read and write. 0, or -1 if
 * the array is not guarded. Resizing and permuting open every column. Behind each stands a page
 * that nobody may touch. */
int particles_guard(struct particles *p, int column, int access);
/* The column that an address belongs to, or -1. */
int particles_at_address(const struct particles *p, const void *address);

#endif
