/* scene/read_hdf5.c -- particles out of HDF5: a snapshot (by io/snapshot.h), or a file of plain
 * datasets at its root, as h5py's users write them: x, y, z or a two-dimensional x, rho, v, ... */
#include "base/text.h"
#include "io/h5.h"
#include "io/snapshot.h"
#include "scene/read_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COMPONENTS_MAX 9

/* "v" and 1 -> "v.y"; tensors count: "s.4". Positions are "x", "y", "z". Free it. */
static char *component_name(const char *name, size_t part, size_t ncomp)
{
    if (ncomp == 1)
        return text_format("%s", name);
    if (!strcmp(name, "x") && ncomp <= 3)
        return text_format("%c", "xyz"[part]);
    return ncomp <= 3 ? text_format("%s.%c", name, "xyz"[part]) : text_format("%s.%zu", name, part);
}

/* Every component of interleaved values as a column; rows for which keep[i] is false are left
 * out. */
static int add_components(struct table *t, const char *name, const double *value, size_t rows,
                          size_t ncomp, const bool *keep)
{
    for (size_t part = 0; part < ncomp; part++) {
        char *full = component_name(name, part, ncomp);
        double *out = full ? table_add(t, full) : NULL;
        free(full);
        if (!out)
            return -1;
        for (size_t i = 0, at = 0; i < rows; i++)
            if (!keep || keep[i])
                out[at++] = value[i * ncomp + part];
    }
    return 0;
}

/* -- Snapshots ------------------------------------------------------------------------------- */

static int find_array(const struct snapshot *s, const char *path, const char *array, int32_t *index,
                      struct error *e)
{
    char hint[256];
    *index = -1;
    for (size_t i = 0; array && i < s->n_array; i++)
        if (!strcmp(s->array_name[i], array))
            *index = (int32_t)i;
    if (!array || *index >= 0)
        return 0;
    return error_set(
        e, EXIT_USAGE, "%s: has no array \"%.60s\"%s", path, array,
        text_suggest(hint, sizeof hint, array, (const char *const *)s->array_name, s->n_array));
}

/* A column that the chosen array lacks is NaN all through there: it is left out. */
static bool is_empty(const struct snapshot_column *c, size_t n, const bool *keep)
{
    for (size_t i = 0; i < n; i++)
        if (keep[i] && isfinite(c->value[i * c->ncomp]))
            return false;
    return true;
}

static int read_snapshot(struct table *t, const char *path, const char *array, struct error *e)
{
    struct snapshot s = {0};
    int32_t index = -1;
    if (snapshot_read(&s, path, e) < 0) {
        if (e)
            e->exit_code = EXIT_USAGE;
        return -1;
    }
    bool *keep = calloc(s.n + 1, sizeof *keep);
    int status = keep ? find_array(&s, path, array, &index, e) : error_memory(e, path, s.n);
    for (size_t i = 0; !status && i < s.n; i++) {
        keep[i] = index < 0 || s.array[i] == index;
        t->n += keep[i];
    }
    t->snapshot = true;
    if (!status && add_components(t, "x", s.x, s.n, 3, keep) < 0)
        status = error_memory(e, path, s.n * sizeof(double));
    for (size_t k = 0; !status && k < s.n_column; k++) {
        const struct snapshot_column *c = &s.column[k];
        if (c->ncomp <= COMPONENTS_MAX && strcmp(c->name, "x") != 0 && !is_empty(c, s.n, keep) &&
            add_components(t, c->name, c->value, s.n, c->ncomp, keep) < 0)
            status = error_memory(e, path, s.n * sizeof(double));
    }
    free(keep);
    snapshot_free(&s);
    return status;
}

/* -- Plain datasets -------------------------------------------------------------------------- */

struct reading {
    struct table *t;
    const char *path;
    struct error *e;
    bool started; /* the number of rows is known */
};

/* One dataset at the root, of numbers, of one or two dimensions. */
static int read_dataset(struct reading *r, hid_t set, const char *name)
{
    hsize_t size[2] = {0, 1};
    hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    int rank = H5Sget_simple_extent_ndims(space), status = 0;
    H5T_class_t class = H5Tget_class(type);
    if (rank == 1 || rank == 2)
        H5Sget_simple_extent_dims(space, size, NULL);
    H5Tclose(type);
    H5Sclose(space);
    if ((class != H5T_FLOAT && class != H5T_INTEGER) || rank < 1 || rank > 2)
        return 0; /* a scalar, a text: not a column */
    if (size[1] < 1 || size[1] > COMPONENTS_MAX)
        return error_set(r->e, EXIT_USAGE, "%s: dataset \"%.60s\" has %llu components; at most %d",
                         r->path, name, (unsigned long long)size[1], COMPONENTS_MAX);
    if (r->started && size[0] != r->t->n)
        return error_set(r->e, EXIT_USAGE, "%s: dataset \"%.60s\" has %llu rows, others %zu",
                         r->path, name, (unsigned long long)size[0], r->t->n);
    r->t->n = (size_t)size[0];
    r->started = true;
    double *value = calloc(r->t->n + 1, (size_t)size[1] * sizeof *value);
    if (!value)
        return error_memory(r->e, r->path, r->t->n * (size_t)size[1] * sizeof *value);
    if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) < 0)
        status = error_set(r->e, EXIT_USAGE, "%s: dataset \"%.60s\" cannot be read", r->path, name);
    for (size_t i = 0; !status && i < r->t->n * (size_t)size[1]; i++)
        if (!isfinite(value[i]))
            status = error_set(r->e, EXIT_USAGE, "%s: row %zu of dataset \"%.60s\" is not a number",
                               r->path, i / (size_t)size[1], name);
    if (!status && add_components(r->t, name, value, r->t->n, (size_t)size[1], NULL) < 0)
        status = error_memory(r->e, r->path, r->t->n * sizeof *value);
    free(value);
    return status;
}

/* H5Literate's callback: an error of ours ends it with -1. */
static herr_t visit(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    H5O_info_t about;
    (void)info;
    if (H5Oget_info_by_name(group, name, &about, H5P_DEFAULT) < 0 || about.type != H5O_TYPE_DATASET)
        return 0;
    hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
    if (set < 0)
        return 0;
    int status = read_dataset(context, set, name);
    H5Dclose(set);
    return status < 0 ? -1 : 0;
}

static int read_plain(struct table *t, hid_t file, const char *path, struct error *e)
{
    struct error inner = {0};
    struct reading r = {.t = t, .path = path, .e = &inner};
    hsize_t index = 0;
    if (H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, &index, visit, &r) < 0) {
        if (!inner.text[0])
            return error_set(e, EXIT_USAGE, "%s: is damaged", path);
        return error_set(e, EXIT_USAGE, "%s", inner.text);
    }
    if (!t->n_column)
        return error_set(e, EXIT_USAGE,
                         "%s: is no snapshot, and has no datasets of numbers at its root", path);
    return 0;
}

int table_read_hdf5(struct table *t, const char *path, const char *array, struct error *e)
{
    hid_t file = h5_open(path, e);
    if (file < 0) {
        if (e)
            e->exit_code = EXIT_USAGE;
        return -1;
    }
    H5E_auto2_t printer;
    void *data;
    H5Eget_auto2(H5E_DEFAULT, &printer, &data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* HDF5 would print its stack */
    bool snapshot = H5Lexists(file, "VTKHDF", H5P_DEFAULT) > 0;
    int status = 0;
    if (!snapshot && array)
        status = error_set(e, EXIT_USAGE, "%s: is no snapshot, so it has no array \"%.60s\"", path,
                           array);
    else if (!snapshot)
        status = read_plain(t, file, path, e);
    H5Fclose(file);
    H5Eset_auto2(H5E_DEFAULT, printer, data);
    return snapshot ? read_snapshot(t, path, array, e) : status;
}
