/* io/summary.h -- summary.json, written last and atomically; and the table that a run ends with. */
#ifndef IO_SUMMARY_H
#define IO_SUMMARY_H

#include "base/error.h"
#include "io/output.h"
#include <cjson/cJSON.h>
#include <stdint.h>

struct summary_error { const char *field, *reference; double l1, l1_rel, l2, linf; uint64_t n; }; /* field: "fluid.rho" */
struct summary_probe { const char *name; double value, expected; };
struct summary_pass { const char *name; double seconds; uint64_t pairs, sweeps; };
struct summary_plugin { const char *name, *version, *file; uint32_t abi_major, abi_minor; };

struct summary {
    const char *status, *scene, *title;   /* status: "done", "failed", "stopped" */
    const char *reason;                    /* of a failure, or NULL */
    size_t n_array; const char *const *array_name; const uint64_t *array_n;
    uint64_t steps; double time;
    const struct summary_error *error; size_t n_error;
    const struct summary_probe *probe; size_t n_probe;
    double energy_drift, momentum_drift[3], angular_drift[3], mass_drift; int dim;
    struct { double wall, loop, neighbour, integrate, io, mpi; uint64_t particle_updates, pairs, list_builds, h_sweeps, peak_rss; double bytes_per_particle; } cost;
    const struct summary_pass *pass; size_t n_pass;
    cJSON *plan;                           /* owned by the caller; duplicated */
    const struct summary_plugin *plugin; size_t n_plugin;
    int threads, ranks;
    const char *picture;                   /* path, or NULL */
};
cJSON *summary_json(const struct summary *s);
int summary_write(const struct summary *s, const struct output *o, struct error *e);
/* The table for people: particles, steps, probes beside what is expected, errors, drift, ns per pair, us per update. */
void summary_table(const struct summary *s, FILE *out);

#endif
