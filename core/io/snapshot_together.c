/* snapshot_together.c -- what particles have goes into a snapshot that is made for it: each process writes its own rows
 * of every data set, all at the same time.
 *
 * The file is opened and closed by all together, with an agreement before each step: nobody waits for one that has
 * failed. The rows are written by each for itself: Open MPI's collective writes (4.1) return success when the disk has
 * refused what they wrote. */
#include "config.h"

#include "io/snapshot_private.h"

#include "domain/ranks.h"
#include "io/output.h"
#include <stdlib.h>
#include <string.h>

bool snapshot_can_fill(void)
{
    return h5_is_parallel();
}

#ifdef H5_HAVE_PARALLEL

/* An open file and its data sets. */
struct together {
    struct writer *w;
    hid_t file, transfer;
    hid_t *set;          /* [n_set] */
    size_t n_set, first; /* this process's first row */
};

static int failed(const struct together *t)
{
    return h5_error(t->w->e, EXIT_RUN, "write", t->w->file.shown);
}

static int open_sets(struct together *t)
{
    for (size_t k = 0; k < t->n_set; k++) {
        char path[512];
        snprintf(path, sizeof path, "VTKHDF/%s", snapshot_set(t->w, k).name);
        t->set[k] = H5Dopen2(t->file, path, H5P_DEFAULT);
        if (t->set[k] < 0)
            return failed(t);
    }
    t->transfer = H5Pcreate(H5P_DATASET_XFER);
    return t->transfer < 0 || H5Pset_dxpl_mpio(t->transfer, H5FD_MPIO_INDEPENDENT) < 0 ? failed(t)
                                                                                       : 0;
}

/* n rows of a data set, this process's from `row` on. */
static int write_slab(const struct together *t, size_t k, size_t row, size_t n)
{
    const struct out_set what = snapshot_set(t->w, k);
    const hsize_t start[2] = {t->first + row, 0}, extent[2] = {n, what.ncomp};
    const hid_t memory = H5Screate_simple(what.ncomp > 1 ? 2 : 1, extent, NULL);
    const hid_t space = H5Dget_space(t->set[k]);
    int status = 0;
    snapshot_rows(t->w, &what, row, n);
    if (memory < 0 || space < 0 ||
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL) < 0 ||
        H5Dwrite(t->set[k], what.type, memory, space, t->transfer, t->w->slab) < 0)
        status = failed(t);
    if (space >= 0)
        H5Sclose(space);
    if (memory >= 0)
        H5Sclose(memory);
    return status;
}

static int write_all(const struct together *t)
{
    const size_t mine = t->w->parts.rows[t->w->parts.mine];
    for (size_t k = 0; k < t->n_set; k++)
        for (size_t row = 0; row < mine; row += SNAPSHOT_SLAB) {
            const size_t left = mine - row;
            if (write_slab(t, k, row, left < SNAPSHOT_SLAB ? left : SNAPSHOT_SLAB))
                return -1;
        }
    return 0;
}

static int fill(struct writer *w, const char *path)
{
    struct together t = {.w = w, .file = -1, .transfer = -1};
    t.n_set = w->n_column + 1;
    t.set = malloc(t.n_set * sizeof *t.set);
    for (size_t k = 0; t.set && k < t.n_set; k++)
        t.set[k] = -1;
    for (size_t k = 0; k < w->parts.mine; k++)
        t.first += w->parts.rows[k];
    int status =
        ranks_agree(t.set ? 0 : error_memory(w->e, "a snapshot", t.n_set * sizeof *t.set), w->e);
    if (!status) {
        t.file = h5_join(path, w->file.shown, w->e);
        status = ranks_agree(t.file < 0 ? -1 : 0, w->e);
    }
    if (!status)
        status = ranks_agree(open_sets(&t), w->e);
    if (!status)
        status = write_all(&t);
    for (size_t k = 0; t.set && k < t.n_set; k++)
        if (t.set[k] >= 0)
            H5Dclose(t.set[k]);
    if (t.transfer >= 0)
        H5Pclose(t.transfer);
    if (t.file >= 0 && H5Fclose(t.file) < 0 && !status)
        status = failed(&t);
    free(t.set);
    return ranks_agree(status, w->e);
}

int snapshot_fill(const char *path, const struct particles *arrays, size_t n,
                  const struct snapshot_parts *parts, struct error *e)
{
    struct writer w = {.group = -1, .arrays = arrays, .n_array = n, .parts = *parts, .e = e};
    char *shown = output_shown(path);
    w.file.shown = shown;
    int status = shown ? snapshot_columns(&w) : error_memory(e, "a path", strlen(path));
    status = ranks_agree(status, e);
    if (!status)
        status = fill(&w, path);
    snapshot_columns_free(&w);
    free(shown);
    return status;
}

#else

int snapshot_fill(const char *path, const struct particles *arrays, size_t n,
                  const struct snapshot_parts *parts, struct error *e)
{
    (void)arrays;
    (void)n;
    (void)parts;
    return error_set(e, EXIT_RUN, "cannot write %s: this HDF5 is for one process", path);
}

#endif
