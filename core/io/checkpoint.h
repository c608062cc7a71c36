/* io/checkpoint.h -- the file of a checkpoint: named blocks of numbers (base/store.h) in HDF5, with checksums.
 * What the blocks mean is their owners' business. */
#ifndef IO_CHECKPOINT_H
#define IO_CHECKPOINT_H

#include "base/store.h"
#include "io/h5.h"
#include "io/output.h"

/* Raised whenever what is in a checkpoint changes: there is no reading of others. */
#define CHECKPOINT_FORMAT 3

struct checkpoint {
    struct store store; /* first: what its calls get */
    struct h5_out out;  /* writing */
    hid_t file;         /* reading */
    double file_size;
    char *shown;
};

/* Writes to `path`, which is to become `shown`. */
int checkpoint_create(struct checkpoint *c, const char *path, struct error *e);
/* Opens one that another process has made and finished, to add blocks. */
int checkpoint_append(struct checkpoint *c, const char *path, struct error *e);
/* Syncs nothing and renames nothing; removes the file if anything failed (`failed`: earlier). */
int checkpoint_finish(struct checkpoint *c, int failed, struct error *e);

/* Opens one for reading; it is ours, of this format, and every block's checksum is right. All errors
 * are EXIT_USAGE. On failure nothing is to be closed. */
int checkpoint_open(struct checkpoint *c, const char *path, struct error *e);
/* The same without looking at every block: another process has just done so. */
int checkpoint_open_known(struct checkpoint *c, const char *path, struct error *e);
void checkpoint_close(struct checkpoint *c);

/* The steps of the checkpoints in a folder, newest first, in fresh memory; how many, or -1. */
long checkpoint_list(const char *dir, long long **step, struct error *e);
/* Removes all but the newest `keep`. */
void checkpoint_prune(const struct output *o, uint64_t keep);

#endif
