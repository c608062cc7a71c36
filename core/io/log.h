/* io/log.h -- log.csv: a row a step or an interval; and the progress line on a terminal. */
#ifndef IO_LOG_H
#define IO_LOG_H

#include "io/csv.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct log_row {
    uint64_t step;
    double time, dt;
    double kinetic, internal, potential;
    double momentum[3], angular[3], mass;
    /* extremes: name -> value, e.g. "rho.max" */
    const char *const *extra_name;
    const double *extra;
    uint64_t n_extra;
    double wall; /* [s] since the start */
};

/* The file grows by a row at a time, straight under its name: it can be watched. A row that
 * cannot be written whole (disk full) is an error and is taken back, so that the file ends with
 * a good one. */
struct log {
    struct csv csv;
    bool header_done;
    int dim;
};
int log_open(struct log *l, const char *path, int dim, struct error *e);
/* The same, but rows come behind those that are there. */
int log_append(struct log *l, const char *path, int dim, struct error *e);
/* Columns: step, time, dt, kinetic, internal, potential, momentum_x ..., angular_z (2D) or
 * angular_x ... (3D), mass, the extras by name, wall_s. The extras are those of the first row. */
int log_write(struct log *l, const struct log_row *row, struct error *e);
/* Syncs and closes. Nothing on a log that was never opened and is zeros. */
int log_close(struct log *l, struct error *e);

/* Progress on stderr if it is a terminal: step, time, dt, energy drift, ETA, one line rewritten at
 * most ten times a second; nothing in a pipe. */
struct progress {
    bool on;
    double begin, end;     /* of the run's time */
    double started, shown; /* [s] of a monotonic clock */
};
void progress_start(struct progress *p, bool wanted, double begin, double end);
void progress_show(struct progress *p, uint64_t step, double time, double dt, double drift);
/* Wipes the line. */
void progress_end(struct progress *p);
/* The line as it is shown, for `elapsed` seconds so far. Returns out. */
const char *progress_line(char *out, size_t size, const struct progress *p, uint64_t step,
                          double time, double dt, double drift, double elapsed);
/* "12 s", "3 min 20 s", "2 h 05 min" */
void progress_duration(char *out, size_t size, double seconds);
/* Another line in the place of the step's, for what else takes long. */
void progress_text(struct progress *p, const char *line);

#endif
