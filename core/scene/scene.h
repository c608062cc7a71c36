/* scene/scene.h -- a scene file as checked structures. What a scene *names* (kernels, schemes, functions,
 * equations of state, exact solutions) is resolved by the plan, since plugins are loaded after this; each
 * such place keeps its JSON node, so that a message can point at it. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "domain/sides.h"
#include "scene/json.h"
#include "scene/shape.h"
#include <stdint.h>

struct scene_material {
    const char *name;
    const cJSON *node;
    const char *eos;         /* its name, or NULL: the material has none */
    const cJSON *eos_node;   /* object: "name" and the parameters */
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
enum lattice { LATTICE_SQUARE, LATTICE_HEXAGONAL, LATTICE_BCC, LATTICE_FCC }; /* square: cubic in 3D */

struct scene_fill {
    const cJSON *node;
    enum fill_kind kind;
    enum lattice lattice;
    struct shape *shape;      /* inside which particles are put; NULL: the domain */
    double spacing;           /* lattice spacing: volume per particle is spacing^dim for all lattices */
    uint64_t count;           /* alternatively: about so many particles (exactly, for a glass); 0: not given */
    double mass;              /* > 0: equal-mass fill: spacing follows the "rho" field by region */
    uint64_t seed;            /* glass and jitter */
    double jitter;            /* in units of the spacing */
    const char *file;         /* FILL_FILE: CSV with named columns, or HDF5/VTKHDF */
};

struct scene_array {
    const char *name;
    const cJSON *node;
    size_t material;          /* index, or SIZE_MAX: none */
    struct scene_fill *fill;  /* one array may have several fills (left and right of a tube) */
    size_t n_fill;
    /* Fields of a fill override those of the array. n_field of the array; fill_field[k] of fill k. */
    struct scene_field *field;
    size_t n_field;
    struct scene_field **fill_field;
    size_t *n_fill_field;
    struct scene_column *column;
    size_t n_column;
    double h_factor;          /* smoothing length at the start: h_factor * spacing ("h_over_dx"), default 1.3 */
};

/* An edit of the scheme's recipe, or an operation of the user's own: the paper's SPHOperation. */
enum edit_kind { EDIT_INSERT_BEFORE, EDIT_INSERT_AFTER, EDIT_REPLACE, EDIT_DELETE, EDIT_APPEND };
struct scene_edit {
    const cJSON *node;
    enum edit_kind kind;
    const char *anchor;       /* name of the step it acts on; NULL for append */
    const char *operation;    /* "assignment", "summation", "integration"; NULL for delete */
    const char *function;     /* name of a function, "eos", or an expression's target below */
    const char *of;           /* the property that it sets, sums or integrates; checked by the plan */
    const char *at;           /* "start", "evaluate" (default), "finish" */
    const char **to, **from;  /* arrays; NULL: all */
    size_t n_to, n_from;
    const cJSON *params;      /* object, or NULL */
};

struct scene_compare {
    const cJSON *node;
    const char *array, *exact;
    const cJSON *params;      /* of the exact solution: the object minus the known keys */
    const char *where;        /* region, an expression of x, y, z, r; NULL: everywhere */
    const char **fields;      /* NULL: all that the solution knows and the array has */
    size_t n_fields;
};

/* A probe: a number made of the particles at the end (and shown in the table). */
enum probe_kind { PROBE_MEAN, PROBE_CROSSING, PROBE_MIN, PROBE_MAX };
struct scene_probe {
    const cJSON *node;
    const char *name, *array;
    enum probe_kind kind;
    const char *of;           /* a property; component by "v.x" */
    const char *where;        /* expression, or NULL */
    double shell, level;      /* crossing: where the mean of shells (in r) of this width crosses the level, from outside */
    double expected;          /* NaN: none */
};

struct scene {
    struct document *doc;     /* not owned; outlives the scene */
    const char *title;
    int dim;
    const char **plugin;
    size_t n_plugin;
    const char *units;        /* "none", "SI", "cgs", ... */
    struct box box;
    struct scene_material *material; size_t n_material;
    struct scene_array *array; size_t n_array;
    const cJSON *boundaries;  /* array or NULL; resolved by the plan */
    struct { const cJSON *node; const char *name; struct scene_edit *edit; size_t n_edit; } scheme;
    struct { const cJSON *node; const char *name; } kernel; /* name NULL: the scheme's */
    struct {
        const cJSON *node;
        const char *integrator; /* NULL: the scheme's */
        double begin, end;
        double cfl;             /* NaN: the scheme's */
        double dt;              /* fixed step; NaN: adaptive */
        double dt_max;          /* INFINITY if not given */
        uint64_t steps;         /* at most; UINT64_MAX */
    } time;
    struct { const cJSON *node; double skin; } neighbours; /* optional key "neighbours": {"skin": 0.1} */
    struct scene_compare *compare; size_t n_compare;
    struct scene_probe *probe; size_t n_probe;
    struct {
        const cJSON *node;
        double every;           /* time between snapshots; INFINITY: only first and last */
        uint64_t log_steps;     /* a row of log.csv every so many steps; default 1 */
        double log_every;       /* or every so much time; INFINITY */
        struct { bool wanted; const char *array, *of; double min, max; bool range; const char *map; double size; } picture;
    } output;
};

/* Compiles the document. Every error is EXIT_USAGE with its place. */
int scene_compile(struct scene *s, struct document *d, struct error *e);
void scene_free(struct scene *s);

/* The scheme's own parameter members (those that are not "name" and "edit") are handed to the plan as nodes. */

#endif
