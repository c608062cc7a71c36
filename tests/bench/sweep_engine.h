/* sweep_engine.h -- sweeps of plugins over a fluid's particles, driven as the core drives them: in the
 * core's columns, order and lists, with a batch for each chunk of destinations. */
#ifndef SWEEP_ENGINE_H
#define SWEEP_ENGINE_H

#include "call_per_pair.h"
#include "neighbours/neighbours.h"
#include "particles/particles.h"
#include "registry/registry.h"

enum { ENGINE_SKINS = 2, ENGINE_PROPS = 24 };
extern const double engine_skin[ENGINE_SKINS]; /* 0 and 0.1 */

struct engine {
    struct registry *registry;
    struct particles p;
    int x, h;         /* columns */
    double *place[3]; /* before any offset */
    uint32_t *was;    /* particle k was the fluid's was[k] */
    sph_kernel_form kernel;
    double quantum; /* of positions' mirrors */
    struct cloud cloud;
    struct group_list list[2][ENGINE_SKINS]; /* [gather, symmetric] */
    double pairs;                            /* true ones, directed; none with itself */
};

/* A function, its parameters and its columns. */
struct engine_use {
    const sph_function *function;
    struct sph_config config;
    int column[ENGINE_PROPS];
};

struct engine_sweep {
    const struct engine_use *use[2]; /* one after the other; the second may be NULL */
    uint32_t real, path, uniform_h;
    int skin;       /* of engine_skin */
    uint64_t chunk; /* destinations a call; 0: all */
    int threads;
};

struct engine_time {
    double cpu, wall; /* [s]; cpu: of this thread */
};

/* Each ends the program with a sentence where it cannot. */

/* Plugins of this build: the folder plugins/.libs of $top_builddir, or of this one. */
void engine_load(struct registry *r, const char *plugin);
/* The fluid's particles, in the core's order, with columns x h m v rho p cs. */
void engine_make(struct engine *g, struct registry *r, const struct pair_case *fluid,
                 const char *kernel);
void engine_free(struct engine *g);

/* A function with its default parameters; all its columns are there from now on. */
void engine_use_make(struct engine_use *u, struct engine *g, const char *function);
void engine_use_free(struct engine_use *u);

/* All particles so far away from where they were, along each axis; lists and mirrors anew. */
void engine_place(struct engine *g, double offset);
/* All mirrors anew. */
void engine_mirror(struct engine *g);

/* One sweep: sums begin at their start, then `run`. */
struct engine_time engine_run(const struct engine *g, const struct engine_sweep *s);
/* What a function does with a particle after its sweep, in doubles. */
void engine_finish(const struct engine *g, const struct engine_use *u);

/* Component c of particle i in the column, or in its mirror. */
double engine_value(const struct engine *g, int column, uint32_t real, uint32_t c, size_t i);
/* Bytes a particle that a sweep moves at least: positions, h, what it reads of sources and its lists
 * once; its sums twice. */
double engine_bytes(const struct engine *g, const struct engine_sweep *s);

#endif
