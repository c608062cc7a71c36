/* scene/read.h -- particles from a file: CSV with named columns, or HDF5. */
#ifndef SCENE_READ_H
#define SCENE_READ_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>

/* Named columns of numbers. Components of vectors are columns of their own: "v.x", "v.y", "v.z";
 * positions are "x", "y", "z"; components of tensors "s.0", "s.1", ... */
struct table {
    size_t n, n_column;
    struct table_column {
        char *name;
        double *value; /* [n] */
    } * column;
    bool snapshot; /* of our own: it may well have columns that the scene has no use for */
};

/* By the file's first bytes: HDF5 (a snapshot of ours; or datasets of equal length at its root,
 * one number or up to nine a row), else CSV (a line of names, then lines of numbers; lines that
 * begin with "#" are left out). `array`: of a snapshot, this array's particles only; NULL: all.
 * Errors name file, line and column; EXIT_USAGE. On failure nothing is to be freed. */
int table_read(struct table *t, const char *path, const char *array, struct error *e);
void table_free(struct table *t);
/* Index of a column, or -1. */
int table_find(const struct table *t, const char *name);

/* An empty column of t->n rows, for the readers; NULL when out of memory. */
double *table_add(struct table *t, const char *name);

#endif
