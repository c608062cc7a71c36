/* sph/tables.h -- extension: named columns of numbers that a scene hands to a parameter, such as a
 * prescribed motion or a tabulated equation of state. Declare the parameter with type
 * SPH_PARAM_TABLE; in a scene it is the name of a CSV or HDF5 file (relative to the scene) or an
 * object of columns: {"t": [0, 1], "v": [0, 2]}. */
#ifndef SPH_TABLES_H
#define SPH_TABLES_H

#include <sph/host.h>

SPH_BEGIN_DECLS

#define SPH_EXT_TABLES "sph.tables/0"

/* Columns of one length. The host's; lives until the use's destroy has returned. */
typedef struct sph_table {
    uint32_t size;
    uint32_t n_columns;
    uint64_t n_rows;             /* at least 1 */
    const char *const *name;     /* [n_columns], UTF-8 */
    const double *const *column; /* [n_columns][n_rows], finite numbers in the file's own units */
    const char *source;          /* the file's name, or "scene", for messages */
} sph_table;

typedef struct sph_tables {
    uint32_t size, reserved;
    /* The table that the scene gives to `param`; NULL if it gives none, or if no table of that
     * name is declared. Keep the pointer in your state. [main], in sph_life.create only */
    const sph_table *(*get)(const sph_config *, const char *param);
} sph_tables;

/* The column of that name, or NULL. [any] */
static inline const double *sph_table_column(const sph_table *table, const char *name)
{
    uint32_t i;
    for (i = 0; i < table->n_columns; i++) {
        const char *a = table->name[i], *b = name;
        while (*a && *a == *b) {
            a++;
            b++;
        }
        if (*a == *b)
            return table->column[i];
    }
    return NULL;
}

/* y at x by straight lines between the rows; x_column rises. Beyond the ends the end's value.
 * [any] */
static inline double sph_table_linear(const sph_table *table, const double *x_column,
                                      const double *y_column, double x)
{
    uint64_t low = 0, high = table->n_rows - 1;
    if (!(x > x_column[0]))
        return y_column[0];
    if (x >= x_column[high])
        return y_column[high];
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        if (x_column[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    return y_column[low] + (y_column[high] - y_column[low]) * (x - x_column[low]) /
                               (x_column[high] - x_column[low]);
}

SPH_END_DECLS
#endif
