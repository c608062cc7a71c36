/* chart/chart.h -- error against cost for a family of runs: what a chart file asks for, the runs that
 * it stands for, and their results. Knows scenes as JSON and runs as child processes: no physics. */
#ifndef CHART_CHART_H
#define CHART_CHART_H

#include "base/error.h"
#include "scene/json.h"
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CHART_RUNS_MOST 10000

/* One setting of an axis: changes of the scene, or the value of an option. */
struct chart_value {
    char *label;
    double number; /* that the label is; NaN: a word */
    char **set;    /* [n_set] "PATH=JSON" */
    size_t n_set;
    char *option; /* the value of the axis's option, or NULL */
};

struct chart_axis {
    const char *name;
    const char *option; /* "precision", "threads", "device"; NULL: the values change the scene */
    struct chart_value *value;
    size_t n_value;
};

/* For each axis, which of its values: [axis][value]. */
struct chart_choice {
    bool **has;
};

enum chart_kind { CHART_COST, CHART_CONVERGENCE, CHART_MAP };

struct chart_picture {
    const cJSON *node;
    const char *name, *title;
    enum chart_kind kind;
    const char *x;            /* a measure (row.h) or an axis whose labels are numbers */
    size_t x_axis, y_axis;    /* of a map; x_axis of others too, or SIZE_MAX */
    size_t *series, n_series; /* axes */
    struct chart_choice select;
};

/* Another program's results: a table with an error and measures. */
struct chart_peer {
    const char *label, *source;
    struct cells *table; /* NULL until read */
};

/* Which number of a run is its error. */
struct chart_measure {
    const cJSON *node;
    char *column; /* of the results: "ARRAY.FIELD.NORM", "probe.NAME", a path into the summary */
    char *title;  /* for people */
    char *of, *norm, *path, *probe;
};

struct chart_run {
    size_t *value;  /* [n_axis] */
    char *settings; /* all that its result depends on, but the plugins */
    char id[17];    /* of the settings */
    bool wanted;    /* by --only */
};

struct chart {
    struct document doc, scene;
    const char *title;
    char *scene_path;
    char **load, **set;
    size_t n_load, n_set;
    struct chart_axis *axis;
    size_t n_axis;
    struct chart_choice *skip;
    size_t n_skip;
    struct chart_measure error;
    double seconds, unstable, drift; /* INFINITY: no limit */
    struct chart_picture *picture;
    size_t n_picture;
    struct chart_peer *peer;
    size_t n_peer;
    struct chart_run *run;
    size_t n_run;
};

/* -- read.c, read_axes.c, read_pictures.c, expand.c --------------------------------------------- */

/* Reads the chart file, its scene and its peers; makes the runs. `only`: "AXIS=LABEL" of --only.
 * On failure the caller still calls chart_free. */
int chart_read(struct chart *c, const char *path, const char *const *only, size_t n_only,
               struct error *e);
void chart_free(struct chart *c);

int chart_read_axes(struct chart *c, struct error *e);
int chart_read_pictures(struct chart *c, struct error *e);
int chart_read_peers(struct chart *c, struct error *e);
void chart_pictures_free(struct chart *c);
int chart_expand(struct chart *c, const char *const *only, size_t n_only, struct error *e);

/* {"AXIS": LABEL or [LABELS]}: the axes that are not named have all their values. */
int chart_read_choice(struct chart *c, const cJSON *node, struct chart_choice *choice,
                      struct error *e);
int chart_choice_make(const struct chart *c, struct chart_choice *choice, struct error *e);
void chart_choice_free(const struct chart *c, struct chart_choice *choice);
bool chart_choice_has(const struct chart *c, const struct chart_choice *choice,
                      const struct chart_run *r);

/* The axis of this name, or an error at `node` with the nearest. */
int chart_axis_of(const struct chart *c, const cJSON *node, const char *name, size_t *axis,
                  struct error *e);
/* The value of this label, given as text or number. */
int chart_label_of(const struct chart *c, size_t axis, const cJSON *node, size_t *value,
                   struct error *e);
/* "AXIS=LABEL AXIS=LABEL", or only the labels with " · " between, of the given axes (NULL: all).
 * Returns out. */
const char *chart_labels(const struct chart *c, const struct chart_run *r, const size_t *axes,
                         size_t n, bool names, char *out, size_t size);
/* An axis's label as a number in a text: "12", ".2"; NaN for a word. */
double chart_number(const char *text);
/* Of a `set` object: "PATH=JSON" each, appended. */
int chart_read_set(const struct chart *c, const cJSON *object, char ***set, size_t *n,
                   struct error *e);
/* The nodes of an array, or an error. A node that is absent has none. */
int chart_array(const struct chart *c, const cJSON *node, const char *what, size_t *n,
                struct error *e);

/* The arguments of `sph run` for this run: the scene, --load, --set, options; without --out.
 * NULL-terminated, fresh; chart_arguments_free frees them. NULL when out of memory. */
char **chart_arguments(const struct chart *c, const struct chart_run *r);
void chart_arguments_free(char **argument);

#endif
