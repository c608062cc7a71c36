/* io/output.h -- the output folder: claimed for one run, files written aside and renamed, so that nothing
 * is ever half written. */
#ifndef IO_OUTPUT_H
#define IO_OUTPUT_H

#include "base/error.h"
#include <stdio.h>

struct output {
    char *dir;
    int lock; /* file descriptor of the lock file, held while the run lives */
};

/* Makes the folder (and parents) if need be, claims it (a lock file: two runs never share one) and
 * removes the results of an earlier run there only if they are ours (snapshot_*.vtkhdf, log.csv,
 * summary.json, *.png of earlier runs); other files stay. Errors: not a folder, not writable, in use (by which process). */
int output_open(struct output *o, const char *dir, struct error *e);
void output_close(struct output *o);
/* "DIR/name" into fresh memory. */
char *output_path(const struct output *o, const char *name);
/* Writes a small file whole: aside, synced, renamed. */
int output_write(const struct output *o, const char *name, const char *text, size_t n, struct error *e);
/* The same steps for a file that a library writes: a temporary path to write to, then the rename. */
char *output_begin(const struct output *o, const char *name);
int output_commit(const struct output *o, const char *temporary, const char *name, struct error *e);

#endif
