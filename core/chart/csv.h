/* chart/csv.h -- a table of texts with named columns: a CSV file as a whole. */
#ifndef CHART_CSV_H
#define CHART_CSV_H

#include "base/error.h"
#include <stddef.h>

struct csv {
    char **name;  /* [n_column] */
    char **cell;  /* [n_row][n_column] */
    size_t *line; /* [n_row] in the file, from 1 */
    size_t n_column, n_row;
};

/* Reads a CSV file (RFC 4180; lines that begin with "#" are comments). Every row has a cell for every
 * column, or it is an error that names the line. On failure nothing is to be freed. */
int csv_read(struct csv *t, const char *path, struct error *e);
/* As above, of a text in memory; `path` is for messages. */
int csv_parse(struct csv *t, const char *path, const char *text, size_t n, struct error *e);
void csv_free(struct csv *t);
/* Index of a column, or (size_t)-1. */
size_t csv_column(const struct csv *t, const char *name);
const char *csv_cell(const struct csv *t, size_t row, size_t column);

#endif
