/* scene/scene.h -- a scene file as checked structures. What a scene *names* (kernels, schemes,
 * functions, equations of state, exact solutions) is resolved by the plan, since plugins are
 * loaded after this; each such place keeps its JSON node, so that a message can point at it. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "domain/sides.h"
#include "scene/json.h"
#include "scene/shape.h"
#include <math.h>
#include <stdint.h>

/* Particles that a scene may make; more needs "limits": guards against 10^9 by a slip of the
 * pen. */
#define FILL_LIMIT 200000000ull

struct scene_material {
    const char *name;
    const cJSON *node;
    const char *eos;         /* its name, or NULL: the material has none */
    const cJSON *eos_node;   /* for messages: the object with "name", or the bare name */
    const cJSON *eos_params; /* object: the parameters alone; NULL if eos is NULL */
};

/* An initial field: one expression or number per component (a scalar has one). */
struct scene_field {
    const char *name;
    const cJSON *node; /* number, string, or array of either */
};

/* A column of the user's own. */
struct scene_column {
    const char *name;
    uint32_t type;     /* SPH_SCALAR, SPH_VECTOR, SPH_INT32 */
    const cJSON *node; /* its initial value, as a field */
};

enum fill_kind { FILL_LATTICE, FILL_GLASS, FILL_FILE };
/* square: cubic in 3D; hexagonal: hexagonal close packing in 3D */
enum lattice { LATTICE_SQUARE, LATTICE_HEXAGONAL, LATTICE_BCC, LATTICE_FCC };

/* Exactly one of spacing, count and mass is given for a lattice or a glass. */
struct scene_fill {
    const cJSON *node;
    enum fill_kind kind;
    enum lattice lattice;
    struct shape *shape;    /* inside which particles are put; NULL: the domain */
    double spacing;         /* lattice spacing: volume per particle is spacing^dim for all lattices;
                               * 0: not given. Fitted so that whole cells fill the shape's bounds */
    uint64_t count;         /* about so many particles (exactly, for a glass); 0: not given */
    double mass;            /* > 0: equal-mass fill: the spacing follows from "rho"; 0: not given */
    uint64_t seed;          /* glass and jitter; default 1 */
    double jitter;          /* in units of the spacing; default 0 */
    uint64_t sweeps;        /* glass: at most so many sweeps of relaxation; default 200 */
    double noise;           /* glass: stop at this rms density noise; default 0.01 */
    const char *file;       /* FILL_FILE: CSV with named columns, or HDF5/VTKHDF; relative to the
                               * scene's folder */
    const char *file_array; /* of a snapshot: this array only; NULL: all */
    const cJSON
        *rename;     /* object: the file's name of a column -> ours, "-" to leave it out; or NULL */
    double *reached; /* glass: the rms density noise reached, set by fill_array; NaN before */
};

struct scene_array {
    const char *name;
    const cJSON *node;
    size_t material;         /* index, or SIZE_MAX: none */
    struct scene_fill *fill; /* one array may have several fills (left and right of a tube) */
    size_t n_fill;
    /* Fields of a fill override those of the array. n_field of the array; fill_field[k] of fill
     * k. */
    struct scene_field *field;
    size_t n_field;
    struct scene_field **fill_field;
    size_t *n_fill_field;
    struct scene_column *column;
    size_t n_column;
    double
        h_factor; /* smoothing length at the start: h_factor * spacing ("h_over_dx"), default 1.3 */
};

/* An edit of the scheme's recipe, or an operation of the user's own: the paper's SPHOperation. */
enum edit_kind { EDIT_INSERT_BEFORE, EDIT_INSERT_AFTER, EDIT_REPLACE, EDIT_DELETE, EDIT_APPEND };
struct scene_edit {
    const cJSON *node;
    enum edit_kind kind;
    const char *anchor;    /* name of the step it acts on; NULL for append */
    const char *operation; /* "assignment", "summation", "integration"; NULL: as the function is */
    const char *function;  /* name of a function or "eos"; NULL for delete and with an expression */
    const char *expression; /* of the particle's own scalars, assigned to `of`; NULL: a function */
    const char *of;         /* the property that it sets, sums or integrates; checked by the plan */
    const char *at;         /* "start", "evaluate" (default), "finish" */
    const char **to, **from; /* arrays; NULL: all */
    size_t n_to, n_from;
    const cJSON *params; /* object: the members that are none of the above */
};

/* The moments at which something is measured, besides the end. Of several, each counts. */
struct scene_moments {
    double every;     /* time between them; INFINITY: not given */
    uint64_t steps;   /* every so many steps; 0: not given */
    const double *at; /* these, rising */
    size_t n_at;
};

/* What r, "v.r" and "v.phi" are taken about. */
struct scene_about {
    double center[3];
    int axis; /* in 3D: the line through the center along it; -1: the point (v.phi: about z) */
};

enum along { ALONG_X, ALONG_Y, ALONG_Z, ALONG_R };

struct scene_compare {
    const cJSON *node;
    const char *array;
    const char *exact;    /* NULL: the reference is a table */
    const cJSON *params;  /* of the exact solution: the object minus the known keys */
    const cJSON *table;   /* file name or object of columns; NULL: an exact solution */
    enum along along;     /* what the table's first column, or that of its name, runs over */
    const char *where;    /* region, an expression of x, y, z, r; NULL: everywhere */
    const char **fields;  /* NULL: all that the reference knows and the array has */
    const char **columns; /* of the table: that of each field */
    size_t n_fields;
    double time; /* that the table is for: compared then and not at the end; NaN: the end */
    struct scene_about about;
    struct scene_moments when;
};

/* A boundary condition on some arrays, for others. */
struct scene_boundary {
    const cJSON *node;
    const char *name;
    const char **array, **with; /* its own arrays, and those that it bounds; NULL: all */
    size_t n_array, n_with;
    const cJSON *params; /* the object minus the known keys */
};

/* A probe: a number made of the particles, or their values at points by the kernel. */
enum probe_kind { PROBE_MEAN, PROBE_CROSSING, PROBE_MIN, PROBE_MAX, PROBE_SUM, PROBE_POINTS };

/* Values at points, interpolated from particles: probes and profiles. */
struct scene_sample {
    const char **array, **of; /* components by "v.x" */
    size_t n_array, n_of;
    const double *point; /* [n_point][3] */
    size_t n_point;
    bool plain; /* not divided by the kernel's own sum */
    struct scene_about about;
};

/* A measured course in time that a probe is held against. */
struct scene_reference {
    const cJSON *table; /* NULL: none */
    const char *time, *value, *of;
    double scale_time, scale; /* what the table's numbers are multiplied by */
};

struct scene_probe {
    const cJSON *node;
    const char *name, *array; /* array: but for points */
    enum probe_kind kind;
    const char *of;      /* a property; component by "v.x"; but for points */
    const char *where;   /* expression, or NULL */
    double shell, level; /* crossing: where the mean of shells (in r) of this width crosses the
                          * level, from outside */
    double expected;     /* NaN: none */
    struct scene_sample sample; /* points */
    struct scene_moments when;
    struct scene_reference reference;
};

/* Values along a line, or means over bins of a coordinate. */
struct scene_profile {
    const cJSON *node;
    const char *name;
    struct scene_sample sample;
    const char *where; /* bins: expression, or NULL */
    enum along along;  /* bins: of which coordinate */
    size_t bins;       /* 0: a line */
    double min, max;
    struct scene_moments when;
    struct scene_compare reference; /* node NULL: none */
};

/* Signs that a run has gone wrong, and what is done about each: "watch". */
enum watch_cause {
    WATCH_NOT_FINITE,
    WATCH_DENSITY,
    WATCH_INTERNAL_ENERGY,
    WATCH_ESCAPED,
    WATCH_TIME_STEP,
    WATCH_ENERGY,
    WATCH_NEIGHBOURS,
    WATCH_CAUSES
};
extern const char *const watch_keys[WATCH_CAUSES];
enum watch_action { WATCH_STOP, WATCH_COUNT, WATCH_OFF };
struct scene_watch {
    enum watch_action action;
    double limit; /* escaped: sizes of the box; time-step: of the longest; energy: of that at the
                        * start; neighbours: so many */
    double scale; /* energy: to compare with; NaN: that at the start */
    const char *where; /* escaped: region that nobody may leave; or NULL */
};

struct scene_function; /* functions.h */
struct scene_memory;   /* what the structures stand in: private to scene.c */

struct scene {
    struct document *doc; /* not owned; outlives the scene */
    struct scene_memory *memory;
    const char *title; /* "" if not given */
    int dim;
    const char **plugin;
    size_t n_plugin;
    const char *units; /* "none", "SI", "cgs" */
    uint64_t limit;    /* particles that the scene may make: "limits": {"particles": ..} */
    struct box box;
    struct scene_function *function;
    size_t n_function;
    struct scene_material *material;
    size_t n_material;
    struct scene_array *array;
    size_t n_array;
    struct scene_boundary *boundary;
    size_t n_boundary;
    struct {
        const cJSON *node;
        const char *name;
        const cJSON *params; /* object: the members that are neither "name" nor "edit" */
        struct scene_edit *edit;
        size_t n_edit;
        bool fuse; /* default true: functions that can share a sweep do */
    } scheme;
    struct {
        const cJSON *node;
        const char *name;
    } kernel; /* name NULL: the scheme's */
    struct {
        const cJSON *node;
        const char *integrator; /* NULL: the scheme's */
        double begin, end;
        double cfl;     /* NaN: the scheme's */
        double dt;      /* fixed step; NaN: adaptive */
        double dt_max;  /* INFINITY if not given */
        uint64_t steps; /* at most; UINT64_MAX */
    } time;
    struct {
        const cJSON *node;
        double skin;         /* NAN: as the plan has it */
        const char *manager; /* NULL: the plan chooses */
    } neighbours;            /* optional key "neighbours": {"skin": 0.1, "manager": "octree"} */
    struct {
        size_t partition; /* by domain/partition.h: 0 "rcb", 1 "rib", 2 "hsfc", 3 "slab" */
        double
            imbalance; /* largest share of a rank over the mean, from which the domain is cut anew */
        bool by_time;  /* particles weigh by the time that their rank took for its share */
    } ranks; /* optional key "ranks": {"partition": "rcb", "imbalance": 1.01, "weights": "pairs"} */
    const char *precision; /* "double", "mixed", "single"; NULL: the scheme's */
    /* The command line's, as `precision` may be. */
    struct {
        bool opencl; /* else the processor */
        bool only;   /* no falling back to it */
        size_t number;
        bool numbered; /* the number was given: else ranks of a machine share its devices */
    } device;
    struct scene_watch watch[WATCH_CAUSES];
    struct scene_compare *compare;
    size_t n_compare;
    struct scene_probe *probe;
    size_t n_probe;
    struct scene_profile *profile;
    size_t n_profile;
    struct {
        const cJSON *node;
        double every;       /* time between snapshots; INFINITY: only first and last */
        uint64_t log_steps; /* a row of log.csv every so many steps; default 1 */
        double log_every;   /* or every so much time; INFINITY */
        struct {
            bool wanted;
            uint64_t steps; /* one every so many steps; 0: not so */
            double every;   /* or every so much time; INFINITY */
            uint64_t keep;  /* so many stay; default 2 */
        } checkpoint;
        struct {
            bool wanted;
            const char *array, *of;
            double min, max;
            bool range;
            const char *map;
            double size;
        } picture;
    } output;
};

/* Compiles the document. Every error is EXIT_USAGE with its place; then nothing is to be freed. */
int scene_compile(struct scene *s, struct document *d, struct error *e);
void scene_free(struct scene *s);

/* The variables of regions ("where") and initial fields, in this order; a component that the
 * scene's dimension lacks is 0, r is the distance from the origin and never quite 0, so that x/r
 * is 0 there. */
#define SCENE_VARIABLES 5
extern const char *const scene_variables[SCENE_VARIABLES]; /* x, y, z, r, spacing */
/* Regions know only the first four. */
#define SCENE_REGION_VARIABLES 4
void scene_values(const double *x, int dim, double spacing, double values[SCENE_VARIABLES]);

/* Whether measured at other moments than the end. */
static inline bool moments_any(const struct scene_moments *m)
{
    return isfinite(m->every) || m->steps || m->n_at;
}

/* The distance that `about` says, of x[dim]. */
double scene_radius(const struct scene_about *about, int dim, const double *x);

/* The part of a file's name that a probe's or a profile's name gives: what is no letter, digit, "-", "." or
 * beyond ASCII becomes "_". Fresh memory; NULL when out of it. */
char *scene_file_part(const char *name);

#endif
