/* io/cells.h -- a table of texts with named columns: a CSV file as a whole. */
#ifndef IO_CELLS_H
#define IO_CELLS_H

#include "base/error.h"
#include <stddef.h>

struct cells {
    char **name;  /* [n_column] */
    char **cell;  /* [n_row][n_column] */
    size_t *line; /* [n_row] in the file, from 1 */
    size_t n_column, n_row;
};

/* Reads a CSV file (RFC 4180; lines that begin with "#" are comments). Every row has a cell for every
 * column, or it is an error that names the line. On failure nothing is to be freed. */
int cells_read(struct cells *t, const char *path, struct error *e);
/* As above, of a text in memory; `path` is for messages. */
int cells_parse(struct cells *t, const char *path, const char *text, size_t n, struct error *e);
void cells_free(struct cells *t);
/* Index of a column, or (size_t)-1. */
size_t cells_column(const struct cells *t, const char *name);
const char *cells_at(const struct cells *t, size_t row, size_t column);

#endif
