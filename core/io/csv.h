/* io/csv.h -- files of rows, straight under their names, so that they can be watched: a name for each column
 * first, then rows that begin with the step. What belongs together is committed together: the file always
 * ends with a whole row. */
#ifndef IO_CSV_H
#define IO_CSV_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum csv_mode {
    CSV_OVER, /* what is there is overwritten */
    CSV_NEW,  /* a file that is there is an error: it is somebody else's */
    CSV_GO_ON /* rows are added to what is there */
};

struct csv {
    FILE *file;
    char *path;
    long good;     /* bytes known to be on disk, whole rows */
    bool begun;    /* a row has a cell */
    uint64_t rows; /* lines, that of the names included */
};

int csv_open(struct csv *c, const char *path, enum csv_mode mode, struct error *e);
/* The line of names: put into an empty file; what is gone on with must have the same. */
int csv_head(struct csv *c, const char *line, struct error *e);
/* Cells, one after the other; a number has 17 digits: what is read back is what was. */
void csv_name(struct csv *c, const char *name);
void csv_count(struct csv *c, uint64_t value);
void csv_number(struct csv *c, double value);
void csv_fixed(struct csv *c, double value, int digits);
void csv_end_row(struct csv *c);
/* What was put since the last commit goes to disk, whole. If it cannot (disk full) it is taken back, so that
 * the file ends with a good row. */
int csv_commit(struct csv *c, struct error *e);
/* What has been committed is on disk. */
int csv_sync(struct csv *c, struct error *e);
/* Syncs and closes. Nothing on one that was never opened and is zeros. */
int csv_close(struct csv *c, struct error *e);

/* Rows from this step on, and one that a killed run has left half written, are cut off: for a run that goes on
 * from an earlier state. A file that is not there is left so. */
int csv_cut_from(const char *path, uint64_t step, struct error *e);
/* Two columns by name, of rows that csv_* wrote (NaN included); freed by the caller. */
int csv_read_two(const char *path, const char *const name[2], double *value[2], size_t *n,
                 struct error *e);

/* First cells of every file of ours. */
#define CSV_MARK "step,time,"

#endif
