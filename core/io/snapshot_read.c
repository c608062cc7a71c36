/* snapshot_read.c -- reads snapshots back, ours and those of others. Trusts nothing in a file:
 * sizes are held against the file's own, links and storage that lead out of it are refused. */
#include "config.h"

#include "io/snapshot.h"

#include "base/text.h"
#include "io/h5.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define TEXT_MOST ((size_t)64 << 20) /* bytes of a text */
#define COLUMNS_MOST 4096
#define COMPONENTS_MOST 64
#define TEXTS_MOST 4096    /* in a list; so many arrays at most */
#define PACKED_MOST 1100.0 /* deflate makes at most 1032 bytes of one */

/* Field data "column_names", "column_units" and "column_docs". */
struct words {
    char *name[COLUMNS_MOST], *unit[COLUMNS_MOST], *doc[COLUMNS_MOST];
    size_t n;
};

struct reader {
    const char *path;
    hid_t file, grid;
    double file_size;
    struct words *words;
    struct snapshot *s;
    struct error *e;
};

static int damaged(const struct reader *r, const char *what)
{
    return error_set(r->e, EXIT_USAGE, "cannot read %s: %s", r->path, what);
}

static int unreadable(const struct reader *r)
{
    return h5_error(r->e, EXIT_USAGE, "read", r->path);
}

/* -- Texts ------------------------------------------------------------------------------------- */

/* n bytes as a string of valid UTF-8: others would stop the picture's labels. */
static char *clean_copy(const char *from, size_t n)
{
    char *text = malloc(n + 1);
    size_t bad;
    if (!text)
        return NULL;
    memcpy(text, from, n);
    text[n] = '\0';
    n = strlen(text);
    while ((bad = text_invalid_utf8(text, n)) < n)
        text[bad] = '?';
    return text;
}

static int read_values(hid_t id, bool attribute, hid_t type, void *to)
{
    return (attribute ? H5Aread(id, type, to)
                      : H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to)) < 0
               ? -1
               : 0;
}

/* Texts of an attribute or a data set, at most `most`; returns how many there are. Only of fixed
 * length: in a damaged file HDF5 1.10 searches for those of variable length without end. */
static size_t read_texts(hid_t id, bool attribute, char **to, size_t most)
{
    const hid_t type = attribute ? H5Aget_type(id) : H5Dget_type(id);
    const hid_t space = attribute ? H5Aget_space(id) : H5Dget_space(id);
    const hssize_t n = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    const size_t size = type < 0 ? 0 : H5Tget_size(type);
    size_t count = 0;
    if (n > 0 && n <= TEXTS_MOST && size > 0 && size <= TEXT_MOST / (size_t)n &&
        H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
        char *flat = calloc((size_t)n, size);
        if (flat && read_values(id, attribute, type, flat) == 0)
            for (; count < (size_t)n && count < most; count++)
                if (!(to[count] = clean_copy(flat + count * size, size)))
                    break;
        free(flat);
    }
    if (type >= 0)
        H5Tclose(type);
    if (space >= 0)
        H5Sclose(space);
    return count;
}

/* Whether `name` is there and really in this file (a link may lead to any other). */
static bool is_here(hid_t where, const char *name)
{
    H5L_info_t info;
    return H5Lexists(where, name, H5P_DEFAULT) > 0 &&
           H5Lget_info(where, name, &info, H5P_DEFAULT) >= 0 && info.type == H5L_TYPE_HARD;
}

/* A text by name: of an attribute of `where`; "" if there is none. */
static char *attribute_text(hid_t where, const char *name)
{
    char *text = NULL;
    if (H5Aexists(where, name) > 0) {
        const hid_t id = H5Aopen(where, name, H5P_DEFAULT);
        if (id >= 0) {
            read_texts(id, true, &text, 1);
            H5Aclose(id);
        }
    }
    return text ? text : calloc(1, 1);
}

/* -- Data sets --------------------------------------------------------------------------------- */

/* Whether the data are in the file and not elsewhere. */
static bool is_stored_here(hid_t set)
{
    const hid_t list = H5Dget_create_plist(set);
    const bool here =
        list >= 0 && H5Pget_external_count(list) == 0 && H5Pget_layout(list) != H5D_VIRTUAL;
    if (list >= 0)
        H5Pclose(list);
    return here;
}

static hid_t open_set(hid_t where, const char *name)
{
    const hid_t object = is_here(where, name) ? H5Oopen(where, name, H5P_DEFAULT) : -1;
    if (object >= 0 && H5Iget_type(object) == H5I_DATASET && is_stored_here(object))
        return object;
    if (object >= 0)
        H5Oclose(object);
    return -1;
}

/* Rows and components of a data set of numbers; false if it is none, or none that can be true. */
static bool set_shape(const struct reader *r, hid_t set, size_t *n, uint32_t *ncomp)
{
    hsize_t extent[2] = {0, 1};
    const hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    const int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    const H5T_class_t kind = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    bool good = (kind == H5T_INTEGER || kind == H5T_FLOAT) && (rank == 1 || rank == 2) &&
                H5Sget_simple_extent_dims(space, extent, NULL) == rank;
    if (good) {
        const double bytes = (double)extent[0] * (double)extent[1] * (double)H5Tget_size(type);
        const double stored = (double)H5Dget_storage_size(set);
        good = extent[1] >= 1 && extent[1] <= COMPONENTS_MOST && stored <= r->file_size &&
               bytes <= PACKED_MOST * stored && bytes < 1e15;
    }
    *n = (size_t)extent[0];
    *ncomp = (uint32_t)extent[1];
    if (type >= 0)
        H5Tclose(type);
    if (space >= 0)
        H5Sclose(space);
    return good;
}

static double *read_doubles(const struct reader *r, hid_t set, size_t n, uint32_t ncomp)
{
    double *value = malloc(n * ncomp * sizeof *value + 1);
    if (!value) {
        error_memory(r->e, "a snapshot", n * ncomp * sizeof *value);
        return NULL;
    }
    if (n > 0 && read_values(set, false, H5T_NATIVE_DOUBLE, value)) {
        unreadable(r);
        free(value);
        return NULL;
    }
    return value;
}

/* One number of the field data, or of an attribute of the file. */
static bool read_number(const struct reader *r, const char *field, const char *attribute,
                        double *to)
{
    size_t n;
    uint32_t ncomp;
    double value[1];
    bool found = false;
    char path[64];
    snprintf(path, sizeof path, "FieldData/%s", field);
    if (is_here(r->grid, "FieldData")) {
        const hid_t set = open_set(r->grid, path);
        found = set >= 0 && set_shape(r, set, &n, &ncomp) && n == 1 && ncomp == 1 &&
                read_values(set, false, H5T_NATIVE_DOUBLE, value) == 0;
        if (set >= 0)
            H5Dclose(set);
    }
    if (!found && H5Aexists(r->file, attribute) > 0) {
        const hid_t id = H5Aopen(r->file, attribute, H5P_DEFAULT);
        const hid_t space = id < 0 ? -1 : H5Aget_space(id);
        found = space >= 0 && H5Sget_simple_extent_npoints(space) == 1 &&
                read_values(id, true, H5T_NATIVE_DOUBLE, value) == 0;
        if (space >= 0)
            H5Sclose(space);
        if (id >= 0)
            H5Aclose(id);
    }
    if (found)
        *to = value[0];
    return found;
}

/* Texts of the field data; returns how many. */
static size_t field_texts(const struct reader *r, const char *name, char **to, size_t most)
{
    size_t n = 0;
    char path[64];
    snprintf(path, sizeof path, "FieldData/%s", name);
    if (!is_here(r->grid, "FieldData"))
        return 0;
    const hid_t set = open_set(r->grid, path);
    if (set >= 0) {
        n = read_texts(set, false, to, most);
        H5Dclose(set);
    }
    return n;
}

static char *field_text(const struct reader *r, const char *name)
{
    char *text = NULL;
    return field_texts(r, name, &text, 1) ? text : calloc(1, 1);
}

/* -- Units and documentation of the columns ---------------------------------------------------- */

static int words_read(struct reader *r)
{
    r->words = calloc(1, sizeof *r->words);
    if (!r->words)
        return error_memory(r->e, "a snapshot", sizeof *r->words);
    r->words->n = field_texts(r, "column_names", r->words->name, COLUMNS_MOST);
    field_texts(r, "column_units", r->words->unit, COLUMNS_MOST);
    field_texts(r, "column_docs", r->words->doc, COLUMNS_MOST);
    return 0;
}

static void words_free(struct words *w)
{
    for (size_t i = 0; w && i < COLUMNS_MOST; i++) {
        free(w->name[i]);
        free(w->unit[i]);
        free(w->doc[i]);
    }
    free(w);
}

/* What the field data say of a column, or its own attribute; "" if neither does. */
static char *word_of(const struct reader *r, hid_t set, const char *column, char *const *word,
                     const char *attribute)
{
    for (size_t i = 0; i < r->words->n; i++)
        if (strcmp(r->words->name[i], column) == 0 && word[i])
            return clean_copy(word[i], strlen(word[i]));
    return attribute_text(set, attribute);
}

/* -- The parts of a snapshot ------------------------------------------------------------------- */

static int read_points(struct reader *r)
{
    uint32_t ncomp;
    const hid_t set = open_set(r->grid, "Points");
    if (set < 0)
        return damaged(r, "it has no points");
    int result = -1;
    if (!set_shape(r, set, &r->s->n, &ncomp) || ncomp != 3)
        damaged(r, "its points are not three numbers each, or it is cut short");
    else if ((r->s->x = read_doubles(r, set, r->s->n, 3)))
        result = 0;
    r->s->x_unit = word_of(r, set, "x", r->words->unit, "unit");
    H5Dclose(set);
    return result;
}

/* The column of that name if it is one: 0 read or passed over, -1 error. */
static int read_column(struct reader *r, hid_t where, const char *name)
{
    struct snapshot_column *c = &r->s->column[r->s->n_column];
    size_t n;
    const hid_t set = open_set(where, name);
    int result = 0;
    if (set < 0)
        return 0;
    if (set_shape(r, set, &n, &c->ncomp) && n == r->s->n) {
        char *clean = clean_copy(name, strlen(name));
        *c = (struct snapshot_column){clean, word_of(r, set, name, r->words->unit, "unit"),
                                      word_of(r, set, name, r->words->doc, "doc"), c->ncomp,
                                      read_doubles(r, set, n, c->ncomp)};
        r->s->n_column++; /* snapshot_free takes it from here */
        if (!c->name || !c->unit || !c->doc)
            result = error_memory(r->e, "a snapshot", strlen(name));
        else if (!c->value)
            result = -1;
    }
    H5Dclose(set);
    return result;
}

static int read_columns(struct reader *r)
{
    H5G_info_t info;
    if (!is_here(r->grid, "PointData"))
        return 0;
    const hid_t where = H5Gopen2(r->grid, "PointData", H5P_DEFAULT);
    if (where < 0)
        return unreadable(r);
    int result = -1;
    if (H5Gget_info(where, &info) < 0)
        unreadable(r);
    else if (info.nlinks > COLUMNS_MOST)
        damaged(r, "it has too many columns");
    else if (!(r->s->column = calloc(info.nlinks + 1, sizeof *r->s->column)))
        error_memory(r->e, "a snapshot", info.nlinks * sizeof *r->s->column);
    else
        result = 0;
    for (hsize_t i = 0; result == 0 && i < info.nlinks; i++) {
        char name[256];
        const ssize_t n = H5Lget_name_by_idx(where, ".", H5_INDEX_NAME, H5_ITER_INC, i, name,
                                             sizeof name, H5P_DEFAULT);
        if (n < 0)
            result = unreadable(r);
        else if ((size_t)n < sizeof name)
            result = read_column(r, where, name);
    }
    H5Gclose(where);
    return result;
}

/* Takes the column "array" out of the columns: its values, or NULL if there is none. */
static double *take_array_column(struct snapshot *s)
{
    for (size_t i = 0; i < s->n_column; i++) {
        struct snapshot_column *c = &s->column[i];
        if (strcmp(c->name, "array") == 0 && c->ncomp == 1) {
            double *value = c->value;
            free(c->name);
            free(c->unit);
            free(c->doc);
            memmove(c, c + 1, (s->n_column - i - 1) * sizeof *c);
            s->n_column--;
            return value;
        }
    }
    return NULL;
}

/* Who is of which array. A file that does not say has one. */
static int read_arrays(struct reader *r)
{
    struct snapshot *s = r->s;
    double *index = take_array_column(s);
    int result = 0;
    s->array = calloc(s->n + 1, sizeof *s->array);
    s->array_name = calloc(TEXTS_MOST, sizeof *s->array_name);
    if (!s->array || !s->array_name)
        result = error_memory(r->e, "a snapshot", s->n * sizeof *s->array);
    else if (index)
        s->n_array = field_texts(r, "array_names", s->array_name, TEXTS_MOST);
    for (size_t i = 0; result == 0 && index && s->n_array > 0 && i < s->n; i++) {
        if (!(index[i] >= 0 && index[i] < (double)s->n_array))
            result = damaged(r, "a particle is of an array that it does not have");
        else
            s->array[i] = (int32_t)index[i];
    }
    free(index);
    if (result == 0 && s->n_array == 0) {
        s->array_name[0] = text_format("particles");
        s->n_array = 1;
        if (!s->array_name[0])
            result = error_memory(r->e, "a snapshot", 16);
    }
    return result;
}

/* Of a file that does not say: as many as its points need. */
static int guess_dimensions(const struct snapshot *s)
{
    int dim = 1;
    for (size_t i = 1; i < s->n && dim < 3; i++)
        for (int k = dim; k < 3; k++)
            if (s->x[3 * i + (size_t)k] != s->x[k])
                dim = k + 1;
    return dim;
}

static int read_meta(struct reader *r)
{
    struct snapshot *s = r->s;
    double number = 0;
    if (!read_number(r, "TimeValue", "time", &s->time))
        read_number(r, "Time", "time", &s->time);
    if (read_number(r, "Step", "step", &number) && number >= 0 && number < 1e18)
        s->step = (uint64_t)number;
    if (read_number(r, "dimensions", "dimensions", &number) &&
        (number == 1 || number == 2 || number == 3))
        s->dim = (int)number;
    else
        s->dim = guess_dimensions(s);
    s->title = field_text(r, "title");
    s->units = field_text(r, "units");
    s->scene_text = field_text(r, "scene");
    return s->title && s->units && s->scene_text && s->x_unit ? 0
                                                              : error_memory(r->e, "a snapshot", 1);
}

int snapshot_read(struct snapshot *s, const char *path, struct error *e)
{
    struct stat status;
    *s = (struct snapshot){0};
    struct reader r = {path, h5_open(path, e), -1, 0, NULL, s, e};
    if (r.file < 0)
        return -1;
    int result = -1;
    if (stat(path, &status) == 0)
        r.file_size = (double)status.st_size;
    if (is_here(r.file, "VTKHDF"))
        r.grid = H5Gopen2(r.file, "VTKHDF", H5P_DEFAULT);
    if (r.grid < 0)
        damaged(&r, "it is not a snapshot (it has no group VTKHDF)");
    else if (!words_read(&r) && !read_points(&r) && !read_columns(&r) && !read_arrays(&r) &&
             !read_meta(&r))
        result = 0;
    if (r.grid >= 0)
        H5Gclose(r.grid);
    H5Fclose(r.file);
    words_free(r.words);
    if (result)
        snapshot_free(s);
    return result;
}

void snapshot_free(struct snapshot *s)
{
    for (size_t i = 0; i < s->n_column; i++) {
        free(s->column[i].name);
        free(s->column[i].unit);
        free(s->column[i].doc);
        free(s->column[i].value);
    }
    for (size_t i = 0; s->array_name && i < TEXTS_MOST; i++)
        free(s->array_name[i]);
    free(s->array_name);
    free(s->array);
    free(s->column);
    free(s->x);
    free(s->x_unit);
    free(s->title);
    free(s->units);
    free(s->scene_text);
    *s = (struct snapshot){0};
}

const struct snapshot_column *snapshot_find(const struct snapshot *s, const char *name)
{
    for (size_t i = 0; i < s->n_column; i++)
        if (strcmp(s->column[i].name, name) == 0)
            return &s->column[i];
    return NULL;
}
