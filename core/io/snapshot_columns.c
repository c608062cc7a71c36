/* snapshot_columns.c -- the columns of a snapshot: which there are over all arrays, and rows of them as they stand
 * in the file. */
#include "config.h"

#include "io/snapshot_private.h"

#include "base/text.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- Rows -------------------------------------------------------------------------------------- */

static bool is_integer(uint32_t type)
{
    return type == SPH_INT32 || type == SPH_INT64;
}

static void fill_nothing(const struct out_column *c, size_t values, char *to)
{
    for (size_t i = 0; i < values; i++) {
        if (c->like->type == SPH_INT32)
            ((int32_t *)(void *)to)[i] = -1;
        else if (c->like->type == SPH_INT64)
            ((int64_t *)(void *)to)[i] = -1;
        else
            ((double *)(void *)to)[i] = (double)NAN;
    }
}

/* Rows [first, first + count) of array `a`. */
static void fill_column(const struct writer *w, const struct out_column *c, size_t a, size_t first,
                        size_t count, char *to)
{
    if (c->at[a] == SIZE_MAX) {
        fill_nothing(c, count * c->ncomp, to);
        return;
    }
    const struct column *from = &w->arrays[a].column[c->at[a]];
    const bool real = column_is_real(from);
    const size_t size = real ? sizeof(double) : from->size;
    if (from->ncomp < c->ncomp)
        memset(to, 0, count * c->ncomp * size);
    for (uint32_t k = 0; k < from->ncomp; k++) {
        const size_t offset = k * from->plane + first;
        for (size_t i = 0; i < count; i++) {
            char *cell = to + (i * c->ncomp + k) * size;
            if (real) { /* doubles in the file, whatever they are in memory */
                const double value = column_get(from, k, first + i);
                memcpy(cell, &value, sizeof value);
            } else if (size == sizeof(int64_t)) {
                memcpy(cell, (const char *)from->data + (offset + i) * 8, 8);
            } else {
                memcpy(cell, (const char *)from->data + (offset + i) * 4, 4);
            }
        }
    }
}

/* Positions become doubles of three components, whatever they are in memory. */
static void fill_points(const struct writer *w, const struct out_column *c, size_t a, size_t first,
                        size_t count, double *to)
{
    const struct column *from = c->at[a] == SIZE_MAX ? NULL : &w->arrays[a].column[c->at[a]];
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++)
            to[3 * i + k] = from && k < from->ncomp ? column_get(from, k, first + i) : 0.0;
}

static void fill(const struct writer *w, const struct out_set *set, size_t a, size_t first,
                 size_t count, void *to)
{
    if (set->points)
        fill_points(w, set->of, a, first, count, to);
    else if (set->of)
        fill_column(w, set->of, a, first, count, to);
    else
        for (size_t i = 0; i < count; i++)
            ((int32_t *)to)[i] = (int32_t)a;
}

void snapshot_rows(const struct writer *w, const struct out_set *set, size_t first, size_t count)
{
    const size_t row = set->ncomp * H5Tget_size(set->type), end = first + count;
    size_t begin = 0; /* of the array */
    for (size_t a = 0; a < w->n_array; a++) {
        const size_t after = begin + w->arrays[a].n;
        const size_t from = first > begin ? first : begin, to = end < after ? end : after;
        if (from < to)
            fill(w, set, a, from - begin, to - from, (char *)w->slab + (from - first) * row);
        begin = after;
    }
}

struct out_set snapshot_set(const struct writer *w, size_t k)
{
    size_t x = 0; /* positions stand before the others, as points */
    while (x < w->n_column && strcmp(w->column[x].like->name, "x") != 0)
        x++;
    if (k == 0)
        return (struct out_set){"Points", x < w->n_column ? &w->column[x] : NULL, true, 3,
                                H5T_NATIVE_DOUBLE};
    if (k == 1)
        return (struct out_set){"PointData/array", NULL, false, 1, H5T_NATIVE_INT32};
    const struct out_column *c = &w->column[k - 2 < x ? k - 2 : k - 1];
    const hid_t type = c->like->type == SPH_INT32  ? H5T_NATIVE_INT32
                       : is_integer(c->like->type) ? H5T_NATIVE_INT64
                                                   : H5T_NATIVE_DOUBLE;
    return (struct out_set){c->path, c, false, c->ncomp, type};
}

/* -- Which columns ----------------------------------------------------------------------------- */

static int note_column(struct writer *w, size_t a, size_t k)
{
    const struct column *c = &w->arrays[a].column[k];
    struct out_column *o = NULL;
    for (size_t i = 0; i < w->n_column && !o; i++)
        if (strcmp(w->column[i].like->name, c->name) == 0)
            o = &w->column[i];
    if (!o) {
        if (!*c->name || strchr(c->name, '/') || strcmp(c->name, ".") == 0 ||
            strcmp(c->name, "array") == 0)
            return error_set(w->e, EXIT_USAGE, "a column of a snapshot cannot be called \"%s\"",
                             c->name);
        o = &w->column[w->n_column];
        o->at = malloc((w->n_array + 1) * sizeof *o->at);
        o->path = text_format("PointData/%s", c->name);
        w->n_column++;
        if (!o->at || !o->path)
            return error_memory(w->e, "a snapshot", w->n_array * sizeof *o->at);
        o->like = c;
        o->ncomp = c->type == SPH_VECTOR ? 3 : c->ncomp;
        for (size_t i = 0; i < w->n_array; i++)
            o->at[i] = SIZE_MAX;
    }
    if (o->like->type != c->type || o->like->ncomp != c->ncomp)
        return error_set(w->e, EXIT_USAGE,
                         "column \"%s\" of array \"%s\" differs in type from that of other arrays",
                         c->name, w->arrays[a].name);
    o->at[a] = k;
    return 0;
}

int snapshot_columns(struct writer *w)
{
    size_t most = 1, widest = 3;
    for (size_t a = 0; a < w->n_array; a++)
        most += w->arrays[a].n_column;
    w->column = calloc(most, sizeof *w->column);
    if (!w->column)
        return error_memory(w->e, "a snapshot", most * sizeof *w->column);
    for (size_t a = 0; a < w->n_array; a++)
        for (size_t k = 0; k < w->arrays[a].n_column; k++)
            if (w->arrays[a].column[k].output || strcmp(w->arrays[a].column[k].name, "x") == 0)
                if (note_column(w, a, k))
                    return -1;
    for (size_t i = 0; i < w->n_column; i++)
        if (w->column[i].ncomp > widest)
            widest = w->column[i].ncomp;
    w->slab = malloc(SNAPSHOT_SLAB * widest * sizeof(double));
    return w->slab ? 0 : error_memory(w->e, "a snapshot", SNAPSHOT_SLAB * widest * sizeof(double));
}

void snapshot_columns_free(struct writer *w)
{
    for (size_t i = 0; i < w->n_column; i++) {
        free(w->column[i].at);
        free(w->column[i].path);
    }
    free(w->column);
    free(w->slab);
}
