/* io/summary.h -- summary.json, written last and atomically; and the table that a run ends with. */
#ifndef IO_SUMMARY_H
#define IO_SUMMARY_H

#include "base/error.h"
#include "io/output.h"
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct summary_error {
    const char *field, *reference; /* field: "fluid.rho" */
    const char *array;
    double l1, l1_rel, l2, l2_rel, linf;
    double linf_at[3]; /* where the largest is; NaN: nowhere */
    double time;       /* compared then and not at the end; NaN: at the end */
    uint64_t n;        /* particles compared */
    uint64_t outside;  /* of the region, but beyond the reference's ends: left out */
};
/* Against a course in time. */
struct summary_course {
    const char *reference; /* NULL: none */
    double begin, end, l1, l1_rel, l2, l2_rel, linf;
};
struct summary_probe {
    const char *name;
    double value, expected; /* expected: NaN if nothing is */
    const char *file;       /* of its course in time; NULL: none */
    uint64_t rows;
    const char *const
        *of; /* at points: n_of columns, n_point values of each; of NULL: one number */
    size_t n_of, n_point;
    const double *values; /* [n_point][n_of] */
    struct summary_course course;
};
struct summary_profile {
    const char *name, *file;
    uint64_t rows;
};
struct summary_pass {
    const char *name;
    double seconds;
    uint64_t pairs, sweeps;
};
struct summary_plugin {
    const char *name, *version, *file;
    uint32_t abi_major, abi_minor;
};
/* What stopped a run, or was counted in it (n) and happened here first. */
struct summary_watch {
    const char *cause; /* "density", "time-step", ... */
    uint64_t n;
    bool happened;
    const char *array, *pass; /* array NULL: no particle is to blame; pass NULL: no pass either */
    int64_t particle;
    double x[3];
    uint64_t step;
    double time;
};
/* Bytes held for a particle; search is the search's for neighbours, while it goes on. */
struct summary_memory {
    double columns, mirrors, lists, places, ghosts, search;
};
struct summary_cost {
    double wall, loop, neighbour, integrate, io, mpi; /* [s] of wall time */
    uint64_t particle_updates, pairs, list_builds, h_sweeps, peak_rss;
    uint64_t sorts;
    double bytes_per_particle; /* all of memory but the search */
    struct summary_memory memory;
};

struct summary {
    const char *status, *scene, *title;  /* status: "done", "failed", "stopped"; scene: its path */
    const char *reason;                  /* of a failure, or NULL */
    const struct summary_watch *failure; /* the same for machines, or NULL */
    const struct summary_watch *watch;   /* [n_watch]: what the scene has counted */
    size_t n_watch;
    size_t n_array;
    const char *const *array_name;
    const uint64_t *array_n;
    uint64_t steps;
    double time;
    const struct summary_error *error;
    size_t n_error;
    const struct summary_probe *probe;
    size_t n_probe;
    const struct summary_profile *profile;
    size_t n_profile;
    double energy_drift, momentum_drift[3], angular_drift[3], mass_drift;
    int dim;
    struct summary_cost cost;
    const struct summary_pass *pass;
    size_t n_pass;
    cJSON *plan;   /* owned by the caller; duplicated; NULL: an empty one */
    cJSON *device; /* likewise; what a run on a device cost there; NULL: it was on the processor */
    cJSON *shared; /* likewise: passes of which the time stands with another one; NULL: none */
    cJSON *on_ranks; /* likewise: what several ranks came to; NULL: one rank */
    const struct summary_plugin *plugin;
    size_t n_plugin;
    int threads, ranks;
    const char *picture; /* path, or NULL */
};

/* The file's contents; NULL when out of memory. A number that is not finite becomes null. A field
 * compared again appears as "fluid.rho@REFERENCE", then as "fluid.rho@REFERENCE.2" ... */
cJSON *summary_json(const struct summary *s);
int summary_write(const struct summary *s, const struct output *o, struct error *e);

/* Wall time of the passes over pairs for each of their pairs, of the whole loop if no pass was
 * timed [ns]; wall time of the loop for each particle update [us]. NaN if there were none. */
double summary_ns_per_pair(const struct summary *s);
double summary_us_per_update(const struct summary *s);

/* The table for people: particles, steps, probes beside what is expected, errors, drift, ns per
 * pair, us per update. At most 80 columns, but for long names and paths. */
void summary_table(const struct summary *s, FILE *out);

#endif
