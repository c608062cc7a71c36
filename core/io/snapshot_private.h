/* snapshot_private.h -- what the files snapshot*.c that write share: the file's columns, and rows of them. */
#ifndef IO_SNAPSHOT_PRIVATE_H
#define IO_SNAPSHOT_PRIVATE_H

#include "io/h5.h"
#include "io/snapshot.h"

#define SNAPSHOT_SLAB ((size_t)1 << 15) /* rows converted and written at once */

/* A column of the file: the union over the arrays. */
struct out_column {
    const struct column *like; /* of the first array that has it */
    uint32_t ncomp;            /* components in the file */
    char *path;                /* within the group VTKHDF */
    size_t *at;                /* [arrays] its index in each, or SIZE_MAX: not there */
};

struct writer {
    struct h5_out file;
    hid_t group;
    const struct particles *arrays;
    size_t n_array;
    struct snapshot_parts parts;
    bool apart;   /* rows are written later on, by all */
    size_t total; /* particles in the file */
    struct out_column *column;
    size_t n_column;
    void *slab;
    struct error *e;
};

/* Which columns there are, and room for a slab of the widest. Fails where two arrays disagree. */
int snapshot_columns(struct writer *w);
void snapshot_columns_free(struct writer *w);

/* One data set of all particles: the points, the column "array", or a column. */
struct out_set {
    const char *name;            /* within the group VTKHDF */
    const struct out_column *of; /* NULL: "array" */
    bool points;
    uint32_t ncomp;
    hid_t type;
};
/* The k-th; how many there are is w->n_column + 1. Points come first, then "array". */
struct out_set snapshot_set(const struct writer *w, size_t k);
/* Rows [first, first + count) of this process's particles into the slab. */
void snapshot_rows(const struct writer *w, const struct out_set *set, size_t first, size_t count);

#endif
