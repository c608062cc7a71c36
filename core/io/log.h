/* io/log.h -- log.csv: a row a step or an interval; and the progress line on a terminal. */
#ifndef IO_LOG_H
#define IO_LOG_H

#include "base/error.h"
#include <stdbool.h>
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
    double wall;
};

struct log { FILE *file; char *path; bool header_done; int dim; };
int log_open(struct log *l, const char *path, int dim, struct error *e);
int log_write(struct log *l, const struct log_row *row, struct error *e);
int log_close(struct log *l, struct error *e);

/* Progress on stderr if it is a terminal: step, time, dt, energy drift, ETA, one line rewritten at most ten
 * times a second; nothing in a pipe. */
struct progress { bool on; double begin, end; double started, shown; };
void progress_start(struct progress *p, bool wanted, double begin, double end);
void progress_show(struct progress *p, uint64_t step, double time, double dt, double drift);
void progress_end(struct progress *p);

#endif
