/* scene/read_private.h -- what read.c and read_hdf5.c share. */
#ifndef SCENE_READ_PRIVATE_H
#define SCENE_READ_PRIVATE_H

#include "scene/read.h"

/* table_read for a file that is known to be HDF5. */
int table_read_hdf5(struct table *t, const char *path, const char *array, struct error *e);

#endif
