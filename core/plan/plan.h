/* plan/plan.h -- the scene compiled against the registry: the fewest columns, passes and exchanges that
 * it needs, from what the functions declare. The plan knows no physics: only declarations. */
#ifndef PLAN_PLAN_H
#define PLAN_PLAN_H

#include "integrators/integrator.h"
#include "neighbours/neighbours.h"
#include "particles/particles.h"
#include "registry/registry.h"
#include "scene/read.h"
#include "scene/scene.h"
#include <cjson/cJSON.h>
#include <stdio.h>

enum moment { MOMENT_START, MOMENT_EVALUATE, MOMENT_FINISH, MOMENT_COUNT };
extern const char *const moment_name[MOMENT_COUNT];

/* One configured use of an item: its parameters and the plugin's own state. */
struct use {
    const struct entry *entry;
    const sph_item *item;
    const sph_life *life; /* or NULL */
    struct sph_config config;
    struct use_table *tables; /* what config.table points into */
    void *state;
};

/* A step of the recipe, before it is bound to arrays. */
struct step {
    char *name;
    enum moment moment;
    enum kind kind;          /* KIND_FUNCTION or KIND_EOS (the material's own) */
    const cJSON *node;       /* the edit that put it there, or NULL */
    const cJSON *params;     /* its own parameters, or NULL */
    const cJSON *shared;     /* parameters that it takes if it declares them, or NULL: those of its
                                 * boundary condition; the scheme's reach it in any case */
    const char **to, **from; /* not owned */
    size_t n_to, n_from;     /* 0: all */
    const char *operation, *of; /* what the scene says it is; checked; or NULL */
    const char *expression;     /* assigned to `of`; NULL: a function */
};

/* Whose places neighbours are looked for in: the position's, or another column's. What is found once
 * is found in copies of the places and of h, "X.frozen" and "X.frozen-h", which sorts carry along. */
struct frame {
    const char *name;    /* of the column; frame 0 is "x" */
    bool frozen;         /* found once */
    char *kept, *kept_h; /* of the copies; NULL: none */
};

/* Sources of one array for the destinations of another, that some pass asks for. */
struct plan_list {
    size_t dst, src, frame;
    uint32_t reach; /* SPH_GATHER or SPH_SYMMETRIC */
};

/* How exactly a run computes (README, precision). */
enum precision {
    PRECISION_DOUBLE, /* everything in doubles */
    PRECISION_MIXED,  /* pair sums in floats, of exact differences of positions; state in doubles */
    PRECISION_SINGLE  /* all but the positions in floats */
};
extern const char *const precision_name[3];

/* The columns of a pass in one array, in the item's declared order. */
struct binding {
    size_t array;
    int *column;
};

/* One function (or equation of state) on one destination array, over all its sources. */
struct pass {
    char *name; /* "density(fluid)" */
    const char *step;
    enum moment moment;
    struct use use;
    uint32_t shape; /* SPH_POINT or SPH_PAIR */
    sph_range_fn before, run, after;
    uint32_t reach;
    uint32_t max_sweeps;
    int unfinished;  /* column of the destination, or -1 */
    bool *continues; /* [props]: a summed rate that an earlier pass of the moment has begun */
    const sph_function *function; /* NULL for an equation of state */
    struct binding dst;
    struct binding *src;
    size_t *list; /* [n_src]: index into plan.list */
    size_t n_src;
    size_t frame;
    uint32_t real;                 /* what its sweeps work in: SPH_F64 or SPH_F32 */
    bool local;                    /* a destination may be finished before another is begun */
    struct assignment *assignment; /* of an expression, or NULL */
    bool serial;                   /* one thread only */
    sph_column *space; /* room for columns: destination's in doubles, for sweeps, each source's */
    /* Cost, filled in by the run. */
    double seconds;
    uint64_t sweeps, pairs;
};

/* A rate of an array: column y advances with column r. */
struct rate {
    int property, rate;
    uint32_t kind;        /* SPH_KICK or SPH_DRIFT */
    int saved;            /* column of what the integrator keeps of the rate, or -1 */
    int kept[SLOT_COUNT]; /* of the property, by slot, or -1; the first is the property's own */
    size_t closed;        /* the pass that corrects the property as it makes the rate, or NO_PASS */
    bool anew;            /* every evaluation overwrites the rate before anything reads it */
};
#define NO_PASS SIZE_MAX

/* A global reduction of a pass's column. */
struct reduction {
    const sph_reduction *declared;
    size_t pass, array;
    int column;
};

struct plan_array {
    struct particles p;
    const struct scene_array *scene;
    struct rate *rate;
    size_t n_rate;
    bool *given;     /* per column: set by a field */
    bool *required;  /* per column: an initial value is needed */
    double *initial; /* per column: declared default; NaN: none */
    bool *in_floats; /* per column: held in floats while the run goes on ... */
    bool *in_two;    /* ... with a second float each for what the first leaves out ... */
    bool *mirrored;  /* ... or in doubles with a mirror in floats */
    bool in_quanta;  /* the position: in quanta while neighbour lists hold */
    struct use eos;  /* of its material; entry NULL: none */
    int position, velocity, smoothing, mass,
        id; /* columns; velocity: the rate of the position, or -1 */
};

struct plan {
    struct registry *registry;
    const struct scene *scene;
    int dim;
    const sph_scheme *scheme;
    const char *scheme_name, *kernel_name;
    bool has_kernel;
    sph_kernel_form kernel;
    const struct integrator *integrator;
    double cfl;
    struct plan_array *array;
    size_t n_array;
    struct step *step;
    size_t n_step;
    struct pass *pass;
    size_t n_pass;
    struct reduction *reduction;
    size_t n_reduction;
    struct frame *frame;
    size_t n_frame;
    struct plan_list *list;
    size_t n_list;
    enum precision precision;
    bool
        strict; /* every sum in an order that depends on nothing but the particles' ids, or exact */
    bool on_device;                          /* runs on the scene's OpenCL device */
    const struct neighbour_manager *manager; /* NULL: as it suits */
    double skin;                             /* of neighbour lists, a fraction of the support */
    double reach_scale;                      /* largest over the functions */
    struct use *exact;                       /* of scene.compare, one each; unset for a table */
    struct table *compare_table;             /* of scene.compare, one each; empty for the exact */
    struct table *probe_table;               /* references of scene.probe, one each */
    struct use *profile_exact; /* of scene.profile, one each; unset where there is none */
    struct table *profile_table;
    int64_t next_id; /* of a particle yet to be made */
};

/* Resolves every name, checks every parameter, adds every column. guarded: for the audit. Particles are
 * not made yet. */
int plan_make(struct plan *plan, struct registry *r, const struct scene *s, bool guarded,
              struct error *e);
/* Makes the particles and completes their initial state (the inverse equation of state). */
int plan_fill(struct plan *plan, struct error *e);
void plan_free(struct plan *plan);

/* The list that some pass asks for of these arrays' positions, or NULL. */
const struct plan_list *plan_pair(const struct plan *plan, size_t dst, size_t src);
/* Bytes of a particle of an array while the run goes on: columns and their mirrors. */
size_t plan_bytes(const struct plan *plan, size_t array);
/* Particles of an array, made or to be made; true neighbours of one, in all arrays, in a uniform filling. */
uint64_t plan_count(const struct plan *plan, size_t array);
double plan_neighbours(const struct plan *plan, size_t array);

/* Columns of array a that a pass reads from it, writes in it. */
bool pass_writes(const struct pass *p, size_t array, int column);
bool pass_reads_source(const struct pass *p, size_t array, int column);

/* Whether the pass can run on a device; else *why is what lacks: "function "x" of plugin "y" has no device
 * body" (backend.c). */
bool pass_on_device(const struct plan *plan, const struct pass *p, char *why, size_t size);

/* Whether anything changes the column as the run goes on: a pass, or the integrator. */
bool plan_changes(const struct plan *plan, size_t array, int column);

/* For people (80 columns) and for machines. */
void plan_print(const struct plan *plan, FILE *out);
cJSON *plan_json(const struct plan *plan);

/* What an assignment does, for a device; NULL: its expression cannot be told there. */
const sph_device_point *assignment_device(const struct assignment *a);

/* One use of an item: see struct use. */
int use_init(struct use *u, const struct entry *entry, const sph_item *item, const sph_life *life,
             struct error *e);
int use_create(struct use *u, struct registry *r, int dim, struct error *e);
void use_fini(struct use *u, struct registry *r);
/* One parameter from a JSON member of the item's; errors with their place. */
int use_set(struct use *u, const struct document *d, const cJSON *member, struct error *e);
/* All members of an object (NULL: none); one that the item does not declare is an error. */
int use_set_all(struct use *u, const struct document *d, const cJSON *members, struct error *e);
/* The same of a parameter that is a table; in tables.c. */
int use_set_table(struct use *u, const struct document *d, const cJSON *member, struct error *e);
void use_tables_free(struct use_table *t);
/* A table of the scene, and what to call it; in tables.c. Freed by table_free, also on failure. */
int plan_table(struct table *t, const struct document *d, const cJSON *member, struct error *e);
const char *plan_table_source(const cJSON *member);
/* Index of the column that runs over a coordinate: that of its name, or the first (measures.c). */
size_t plan_table_along(const struct table *t, enum along along);
/* Whether the reference of profile i tells of the k-th property that it is of; *column: where in a table. */
bool plan_profile_gives(const struct plan *plan, size_t i, size_t k, size_t *column);
/* The plugin's own state as bytes, of a use that has one (state.c). `bytes` is the caller's to free. */
struct use_state {
    void *bytes;
    uint64_t n;
    uint32_t format;
};
bool use_has_state(const struct use *u);
int use_save(const struct use *u, struct registry *r, struct use_state *out, struct error *e);
int use_restore(struct use *u, struct registry *r, const struct use_state *in, struct error *e);
/* A batch of all n particles of an array, by the columns that the use declares, with what does not
 * change in a run: parameters, state, kernel, host. */
sph_batch use_batch(const struct plan *plan, const struct use *u, const sph_column *dst,
                    uint32_t n_columns, uint64_t n);
bool use_declares(const struct use *u, const char *name);

#endif
