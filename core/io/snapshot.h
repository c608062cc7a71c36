/* io/snapshot.h -- snapshots as VTKHDF (UnstructuredGrid with a vertex cell a particle, version 1.0: opens in
 * ParaView and VTK 9.1 and later), readable by h5py, self-describing: units and documentation of
 * every column, the whole scene, time and step, versions. */
#ifndef IO_SNAPSHOT_H
#define IO_SNAPSHOT_H

#include "particles/particles.h"

struct snapshot_meta {
    const char *scene_path, *scene_text; /* text as run, --set applied */
    const char *title, *units, *version;
    double time;
    uint64_t step;
};

/* Writes all arrays into one file: columns by plain name (vectors as 3 components; tensors flat), an
 * `array` column (index) and field data that names them; a column that an array lacks is NaN (or -1
 * for integers) there. Ghosts are left out. */
int snapshot_write(const char *path, const struct particles *arrays, size_t n, const struct snapshot_meta *meta, struct error *e);

/* A column of a snapshot read back: for `sph render` and for scenes that start from a file. */
struct snapshot {
    int dim;
    double time;
    uint64_t step;
    char *title, *scene_text;
    size_t n, n_array;
    char **array_name;
    int32_t *array;       /* [n] */
    size_t n_column;
    struct snapshot_column { char *name, *unit; uint32_t ncomp; double *value; /* [n * ncomp], interleaved */ } *column;
    double *x;            /* [3 n] */
};
int snapshot_read(struct snapshot *s, const char *path, struct error *e);
void snapshot_free(struct snapshot *s);

#endif
