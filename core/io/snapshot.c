/* snapshot.c -- writes snapshots as VTKHDF: the particles as a grid of vertex cells, what they
 * are and where they come from as attributes and field data. Reading is in snapshot_read.c. */
#include "config.h"

#include "io/snapshot.h"

#include "io/h5.h"
#include "io/output.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define SLAB ((size_t)1 << 15) /* rows converted and written at once */
#define VTK_VERTEX 1
#define NOT_THERE ((size_t)-1)

/* A column of the file: the union over the arrays. */
struct out_column {
    const struct column *like; /* of the first array that has it */
    uint32_t ncomp;            /* components in the file */
    size_t *at;                /* [arrays] its index in each, or NOT_THERE */
};

struct writer {
    struct h5_out file;
    hid_t group;
    const struct particles *arrays;
    size_t n_array;
    size_t total; /* particles */
    struct out_column *column;
    size_t n_column;
    void *slab;
    struct error *e;
};

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

/* Fills rows [first, first + count) of array `a` into the slab. */
typedef void fill_fn(const struct writer *w, const void *what, size_t a, size_t first,
                     size_t count);

static bool is_integer(uint32_t type)
{
    return type == SPH_INT32 || type == SPH_INT64;
}

static void fill_nothing(const struct writer *w, const struct out_column *c, size_t values)
{
    for (size_t i = 0; i < values; i++) {
        if (c->like->type == SPH_INT32)
            ((int32_t *)w->slab)[i] = -1;
        else if (c->like->type == SPH_INT64)
            ((int64_t *)w->slab)[i] = -1;
        else
            ((double *)w->slab)[i] = (double)NAN;
    }
}

static void fill_column(const struct writer *w, const void *what, size_t a, size_t first,
                        size_t count)
{
    const struct out_column *c = what;
    if (c->at[a] == NOT_THERE) {
        fill_nothing(w, c, count * c->ncomp);
        return;
    }
    const struct column *from = &w->arrays[a].column[c->at[a]];
    const bool real = column_is_real(from);
    if (from->ncomp < c->ncomp)
        memset(w->slab, 0, count * c->ncomp * (real ? sizeof(double) : from->size));
    for (uint32_t k = 0; k < from->ncomp; k++) {
        const size_t offset = k * from->plane + first;
        if (real) /* doubles in the file, whatever they are in memory */
            for (size_t i = 0; i < count; i++)
                ((double *)w->slab)[i * c->ncomp + k] = column_get(from, k, first + i);
        else if (from->size == sizeof(int64_t))
            for (size_t i = 0; i < count; i++)
                memcpy((char *)w->slab + (i * c->ncomp + k) * 8,
                       (char *)from->data + (offset + i) * 8, 8);
        else
            for (size_t i = 0; i < count; i++)
                memcpy((char *)w->slab + (i * c->ncomp + k) * 4,
                       (char *)from->data + (offset + i) * 4, 4);
    }
}

/* Positions become doubles, whatever they are in memory. */
static void fill_points(const struct writer *w, const void *what, size_t a, size_t first,
                        size_t count)
{
    const struct out_column *c = what;
    double *to = w->slab;
    const struct column *from = c->at[a] == NOT_THERE ? NULL : &w->arrays[a].column[c->at[a]];
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            double x = 0.0;
            if (from && k < from->ncomp)
                x = column_get(from, k, first + i);
            to[3 * i + k] = x;
        }
}

static void fill_array(const struct writer *w, const void *what, size_t a, size_t first,
                       size_t count)
{
    (void)what;
    (void)first;
    for (size_t i = 0; i < count; i++)
        ((int32_t *)w->slab)[i] = (int32_t)a;
}

/* Writes a data set of all particles, slab by slab, so that a big one needs no second copy. */
static int put_rows(struct writer *w, hid_t set, hid_t type, uint32_t ncomp, fill_fn *fill,
                    const void *what)
{
    const hid_t space = H5Dget_space(set);
    int result = space < 0 ? failed(w) : 0;
    hsize_t row = 0;
    for (size_t a = 0; a < w->n_array; a++)
        for (size_t i = 0; i < w->arrays[a].n && result == 0; i += SLAB) {
            const size_t left = w->arrays[a].n - i, count = left < SLAB ? left : SLAB;
            const hsize_t start[2] = {row, 0}, extent[2] = {count, ncomp};
            const hid_t memory = H5Screate_simple(ncomp > 1 ? 2 : 1, extent, NULL);
            fill(w, what, a, i, count);
            if (memory < 0 ||
                H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL) < 0 ||
                H5Dwrite(set, type, memory, space, H5P_DEFAULT, w->slab) < 0)
                result = failed(w);
            else if (w->file.disk.error)
                result = -1; /* h5_close says which */
            if (memory >= 0)
                H5Sclose(memory);
            row += count;
        }
    if (space >= 0)
        H5Sclose(space);
    return result;
}

/* A data set of all particles in `where`; its id, or a negative number. */
static hid_t make_rows(struct writer *w, hid_t where, const char *name, hid_t type, uint32_t ncomp)
{
    const hsize_t extent[2] = {w->total, ncomp};
    const hid_t space = H5Screate_simple(ncomp > 1 ? 2 : 1, extent, NULL);
    const hid_t set = H5Dcreate2(where, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (set < 0)
        failed(w);
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

static int put_column(struct writer *w, hid_t where, const char *name, hid_t type,
                      const struct out_column *c, fill_fn *fill)
{
    const hid_t set = make_rows(w, where, name, type, c->ncomp);
    if (set < 0)
        return -1;
    int result = put_rows(w, set, type, c->ncomp, fill, c);
    if (result == 0 && c->like)
        result = put_text_attribute(w, set, "unit", c->like->unit) ||
                 put_text_attribute(w, set, "doc", c->like->doc) ||
                 ((c->like->type == SPH_SYM || c->like->type == SPH_MATRIX) &&
                  put_text_attribute(w, set, "components", component_names(c->like)));
    H5Dclose(set);
    return result ? -1 : 0;
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
        o->at = malloc(w->n_array * sizeof *o->at);
        if (!o->at)
            return error_memory(w->e, "a snapshot", w->n_array * sizeof *o->at);
        w->n_column++;
        o->like = c;
        o->ncomp = c->type == SPH_VECTOR ? 3 : c->ncomp;
        for (size_t i = 0; i < w->n_array; i++)
            o->at[i] = NOT_THERE;
    }
    if (o->like->type != c->type || o->like->ncomp != c->ncomp)
        return error_set(w->e, EXIT_USAGE,
                         "column \"%s\" of array \"%s\" differs in type from that of other arrays",
                         c->name, w->arrays[a].name);
    o->at[a] = k;
    return 0;
}

static int note_columns(struct writer *w)
{
    size_t most = 1, widest = 3;
    for (size_t a = 0; a < w->n_array; a++) {
        most += w->arrays[a].n_column;
        w->total += w->arrays[a].n;
    }
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
    w->slab = malloc(SLAB * widest * sizeof(double));
    return w->slab ? 0 : error_memory(w->e, "a snapshot", SLAB * widest * sizeof(double));
}

/* -- The parts of the file --------------------------------------------------------------------- */

static int put_header(struct writer *w)
{
    const int64_t version[2] = {1, 0}, n = (int64_t)w->total;
    const char kind[] = "UnstructuredGrid";
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, sizeof kind - 1) < 0 ||
        H5Tset_strpad(type, H5T_STR_NULLPAD) < 0)
        return failed(w);
    const int result =
        put_value(w, w->group, "Version", H5T_NATIVE_INT64, version, 2, true) ||
        put_value(w, w->group, "Type", type, kind, 1, true) ||
        put_value(w, w->group, "NumberOfPoints", H5T_NATIVE_INT64, &n, 1, false) ||
        put_value(w, w->group, "NumberOfCells", H5T_NATIVE_INT64, &n, 1, false) ||
        put_value(w, w->group, "NumberOfConnectivityIds", H5T_NATIVE_INT64, &n, 1, false);
    H5Tclose(type);
    return result ? -1 : 0;
}

/* The cells that VTK wants: vertex i is point i. Numbers without surprise, so they are packed:
 * 17 bytes a particle become less than one. */
static int put_cells(struct writer *w, const char *name, hid_t type, size_t size, size_t n)
{
    const hsize_t extent[1] = {n}, chunk[1] = {n < SLAB ? (n ? n : 1) : SLAB};
    const hid_t space = H5Screate_simple(1, extent, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
    if (list >= 0 && n > 0 && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
        H5Pset_chunk(list, 1, chunk);
        H5Pset_shuffle(list);
        H5Pset_deflate(list, 1);
    }
    const hid_t set = H5Dcreate2(w->group, name, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    int result = set < 0 ? failed(w) : 0;
    for (size_t i = 0; i < n && result == 0; i += SLAB) {
        const hsize_t start[1] = {i}, count[1] = {n - i < SLAB ? n - i : SLAB};
        if (size == 1)
            memset(w->slab, VTK_VERTEX, count[0]);
        else
            for (size_t k = 0; k < count[0]; k++)
                ((int64_t *)w->slab)[k] = (int64_t)(i + k);
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
    struct out_column *x = NULL;
    for (size_t i = 0; i < w->n_column; i++)
        if (strcmp(w->column[i].like->name, "x") == 0)
            x = &w->column[i];
    if (!x)
        return error_set(w->e, EXIT_RUN, "cannot write %s: the particles have no positions",
                         w->file.shown);
    x->ncomp = 3;
    return put_column(w, w->group, "Points", H5T_NATIVE_DOUBLE, x, fill_points) ||
                   put_cells(w, "Connectivity", H5T_NATIVE_INT64, 8, w->total) ||
                   put_cells(w, "Offsets", H5T_NATIVE_INT64, 8, w->total + 1) ||
                   put_cells(w, "Types", H5T_NATIVE_UINT8, 1, w->total)
               ? -1
               : 0;
}

static int put_columns(struct writer *w)
{
    const hid_t where = H5Gcreate2(w->group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (where < 0)
        return failed(w);
    const struct out_column of_array = {NULL, 1, NULL};
    int result = put_column(w, where, "array", H5T_NATIVE_INT32, &of_array, fill_array);
    for (size_t i = 0; i < w->n_column && result == 0; i++) {
        const struct column *c = w->column[i].like;
        const hid_t type = c->type == SPH_INT32  ? H5T_NATIVE_INT32
                           : is_integer(c->type) ? H5T_NATIVE_INT64
                                                 : H5T_NATIVE_DOUBLE;
        if (strcmp(c->name, "x") != 0)
            result = put_column(w, where, c->name, type, &w->column[i], fill_column);
    }
    H5Gclose(where);
    return result;
}

static int put_array_list(struct writer *w, hid_t where)
{
    const char **name = calloc(w->n_array + 1, sizeof *name);
    int64_t *size = calloc(w->n_array + 1, sizeof *size);
    int result;
    if (name && size) {
        for (size_t a = 0; a < w->n_array; a++) {
            name[a] = w->arrays[a].name;
            size[a] = (int64_t)w->arrays[a].n;
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

int snapshot_write(const char *path, const struct particles *arrays, size_t n,
                   const struct snapshot_meta *meta, struct error *e)
{
    struct writer w = {.group = -1, .arrays = arrays, .n_array = n, .e = e};
    char *shown = output_shown(path);
    int result = shown ? note_columns(&w) : error_memory(e, "a path", strlen(path));
    if (result == 0)
        result = h5_create(&w.file, path, shown, e);
    if (result == 0)
        result = h5_close(&w.file, put_all(&w, meta), e);
    for (size_t i = 0; i < w.n_column; i++)
        free(w.column[i].at);
    free(w.column);
    free(w.slab);
    free(shown);
    return result;
}
