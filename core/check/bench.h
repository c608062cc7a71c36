/* check/bench.h -- particles for one call of a plugin: an array of destinations, which are sources
 * too, and a second array of sources, with columns for what is declared, neighbour lists, and a
 * batch over them. */
#ifndef CHECK_BENCH_H
#define CHECK_BENCH_H

#include "check/subject.h"
#include "check/watch.h"
#include "domain/sides.h"
#include "neighbours/neighbours.h"

#define BENCH_WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* What is called: a function, or one of the point functions of an equation of state or exact
 * solution. */
struct pass_spec {
    const char *label; /* "run", "inverse" */
    const sph_list *props;
    uint32_t shape, reach, max_sweeps;
    double reach_scale;
    const char *unfinished;
    const char *ones; /* an int32 property that holds 1, not 0; or NULL */
    sph_range_fn prepare, before, run, after;
};

/* How the destinations stand. */
enum layout {
    LAYOUT_REGULAR, /* a jittered lattice in a periodic box */
    LAYOUT_CLUSTER, /* the same without the box's images */
    LAYOUT_ALONE    /* nobody is within reach of another */
};

struct bench_shape {
    int dim;
    enum layout layout;
    size_t n;
    bool second;  /* sources from the second array too */
    double shift; /* of all positions, in box lengths */
};

struct bench {
    const struct subject *subject;
    const struct pass_spec *spec;
    struct bench_shape shape;
    struct use use;
    struct box box;
    struct ghosts ghosts;
    struct particles own, other; /* destinations; the second sources */
    struct particles shut;       /* what is declared for sources only, as a destination sees it */
    int *own_column, *other_column, *shut_column; /* [property], -1: none */
    int *own_access, *other_access, *shut_access; /* [column] */
    int x, h;                                     /* columns of own and other; -1 */
    struct watched watched[3];
    struct group_list list[2]; /* from own, from other */
    uint64_t *begin[2];        /* the lists in watched memory */
    sph_span *span[2];
    uint16_t *step[2];
    sph_kernel_form kernel;
    sph_column *dst, *src[2], *alone; /* alone: what before and after are given for dst */
    double *param;
    double spacing, support;
};

/* Everything filled, the use created, `prepare` called once. 0; -1 with the sentence. */
int bench_make(struct bench *b, const struct subject *s, const struct pass_spec *spec,
               const struct bench_shape *shape, struct error *e);
/* Destroys the use and shuts all columns for good: whoever touches them later keeps a pointer. The
 * bench stays where it is until the child ends. */
void bench_close(struct bench *b);

/* The lists made anew. */
int bench_lists(struct bench *b, struct error *e);
/* Likewise after h has changed, and what is written copied to the ghosts. */
int bench_refresh(struct bench *b, struct error *e);
/* Columns as declared (true), or all open to us. */
void bench_protect(struct bench *b, bool on);
/* A batch over nothing yet: no range, no sources. */
sph_batch bench_batch(const struct bench *b);
/* Adds the sources of array k (0 own, 1 other). */
void bench_sources(const struct bench *b, sph_batch *batch, int k);

/* "2 dimensions, 1000 particles" */
const char *bench_words(const struct bench *b, char *out, size_t size);

static inline uint32_t bench_count(const struct bench *b)
{
    return b->spec->props->count;
}
static inline const sph_prop *bench_prop(const struct bench *b, uint32_t k)
{
    return list_at(b->spec->props, k);
}
static inline struct column *bench_column(const struct bench *b, uint32_t k)
{
    return b->own_column[k] < 0 ? NULL : &b->own.column[b->own_column[k]];
}

/* bench_fill.c: positions and values. */
void bench_place(struct bench *b);
void bench_values(struct bench *b);

#endif
