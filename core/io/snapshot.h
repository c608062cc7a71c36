/* io/snapshot.h -- snapshots as VTKHDF (UnstructuredGrid with a vertex cell a particle, version
 * 1.0: opens in ParaView and VTK 9.1 and later), readable by h5py, self-describing: units and
 * documentation of every column, the whole scene, time and step, versions. */
#ifndef IO_SNAPSHOT_H
#define IO_SNAPSHOT_H

#include "particles/particles.h"

struct snapshot_meta {
    const char *scene_path, *scene_text; /* text as run, --set applied */
    const char *title, *units, *version;
    double time;
    uint64_t step;
};

/* Writes all arrays into one file: columns by plain name (vectors as 3 components; tensors
 * flat), an `array` column (index) and field data that names them; a column that an array lacks
 * is NaN (or -1 for integers) there. The positions, column "x", are the points and stand there
 * only. Columns without `output` and ghosts are left out. When it fails, disk full included, the
 * file is removed; a caller who keeps the final name clean writes aside (io/output.h).
 *
 * * Beside what VTK asks for: attributes `unit`, `doc` (and `components` of tensors) on every
 * column and on Points; `title`, `units`, `version`, `dimensions`, `time`, `step` on the file;
 * TimeValue, Time, Step, array_names, array_sizes, column_names, column_units, column_docs,
 * title, units, version, scene_path and scene as field data. */
int snapshot_write(const char *path, const struct particles *arrays, size_t n,
                   const struct snapshot_meta *meta, struct error *e);

/* A file that several processes write: a partition of each, in their order. */
struct snapshot_parts {
    size_t n, mine;       /* partitions; this process's */
    const uint64_t *rows; /* [n]: particles of each */
    const uint64_t *size; /* [arrays]: particles of all of them */
};

/* Whether processes can write one file together: with MPI, and an HDF5 that is made for it. */
bool snapshot_can_fill(void);
/* One of them makes the file, all but what particles have: for that there is room then, on the disk as well.
 * When it fails, the file is removed. */
int snapshot_prepare(const char *path, const struct particles *arrays, size_t n,
                     const struct snapshot_parts *parts, const struct snapshot_meta *meta,
                     struct error *e);
/* Then each of MPI's processes calls this, and all of them fail alike; the file stays. It waits for them without
 * looking for an alarm (domain/wire.h): all must be known to come. */
int snapshot_fill(const char *path, const struct particles *arrays, size_t n,
                  const struct snapshot_parts *parts, struct error *e);

struct snapshot_column {
    char *name, *unit, *doc; /* unit and doc may be "" */
    uint32_t ncomp;
    double *value; /* [n * ncomp], interleaved */
};

/* A snapshot read back: for `sph render` and for scenes that start from a file. */
struct snapshot {
    int dim; /* of a file that does not say: by the extent of its points */
    double time;
    uint64_t step;
    char *title, *units, *scene_text; /* "" if the file does not say */
    size_t n, n_array;
    char **array_name;
    int32_t *array; /* [n], within [0, n_array) */
    size_t n_column;
    struct snapshot_column *column;
    double *x;    /* [3 n] */
    char *x_unit; /* may be "" */
};

/* Reads a snapshot of ours, or any VTKHDF file of an unstructured grid. Numbers become doubles;
 * columns that are no numbers are passed over. A damaged or foreign file is an error. */
int snapshot_read(struct snapshot *s, const char *path, struct error *e);
void snapshot_free(struct snapshot *s);
/* The column of that name, or NULL. */
const struct snapshot_column *snapshot_find(const struct snapshot *s, const char *name);

#endif
