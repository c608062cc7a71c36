/* checkpoint.c -- see checkpoint.h. Small blocks stand in the headers of their data sets, which HDF5 guards by
 * checksums; large ones are cut in pieces with one each. */
#include "config.h"

#include "io/checkpoint.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define WHAT "sph checkpoint"
#define ORDER 0x01020304u           /* of the bytes of what is written as it is */
#define COMPACT_MOST 4096           /* bytes */
#define PIECE ((hsize_t)128 * 1024) /* elements */

static hid_t type_of(enum store_type type)
{
    switch (type) {
    case STORE_U8:
        return H5T_NATIVE_UINT8;
    case STORE_U16:
        return H5T_NATIVE_UINT16;
    case STORE_U32:
        return H5T_NATIVE_UINT32;
    case STORE_U64:
        return H5T_NATIVE_UINT64;
    case STORE_I32:
        return H5T_NATIVE_INT32;
    case STORE_I64:
        return H5T_NATIVE_INT64;
    case STORE_F32:
        return H5T_NATIVE_FLOAT;
    case STORE_F64:
        break;
    }
    return H5T_NATIVE_DOUBLE;
}

/* -- Writing ----------------------------------------------------------------------------------- */

static hid_t layout_for(hsize_t n, size_t size)
{
    const hsize_t piece = n < PIECE ? n : PIECE;
    const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
    const bool compact = n * size <= COMPACT_MOST;
    if (plist >= 0 &&
        (compact ? H5Pset_layout(plist, H5D_COMPACT) >= 0
                 : H5Pset_chunk(plist, 1, &piece) >= 0 && H5Pset_fletcher32(plist) >= 0) &&
        H5Pset_obj_track_times(plist, 0) >= 0)
        return plist;
    if (plist >= 0)
        H5Pclose(plist);
    return -1;
}

static int block_write(struct store *s, const char *path, enum store_type type, void *data,
                       size_t n, struct error *e)
{
    const struct checkpoint *c = (const struct checkpoint *)s;
    const hsize_t extent = n;
    const hid_t space = n > 0 ? H5Screate_simple(1, &extent, NULL) : H5Screate(H5S_NULL);
    const hid_t layout = layout_for(extent, store_size(type));
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    hid_t set = -1;
    if (space >= 0 && layout >= 0 && links >= 0 && H5Pset_create_intermediate_group(links, 1) >= 0)
        set = H5Dcreate2(c->out.file, path, type_of(type), space, links, layout, H5P_DEFAULT);
    int status = set < 0 ? -1 : 0;
    if (!status && n > 0 && H5Dwrite(set, type_of(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
        status = -1;
    if (status)
        h5_error(e, EXIT_RUN, "write", c->out.shown);
    if (set >= 0)
        H5Dclose(set);
    if (links >= 0)
        H5Pclose(links);
    if (layout >= 0)
        H5Pclose(layout);
    if (space >= 0)
        H5Sclose(space);
    return status;
}

static size_t count_nothing(struct store *s, const char *path)
{
    (void)s;
    (void)path;
    return SIZE_MAX;
}

static int begin(struct checkpoint *c, const char *path, bool new, struct error *e)
{
    *c = (struct checkpoint){.file = -1};
    c->shown = output_shown(path);
    if (!c->shown)
        return error_memory(e, "a path", strlen(path));
    c->store = (struct store){
        .block = block_write, .count = count_nothing, .shown = c->shown, .group = ""};
    if ((new ? h5_create : h5_append)(&c->out, path, c->shown, e) == 0)
        return 0;
    free(c->shown);
    c->shown = NULL;
    return -1;
}

int checkpoint_append(struct checkpoint *c, const char *path, struct error *e)
{
    return begin(c, path, false, e);
}

int checkpoint_create(struct checkpoint *c, const char *path, struct error *e)
{
    if (begin(c, path, true, e))
        return -1;
    char what[] = WHAT, *text = what;
    uint64_t format = CHECKPOINT_FORMAT;
    uint32_t order = ORDER;
    if (store_block(&c->store, "byte_order", STORE_U8, &order, sizeof order, e) ||
        store_text(&c->store, "what", &text, e) || store_u64(&c->store, "format", &format, e)) {
        checkpoint_finish(c, -1, e);
        return -1;
    }
    return 0;
}

int checkpoint_finish(struct checkpoint *c, int failed, struct error *e)
{
    const int status = h5_close(&c->out, failed, e);
    free(c->shown);
    c->shown = NULL;
    return status;
}

/* -- Reading ----------------------------------------------------------------------------------- */

/* The elements of an open data set. */
static size_t extent_of(hid_t set)
{
    const hid_t space = H5Dget_space(set);
    const hssize_t n = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    const bool none = space >= 0 && H5Sget_simple_extent_type(space) == H5S_NULL;
    if (space >= 0)
        H5Sclose(space);
    return none ? 0 : n < 0 ? SIZE_MAX : (size_t)n;
}

static bool is_there(hid_t file, const char *path)
{
    char part[256];
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(part, sizeof part, "%.*s", (int)(slash - path), path);
        if (H5Lexists(file, part, H5P_DEFAULT) <= 0)
            return false;
    }
    return H5Lexists(file, path, H5P_DEFAULT) > 0;
}

static size_t count_read(struct store *s, const char *path)
{
    const struct checkpoint *c = (const struct checkpoint *)s;
    if (!is_there(c->file, path))
        return SIZE_MAX;
    const hid_t set = H5Dopen2(c->file, path, H5P_DEFAULT);
    const size_t n = set < 0 ? SIZE_MAX : extent_of(set);
    if (set >= 0)
        H5Dclose(set);
    /* Nothing is packed: no block is larger than its file. */
    return n != SIZE_MAX && (double)n > c->file_size ? SIZE_MAX : n;
}

/* Elements [first, first + n) of an open data set. */
static int read_piece(hid_t set, hid_t type, hsize_t first, hsize_t n, void *data)
{
    const hid_t space = H5Dget_space(set), memory = H5Screate_simple(1, &n, NULL);
    const bool good = space >= 0 && memory >= 0 &&
                      H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, NULL, &n, NULL) >= 0 &&
                      H5Dread(set, type, memory, space, H5P_DEFAULT, data) >= 0;
    if (memory >= 0)
        H5Sclose(memory);
    if (space >= 0)
        H5Sclose(space);
    return good ? 0 : -1;
}

static int piece_read(struct store *s, const char *path, enum store_type type, void *data,
                      size_t first, size_t n, struct error *e)
{
    const struct checkpoint *c = (const struct checkpoint *)s;
    const size_t found = count_read(s, path);
    if (found == SIZE_MAX)
        return store_broken(s, e, "%s is missing", path);
    if (first > found || n > found - first)
        return store_broken(s, e, "%s has %zu elements, not %zu", path, found, first + n);
    if (n == 0)
        return 0;
    const hid_t set = H5Dopen2(c->file, path, H5P_DEFAULT);
    const int status = set < 0 ? -1 : read_piece(set, type_of(type), first, n, data);
    if (set >= 0)
        H5Dclose(set);
    return status ? store_broken(s, e, "%s cannot be read", path) : 0;
}

static int block_read(struct store *s, const char *path, enum store_type type, void *data, size_t n,
                      struct error *e)
{
    const struct checkpoint *c = (const struct checkpoint *)s;
    const size_t found = count_read(s, path);
    if (found == SIZE_MAX)
        return store_broken(s, e, "%s is missing", path);
    if (found != n)
        return store_broken(s, e, "%s has %zu elements, not %zu", path, found, n);
    const hid_t set = H5Dopen2(c->file, path, H5P_DEFAULT);
    int status = set < 0 ? -1 : 0;
    if (!status && n > 0 && H5Dread(set, type_of(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
        status = -1;
    if (set >= 0)
        H5Dclose(set);
    return status ? store_broken(s, e, "%s cannot be read", path) : 0;
}

/* Reads all of a data set and keeps nothing: HDF5 compares the checksums. */
static int read_through(hid_t set)
{
    const hid_t type = H5Dget_type(set);
    const size_t n = extent_of(set), size = type < 0 ? 0 : H5Tget_size(type);
    const hsize_t piece = n < PIECE ? n : PIECE;
    int status = n == SIZE_MAX || size == 0 || size > 8 ? -1 : 0;
    char *room = status ? NULL : malloc(piece * size + 1);
    for (hsize_t first = 0; room && !status && first < n; first += piece)
        status = read_piece(set, type, first, n - first < piece ? n - first : piece, room);
    if (type >= 0)
        H5Tclose(type);
    status = room ? status : -1;
    free(room);
    return status;
}

struct visit {
    const struct checkpoint *c;
    struct error *e;
};

static herr_t visit_link(hid_t group, const char *name, const H5L_info_t *info, void *data)
{
    const struct visit *v = data;
    if (info->type != H5L_TYPE_HARD)
        return store_broken(&v->c->store, v->e, "%s is a link", name);
    const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    const H5I_type_t type = object < 0 ? H5I_BADID : H5Iget_type(object);
    int status = type == H5I_GROUP ? 0 : type == H5I_DATASET ? read_through(object) : -1;
    if (object >= 0)
        H5Oclose(object);
    return status ? store_broken(&v->c->store, v->e, "%s cannot be read", name) : 0;
}

/* It is ours, and whole; known: that has been looked at. */
static int check(struct checkpoint *c, const char *path, bool known, struct error *e)
{
    char *what = NULL;
    uint64_t format = 0;
    uint32_t order = 0;
    struct error ignored = {0};
    if (store_text(&c->store, "what", &what, &ignored) || !what || strcmp(what, WHAT) != 0) {
        free(what);
        return error_set(e, EXIT_USAGE, "%s is no checkpoint of sph", path);
    }
    free(what);
    if (store_u64(&c->store, "format", &format, e))
        return -1;
    if (format != CHECKPOINT_FORMAT)
        return error_set(e, EXIT_USAGE,
                         "%s is a checkpoint of format %llu; this version reads format %d", path,
                         (unsigned long long)format, CHECKPOINT_FORMAT);
    if (store_block(&c->store, "byte_order", STORE_U8, &order, sizeof order, e))
        return -1;
    if (order != ORDER)
        return error_set(e, EXIT_USAGE, "%s was made on a machine with another order of bytes",
                         path);
    struct visit v = {c, e};
    if (known)
        return 0;
    if (e)
        e->text[0] = '\0';
    if (H5Lvisit(c->file, H5_INDEX_NAME, H5_ITER_NATIVE, visit_link, &v) >= 0)
        return 0;
    return e && e->text[0] ? -1 : store_broken(&c->store, e, "its list of blocks cannot be read");
}

static int open_file(struct checkpoint *c, const char *path, bool known, struct error *e)
{
    struct stat s;
    *c = (struct checkpoint){.file = -1, .shown = strdup(path)};
    if (!c->shown)
        return error_memory(e, "a path", strlen(path));
    c->store = (struct store){true, block_read, count_read, c->shown, "", piece_read};
    c->file = h5_open(path, e);
    if (c->file >= 0 && stat(path, &s) == 0) {
        c->file_size = (double)s.st_size;
        if (check(c, path, known, e) == 0)
            return 0;
    }
    checkpoint_close(c);
    return -1;
}

int checkpoint_open(struct checkpoint *c, const char *path, struct error *e)
{
    return open_file(c, path, false, e);
}

int checkpoint_open_known(struct checkpoint *c, const char *path, struct error *e)
{
    return open_file(c, path, true, e);
}

void checkpoint_close(struct checkpoint *c)
{
    if (c->file >= 0)
        H5Fclose(c->file);
    free(c->shown);
    c->file = -1;
    c->shown = NULL;
}

/* -- A folder of them -------------------------------------------------------------------------- */

static int newest_first(const void *a, const void *b)
{
    const long long x = *(const long long *)a, y = *(const long long *)b;
    return x < y ? 1 : x > y ? -1 : 0;
}

long checkpoint_list(const char *dir, long long **step, struct error *e)
{
    long n = 0;
    size_t capacity = 0;
    *step = NULL;
    DIR *folder = opendir(dir);
    if (!folder)
        return error_set(e, EXIT_USAGE, "cannot read the folder %s: %s", dir, strerror(errno));
    for (const struct dirent *entry; (entry = readdir(folder));) {
        const long long found = output_checkpoint_step(entry->d_name);
        if (found < 0)
            continue;
        if ((size_t)n == capacity) {
            capacity = 2 * capacity + 16;
            long long *grown = realloc(*step, capacity * sizeof *grown);
            if (!grown) {
                free(*step);
                *step = NULL;
                closedir(folder);
                return error_memory(e, "a folder", capacity * sizeof *grown);
            }
            *step = grown;
        }
        (*step)[n++] = found;
    }
    closedir(folder);
    if (n > 1)
        qsort(*step, (size_t)n, sizeof **step, newest_first);
    return n;
}

void checkpoint_prune(const struct output *o, uint64_t keep)
{
    long long *step;
    const long n = checkpoint_list(o->dir, &step, NULL);
    for (long k = 0; k < n; k++) {
        char name[64];
        output_checkpoint_name(name, sizeof name, (unsigned long long)step[k]);
        char *path = (uint64_t)k < keep ? NULL : output_path(o, name);
        if (path)
            unlink(path); /* what cannot be removed is in nobody's way */
        free(path);
    }
    free(step);
}
