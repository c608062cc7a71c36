/* io/h5.h -- what our users of HDF5 share: a file that is written without losing an error of the
 * disk, and HDF5's own complaints made one sentence. */
#ifndef IO_H5_H
#define IO_H5_H

#include "base/error.h"
#include <hdf5.h>
#include <stdbool.h>

/* HDF5 cannot be left cleanly once a write has failed: it keeps the file open and tries again as
 * the process ends. So our driver tells it of no failed write; it keeps the first error, drops
 * what follows, and h5_close reports it. */
struct h5_disk {
    int fd;
    int error; /* errno of the first failure, or 0 */
};

struct h5_out {
    const char *path, *shown; /* the caller's; what messages call it */
    hid_t file, driver;
    struct h5_disk disk;
};

/* Makes the file anew; messages call it `shown`. `out` stays where it is until closed. */
int h5_create(struct h5_out *out, const char *path, const char *shown, struct error *e);
/* Opens one that another process has made and closed, to add to it; the rest is the same. */
int h5_append(struct h5_out *out, const char *path, const char *shown, struct error *e);
/* Closes it; removes it if anything went wrong (`failed`: earlier, e is set already). */
int h5_close(struct h5_out *out, int failed, struct error *e);

/* Room on the disk for all of a file that is closed, so that filling it cannot fail for lack of it; removes it if
 * there is none. */
int h5_reserve(const char *path, const char *shown, struct error *e);
/* All of MPI's processes open a file together to fill it; a negative number if it cannot. Only where
 * h5_is_parallel(). */
bool h5_is_parallel(void);
hid_t h5_join(const char *path, const char *shown, struct error *e);

/* Opens for reading, HDF5's own printing switched off; a negative number if it cannot. */
hid_t h5_open(const char *path, struct error *e);

/* Right after a failed call: "cannot write PATH: WHY", the reason taken from HDF5's error stack. */
int h5_error(struct error *e, enum exit_code code, const char *verb, const char *path);

#endif
