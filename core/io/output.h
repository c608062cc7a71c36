/* io/output.h -- the output folder: claimed for one run, files written aside and renamed, so
 * that nothing is ever half written. */
#ifndef IO_OUTPUT_H
#define IO_OUTPUT_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct output {
    char *dir;
    int lock; /* file descriptor of the lock file, held while the run lives */
};

/* Makes the folder (and parents) if need be, claims it (a lock file: two runs never share one) and
 * removes the results of an earlier run there, only if they are ours (snapshot_*.vtkhdf, log.csv,
 * errors.csv, ranks.csv, probe_*.csv, profile_*.csv, summary.json, checkpoint_*.h5 and pictures that say that
 * they are ours); other files stay. A log.csv, another of these tables or a summary.json that is not
 * ours is an error: the run would overwrite it. Errors: not a folder, not writable, in use (by which
 * process). */
int output_open(struct output *o, const char *dir, struct error *e);
/* The two halves of it: a run that resumes claims and does not clear. */
int output_claim(struct output *o, const char *dir, struct error *e);
int output_clear(const struct output *o, struct error *e);
/* The second half, but for the checkpoint `name` (NULL: none), which is kept as OUTPUT_EARLIER. */
int output_clear_but(const struct output *o, const char *name, struct error *e);
/* Of the results there, removes what a run that goes on after `step`, with snapshot number `snapshots`, makes
 * again: later snapshots and checkpoints, a failed state, the summary, what was being written. */
int output_cut(const struct output *o, uint64_t snapshots, uint64_t step, struct error *e);
/* Removes what killed writers left in a claimed folder: files aside that came to no name. */
void output_sweep(const struct output *o);
/* Gives the claim back. Nothing on an `o` that was never opened and is zeros. */
void output_close(struct output *o);
/* "DIR/name" into fresh memory; NULL when out of memory. */
char *output_path(const struct output *o, const char *name);

/* Writes a small file whole: aside, synced, renamed. */
int output_write(const struct output *o, const char *name, const char *text, size_t n,
                 struct error *e);
/* The same steps for a file that a library writes: a temporary path to write to (fresh memory,
 * NULL when out of memory), then the rename. Commit removes the temporary when it fails; the
 * caller frees the string in any case, or drops both when the library failed. */
char *output_begin(const struct output *o, const char *name);
int output_commit(const struct output *o, const char *temporary, const char *name, struct error *e);
void output_drop(char *temporary);
/* What such a temporary is to become, or what another path is: for messages. Fresh memory. */
char *output_shown(const char *path);

/* The same for any path, claimed or not: aside in the same folder, synced, renamed. A path that is
 * there and no regular file (a device, a pipe) is written to directly. */
int output_write_path(const char *path, const void *data, size_t n, struct error *e);

/* Whether a file's name is that of a snapshot: "snapshot_", digits, ".vtkhdf". */
bool output_is_snapshot(const char *name);
/* The step of a checkpoint by its file's name: "checkpoint_00001200.h5"; -1: it is none. */
long long output_checkpoint_step(const char *name);
void output_checkpoint_name(char *out, size_t size, unsigned long long step);
/* The state in which a run failed: none of those, so neither resumed from nor pruned. */
#define OUTPUT_FAILED "checkpoint_failed.h5"
/* Of an earlier run that did not end: "latest" is of this run alone. */
#define OUTPUT_EARLIER "checkpoint_earlier.h5"

/* In every PNG of ours, so that a later run knows which pictures it may remove. */
#define OUTPUT_PNG_KEY "Software"
#define OUTPUT_PNG_MARK "sph"
/* First cells of every log.csv of ours. */
#define OUTPUT_LOG_MARK "step,time,dt,"

#endif
