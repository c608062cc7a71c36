/* snapshot.c -- writes snapshots as VTKHDF: the particles as a grid of vertex cells, what they
 * are and where they come from as attributes and field data. Reading is in snapshot_read.c; what
 * several processes do together in snapshot_together.c. */
#include "config.h"

#include "io/snapshot_private.h"

#include "io/output.h"
#include <stdlib.h>
#include <string.h>

#define SLAB SNAPSHOT_SLAB
#define VTK_VERTEX 1

static int failed(struct writer *w)
{
    return h5_error(w->e, EXIT_RUN, "write", w->file.shown);
}

/* -- Small things: attributes, field data ------------------------------------------------------ */

/* Writes one value as an attribute of `where`, or as a data set of one element in it. */
static int put_value(struct writer *w, hid_t where, const char *name, hid_t type, const void *value,
                     size_t n, bool attribute)
{
    const hsize_t extent[1] = {n};
    const hid_t space =
        n == 1 && attribute ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, extent, NULL);
    const hid_t id =
        attribute ? H5Acreate2(where, name, type, space, H5P_DEFAULT, H5P_DEFAULT)
                  : H5Dcreate2(where, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    int result = 0;
    if (id < 0 || (attribute ? H5Awrite(id, type, value)
                             : H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value)) < 0)
        result = failed(w);
    if (id >= 0)
        attribute ? H5Aclose(id) : H5Dclose(id);
    if (space >= 0)
        H5Sclose(space);
    return result;
}

/* Attributes are of variable length in UTF-8: h5py makes str of them. */
static int put_text_attribute(struct writer *w, hid_t where, const char *name, const char *text)
{
    const char *const value = text ? text : "";
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, H5T_VARIABLE) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)
        return failed(w);
    const int result = put_value(w, where, name, type, &value, 1, true);
    H5Tclose(type);
    return result;
}

/* Field data: texts of fixed length, ASCII by name (the bytes are UTF-8). VTK 9.1 reads no
 * others. */
static int put_texts(struct writer *w, hid_t where, const char *name, const char *const *text,
                     size_t n)
{
    size_t size = 1;
    for (size_t i = 0; i < n; i++)
        if (text[i] && strlen(text[i]) > size)
            size = strlen(text[i]);
    char *flat = calloc(n + 1, size);
    if (!flat)
        return error_memory(w->e, "the texts of a snapshot", n * size);
    for (size_t i = 0; i < n; i++)
        if (text[i])
            memcpy(flat + i * size, text[i], strlen(text[i]));
    int result = -1;
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, size) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0)
        failed(w);
    else
        result = put_value(w, where, name, type, flat, n, false);
    if (type >= 0)
        H5Tclose(type);
    free(flat);
    return result;
}

static int put_text(struct writer *w, hid_t where, const char *name, const char *text)
{
    return put_texts(w, where, name, &text, 1);
}

/* -- Columns ----------------------------------------------------------------------------------- */

/* Writes a data set of all particles, slab by slab, so that a big one needs no second copy. */
static int put_rows(struct writer *w, hid_t set, const struct out_set *what)
{
    const hid_t space = H5Dget_space(set);
    int result = space < 0 ? failed(w) : 0;
    for (size_t row = 0; row < w->total && result == 0; row += SLAB) {
        const size_t left = w->total - row, count = left < SLAB ? left : SLAB;
        const hsize_t start[2] = {row, 0}, extent[2] = {count, what->ncomp};
        const hid_t memory = H5Screate_simple(what->ncomp > 1 ? 2 : 1, extent, NULL);
        snapshot_rows(w, what, row, count);
        if (memory < 0 ||
            H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL) < 0 ||
            H5Dwrite(set, what->type, memory, space, H5P_DEFAULT, w->slab) < 0)
            result = failed(w);
        else if (w->file.disk.error)
            result = -1; /* h5_close says which */
        if (memory >= 0)
            H5Sclose(memory);
    }
    if (space >= 0)
        H5Sclose(space);
    return result;
}

/* A data set of all particles in `where`; its id, or a negative number. One that is filled later on has its place
 * in the file at once. */
static hid_t make_rows(struct writer *w, hid_t where, const char *name, const struct out_set *what)
{
    const hsize_t extent[2] = {w->total, what->ncomp};
    const hid_t space = H5Screate_simple(what->ncomp > 1 ? 2 : 1, extent, NULL);
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    hid_t set = -1;
    if (list >= 0 && (!w->apart || (H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY) >= 0 &&
                                    H5Pset_fill_time(list, H5D_FILL_TIME_NEVER) >= 0)))
        set = H5Dcreate2(where, name, what->type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    if (set < 0)
        failed(w);
    if (list >= 0)
        H5Pclose(list);
    if (space >= 0)
        H5Sclose(space);
    return set;
}

static const char *component_names(const struct column *c)
{
    if (c->type == SPH_SYM)
        return c->ncomp == 1 ? "xx" : c->ncomp == 3 ? "xx xy yy" : "xx xy xz yy yz zz";
    return c->ncomp == 1 ? "xx" : c->ncomp == 4 ? "xx xy yx yy" : "xx xy xz yx yy yz zx zy zz";
}

static int put_set(struct writer *w, const struct out_set *what)
{
    const hid_t set = make_rows(w, w->group, what->name, what);
    const struct column *like = what->of ? what->of->like : NULL;
    if (set < 0)
        return -1;
    int result = w->apart ? 0 : put_rows(w, set, what);
    if (result == 0 && like)
        result = put_text_attribute(w, set, "unit", like->unit) ||
                 put_text_attribute(w, set, "doc", like->doc) ||
                 ((like->type == SPH_SYM || like->type == SPH_MATRIX) &&
                  put_text_attribute(w, set, "components", component_names(like)));
    H5Dclose(set);
    return result ? -1 : 0;
}

/* -- The parts of the file --------------------------------------------------------------------- */

/* A number of each part. */
static int put_counts(struct writer *w, const char *name)
{
    return put_value(w, w->group, name, H5T_NATIVE_INT64, w->parts.rows, w->parts.n, false);
}

static int put_header(struct writer *w)
{
    const int64_t version[2] = {1, 0};
    const char kind[] = "UnstructuredGrid";
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, sizeof kind - 1) < 0 ||
        H5Tset_strpad(type, H5T_STR_NULLPAD) < 0)
        return failed(w);
    const int result = put_value(w, w->group, "Version", H5T_NATIVE_INT64, version, 2, true) ||
                       put_value(w, w->group, "Type", type, kind, 1, true) ||
                       put_counts(w, "NumberOfPoints") || put_counts(w, "NumberOfCells") ||
                       put_counts(w, "NumberOfConnectivityIds");
    H5Tclose(type);
    return result ? -1 : 0;
}

/* Which number of its part is next. */
struct cursor {
    size_t part, at;
};

/* The next n cells' numbers, in parts of so many more than their points. */
static void number_cells(const struct writer *w, struct cursor *c, size_t more, int64_t *to,
                         size_t n)
{
    for (size_t k = 0; k < n; k++) {
        for (; c->at == w->parts.rows[c->part] + more; c->part++)
            c->at = 0;
        to[k] = (int64_t)c->at++;
    }
}

/* The cells that VTK wants, in each part: vertex i is point i. Numbers without surprise, so they are
 * packed: 17 bytes a particle become less than one. */
static int put_cells(struct writer *w, const char *name, hid_t type, size_t more)
{
    const hsize_t n = w->total + more * w->parts.n;
    const hsize_t extent[1] = {n}, chunk[1] = {n < SLAB ? (n ? n : 1) : SLAB};
    const hid_t space = H5Screate_simple(1, extent, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
    if (list >= 0 && n > 0 && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
        H5Pset_chunk(list, 1, chunk);
        H5Pset_shuffle(list);
        H5Pset_deflate(list, 1);
    }
    const hid_t set = H5Dcreate2(w->group, name, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    int result = set < 0 ? failed(w) : 0;
    struct cursor next = {0, 0};
    for (hsize_t i = 0; i < n && result == 0; i += SLAB) {
        const hsize_t start[1] = {i}, count[1] = {n - i < SLAB ? n - i : SLAB};
        if (H5Tget_size(type) == 1)
            memset(w->slab, VTK_VERTEX, count[0]);
        else
            number_cells(w, &next, more, w->slab, count[0]);
        const hid_t memory = H5Screate_simple(1, count, NULL);
        if (memory < 0 ||
            H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) < 0 ||
            H5Dwrite(set, type, memory, space, H5P_DEFAULT, w->slab) < 0)
            result = failed(w);
        if (memory >= 0)
            H5Sclose(memory);
    }
    if (set >= 0)
        H5Dclose(set);
    if (list >= 0)
        H5Pclose(list);
    if (space >= 0)
        H5Sclose(space);
    return result;
}

static int put_grid(struct writer *w)
{
    const struct out_set points = snapshot_set(w, 0);
    if (!points.of)
        return error_set(w->e, EXIT_RUN, "cannot write %s: the particles have no positions",
                         w->file.shown);
    return put_set(w, &points) || put_cells(w, "Connectivity", H5T_NATIVE_INT64, 0) ||
                   put_cells(w, "Offsets", H5T_NATIVE_INT64, 1) ||
                   put_cells(w, "Types", H5T_NATIVE_UINT8, 0)
               ? -1
               : 0;
}

static int put_columns(struct writer *w)
{
    const hid_t where = H5Gcreate2(w->group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (where < 0)
        return failed(w);
    H5Gclose(where);
    for (size_t k = 1; k <= w->n_column; k++) {
        const struct out_set set = snapshot_set(w, k);
        if (put_set(w, &set))
            return -1;
    }
    return 0;
}

static int put_array_list(struct writer *w, hid_t where)
{
    const char **name = calloc(w->n_array + 1, sizeof *name);
    int64_t *size = calloc(w->n_array + 1, sizeof *size);
    int result;
    if (name && size) {
        for (size_t a = 0; a < w->n_array; a++) {
            name[a] = w->arrays[a].name;
            size[a] = (int64_t)w->parts.size[a];
        }
        result = put_texts(w, where, "array_names", name, w->n_array) ||
                 put_value(w, where, "array_sizes", H5T_NATIVE_INT64, size, w->n_array, false);
    } else {
        result = error_memory(w->e, "a snapshot", w->n_array * sizeof *size);
    }
    free(name);
    free(size);
    return result ? -1 : 0;
}

/* What the columns are, where VTK sees it (it has no eye for attributes), and as texts of fixed
 * length, which a damaged file cannot make dangerous to read. */
static int put_column_list(struct writer *w, hid_t where)
{
    const char **text = calloc(3 * w->n_column + 1, sizeof *text);
    if (!text)
        return error_memory(w->e, "a snapshot", 3 * w->n_column * sizeof *text);
    const char **name = text, **unit = text + w->n_column, **doc = unit + w->n_column;
    for (size_t i = 0; i < w->n_column; i++) {
        name[i] = w->column[i].like->name;
        unit[i] = w->column[i].like->unit;
        doc[i] = w->column[i].like->doc;
    }
    const int result = put_texts(w, where, "column_names", name, w->n_column) ||
                       put_texts(w, where, "column_units", unit, w->n_column) ||
                       put_texts(w, where, "column_docs", doc, w->n_column);
    free(text);
    return result ? -1 : 0;
}

static int put_field_data(struct writer *w, const struct snapshot_meta *m)
{
    const int64_t step = (int64_t)m->step;
    const hid_t where = H5Gcreate2(w->group, "FieldData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (where < 0)
        return failed(w);
    const int result = put_value(w, where, "TimeValue", H5T_NATIVE_DOUBLE, &m->time, 1, false) ||
                       put_value(w, where, "Time", H5T_NATIVE_DOUBLE, &m->time, 1, false) ||
                       put_value(w, where, "Step", H5T_NATIVE_INT64, &step, 1, false) ||
                       put_array_list(w, where) || put_column_list(w, where) ||
                       put_text(w, where, "title", m->title) ||
                       put_text(w, where, "units", m->units) ||
                       put_text(w, where, "version", m->version) ||
                       put_text(w, where, "scene_path", m->scene_path) ||
                       put_text(w, where, "scene", m->scene_text);
    H5Gclose(where);
    return result ? -1 : 0;
}

static int put_file_attributes(struct writer *w, const struct snapshot_meta *m)
{
    const hid_t file = w->file.file;
    const int64_t step = (int64_t)m->step;
    const int32_t dim = w->n_array ? w->arrays[0].dim : 0;
    return put_text_attribute(w, file, "title", m->title) ||
                   put_text_attribute(w, file, "units", m->units) ||
                   put_text_attribute(w, file, "version", m->version) ||
                   put_value(w, file, "dimensions", H5T_NATIVE_INT32, &dim, 1, true) ||
                   put_value(w, file, "time", H5T_NATIVE_DOUBLE, &m->time, 1, true) ||
                   put_value(w, file, "step", H5T_NATIVE_INT64, &step, 1, true)
               ? -1
               : 0;
}

/* All that is in the file, once it is open. */
static int put_all(struct writer *w, const struct snapshot_meta *meta)
{
    w->group = H5Gcreate2(w->file.file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (w->group < 0)
        return failed(w);
    const int result = put_file_attributes(w, meta) || put_header(w) || put_grid(w) ||
                       put_columns(w) || put_field_data(w, meta);
    H5Gclose(w->group);
    return result ? -1 : 0;
}

/* All of the file, or all but the particles' rows. */
static int write_file(struct writer *w, const char *path, const struct snapshot_meta *meta,
                      struct error *e)
{
    char *shown = output_shown(path);
    for (size_t k = 0; k < w->parts.n; k++)
        w->total += w->parts.rows[k];
    int result = shown ? snapshot_columns(w) : error_memory(e, "a path", strlen(path));
    if (result == 0)
        result = h5_create(&w->file, path, shown, e);
    if (result == 0)
        result = h5_close(&w->file, put_all(w, meta), e);
    if (result == 0 && w->apart)
        result = h5_reserve(path, shown, e);
    snapshot_columns_free(w);
    free(shown);
    return result;
}

int snapshot_write(const char *path, const struct particles *arrays, size_t n,
                   const struct snapshot_meta *meta, struct error *e)
{
    struct writer w = {.group = -1, .arrays = arrays, .n_array = n, .e = e};
    uint64_t total = 0, *size = calloc(n + 1, sizeof *size);
    if (!size)
        return error_memory(e, "a snapshot", n * sizeof *size);
    for (size_t a = 0; a < n; a++)
        total += size[a] = arrays[a].n;
    w.parts = (struct snapshot_parts){1, 0, &total, size};
    const int result = write_file(&w, path, meta, e);
    free(size);
    return result;
}

int snapshot_prepare(const char *path, const struct particles *arrays, size_t n,
                     const struct snapshot_parts *parts, const struct snapshot_meta *meta,
                     struct error *e)
{
    struct writer w = {
        .group = -1, .arrays = arrays, .n_array = n, .parts = *parts, .apart = true, .e = e};
    return write_file(&w, path, meta, e);
}
