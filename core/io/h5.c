/* h5.c -- files of HDF5: a driver that keeps the first error of a write, and errors as sentences.
 * Knows nothing of what is in the files. */
#include "config.h"

#include "io/h5.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OFFSET_MAX ((haddr_t)INT64_MAX)

/* -- The driver -------------------------------------------------------------------------------- */

struct disk_file {
    H5FD_t base; /* HDF5's part, first */
    struct h5_disk *disk;
    haddr_t eoa, eof;
};

static H5FD_t *disk_open(const char *name, unsigned flags, hid_t fapl, haddr_t maxaddr)
{
    /* The descriptor is open already: its errors are better told by whoever opened it. */
    (void)name;
    (void)flags;
    (void)maxaddr;
    struct h5_disk *const *info = H5Pget_driver_info(fapl);
    struct disk_file *f = calloc(1, sizeof *f);
    if (!f || !info) {
        free(f);
        return NULL;
    }
    f->disk = *info;
    struct stat s;
    if (fstat(f->disk->fd, &s) == 0 && S_ISREG(s.st_mode))
        f->eof = (haddr_t)s.st_size;
    return &f->base;
}

static herr_t disk_close(H5FD_t *base)
{
    free(base);
    return 0;
}

static herr_t disk_query(const H5FD_t *base, unsigned long *flags)
{
    (void)base;
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
}

static haddr_t disk_get_eoa(const H5FD_t *base, H5FD_mem_t type)
{
    (void)type;
    return ((const struct disk_file *)base)->eoa;
}

static herr_t disk_set_eoa(H5FD_t *base, H5FD_mem_t type, haddr_t address)
{
    (void)type;
    ((struct disk_file *)base)->eoa = address;
    return 0;
}

static haddr_t disk_get_eof(const H5FD_t *base, H5FD_mem_t type)
{
    (void)type;
    return ((const struct disk_file *)base)->eof;
}

static herr_t disk_read(H5FD_t *base, H5FD_mem_t type, hid_t dxpl, haddr_t address, size_t size,
                        void *buffer)
{
    (void)type;
    (void)dxpl;
    struct disk_file *f = (struct disk_file *)base;
    char *at = buffer;
    while (size > 0 && !f->disk->error) {
        const ssize_t done = pread(f->disk->fd, at, size, (off_t)address);
        if (done < 0 && errno == EINTR)
            continue;
        if (done < 0)
            f->disk->error = errno;
        if (done <= 0)
            break;
        at += done;
        size -= (size_t)done;
        address += (haddr_t)done;
    }
    memset(at, 0, size);
    return 0;
}

static herr_t disk_write(H5FD_t *base, H5FD_mem_t type, hid_t dxpl, haddr_t address, size_t size,
                         const void *buffer)
{
    (void)type;
    (void)dxpl;
    struct disk_file *f = (struct disk_file *)base;
    const char *at = buffer;
    if (address + size > f->eof)
        f->eof = address + size;
    while (size > 0 && !f->disk->error) {
        const ssize_t done = pwrite(f->disk->fd, at, size, (off_t)address);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0) {
            f->disk->error = done < 0 ? errno : ENOSPC;
            break;
        }
        at += done;
        size -= (size_t)done;
        address += (haddr_t)done;
    }
    return 0;
}

static herr_t disk_truncate(H5FD_t *base, hid_t dxpl, hbool_t closing)
{
    (void)dxpl;
    (void)closing;
    struct disk_file *f = (struct disk_file *)base;
    if (!f->disk->error && f->eof != f->eoa && ftruncate(f->disk->fd, (off_t)f->eoa))
        f->disk->error = errno;
    f->eof = f->eoa;
    return 0;
}

static const H5FD_class_t disk_driver = {
#ifdef H5FD_CLASS_VERSION /* 1.14 and later */
    .version = H5FD_CLASS_VERSION,
    .value = (H5FD_class_value_t)511,
#endif
    .name = "sph",
    .maxaddr = OFFSET_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(struct h5_disk *),
    .open = disk_open,
    .close = disk_close,
    .query = disk_query,
    .get_eoa = disk_get_eoa,
    .set_eoa = disk_set_eoa,
    .get_eof = disk_get_eof,
    .read = disk_read,
    .write = disk_write,
    .truncate = disk_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

/* -- Sentences --------------------------------------------------------------------------------- */

struct reason {
    int error;      /* an errno that a driver of HDF5 met */
    char text[160]; /* of the innermost complaint */
};

static herr_t look_at_reason(unsigned n, const H5E_error2_t *complaint, void *data)
{
    struct reason *r = data;
    const char *text = complaint->desc ? complaint->desc : "";
    const char *number = strstr(text, "errno = ");
    if (number && !r->error)
        r->error = (int)strtol(number + strlen("errno = "), NULL, 10);
    if (n == 0)
        snprintf(r->text, sizeof r->text, "%s", text);
    return 0;
}

int h5_error(struct error *e, enum exit_code code, const char *verb, const char *path)
{
    struct reason r = {0};
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look_at_reason, &r);
    const char *why = r.error ? strerror(r.error) : r.text[0] ? r.text : "HDF5 gives no reason";
    return error_set(e, code, "cannot %s %s: %s", verb, path, why);
}

/* -- Files ------------------------------------------------------------------------------------- */

static void quieten(void)
{
    signal(SIGXFSZ, SIG_IGN); /* an error will do */
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

/* Formats of 1.8 to 1.8: every reader since then knows them, and metadata carry checksums. */
static hid_t access_list(const struct h5_out *out)
{
    const hid_t fapl = H5Pcreate(H5P_FILE_ACCESS);
    const struct h5_disk *disk = &out->disk;
    if (fapl >= 0 && H5Pset_driver(fapl, out->driver, &disk) >= 0 &&
        H5Pset_libver_bounds(fapl, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0)
        return fapl;
    if (fapl >= 0)
        H5Pclose(fapl);
    return -1;
}

/* fd: of a new file, or of one that is there. */
static int begin(struct h5_out *out, int fd, bool new, struct error *e)
{
    quieten();
    out->disk.fd = fd;
    if (fd < 0)
        return error_set(e, EXIT_RUN, "cannot write %s: %s", out->shown, strerror(errno));
    out->driver = H5FDregister(&disk_driver);
    const hid_t fapl = out->driver < 0 ? -1 : access_list(out);
    if (fapl >= 0)
        out->file = new ? H5Fcreate(out->path, H5F_ACC_TRUNC, H5P_DEFAULT, fapl)
                        : H5Fopen(out->path, H5F_ACC_RDWR, fapl);
    if (out->file < 0)
        h5_error(e, EXIT_RUN, "write", out->shown);
    if (fapl >= 0)
        H5Pclose(fapl);
    return out->file < 0 ? h5_close(out, 1, e) : 0;
}

int h5_create(struct h5_out *out, const char *path, const char *shown, struct error *e)
{
    *out = (struct h5_out){path, shown, -1, -1, {-1, 0}};
    return begin(out, open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), true, e);
}

int h5_append(struct h5_out *out, const char *path, const char *shown, struct error *e)
{
    *out = (struct h5_out){path, shown, -1, -1, {-1, 0}};
    return begin(out, open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW), false, e);
}

int h5_close(struct h5_out *out, int failed, struct error *e)
{
    if (out->file >= 0 && H5Fclose(out->file) < 0 && !failed)
        failed = h5_error(e, EXIT_RUN, "write", out->shown);
    if (out->driver >= 0)
        H5FDunregister(out->driver);
    if (close(out->disk.fd) && !out->disk.error)
        out->disk.error = errno;
    if (out->disk.error)
        failed =
            error_set(e, EXIT_RUN, "cannot write %s: %s", out->shown, strerror(out->disk.error));
    /* A device or a pipe in the file's place is not ours to remove. */
    struct stat s;
    if (failed && lstat(out->path, &s) == 0 && S_ISREG(s.st_mode))
        unlink(out->path);
    out->file = out->driver = -1;
    out->disk.fd = -1;
    return failed ? -1 : 0;
}

int h5_reserve(const char *path, const char *shown, struct error *e)
{
    struct stat s;
    const int fd = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    int failed = fd < 0 || fstat(fd, &s) ? errno : 0;
    if (!failed && s.st_size > 0)
        failed = posix_fallocate(fd, 0, s.st_size);
    if (fd >= 0 && close(fd) && !failed)
        failed = errno;
    if (!failed)
        return 0;
    unlink(path);
    return error_set(e, EXIT_RUN, "cannot write %s: %s", shown, strerror(failed));
}

#if SPH_HAVE_MPI && defined(H5_HAVE_PARALLEL)

bool h5_is_parallel(void)
{
    return true;
}

hid_t h5_join(const char *path, const char *shown, struct error *e)
{
    hid_t file = -1;
    quieten();
    const hid_t fapl = H5Pcreate(H5P_FILE_ACCESS);
    if (fapl >= 0 && H5Pset_fapl_mpio(fapl, MPI_COMM_WORLD, MPI_INFO_NULL) >= 0 &&
        H5Pset_libver_bounds(fapl, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0)
        file = H5Fopen(path, H5F_ACC_RDWR, fapl);
    if (file < 0)
        h5_error(e, EXIT_RUN, "write", shown);
    if (fapl >= 0)
        H5Pclose(fapl);
    return file;
}

#else

bool h5_is_parallel(void)
{
    return false;
}

hid_t h5_join(const char *path, const char *shown, struct error *e)
{
    (void)path;
    return error_set(e, EXIT_RUN, "cannot write %s: this HDF5 is for one process", shown);
}

#endif

hid_t h5_open(const char *path, struct error *e)
{
    quieten();
    /* The system's words for a file that cannot be opened are better than HDF5's. */
    struct stat s;
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 || fstat(fd, &s)) {
        error_set(e, EXIT_USAGE, "cannot read %s: %s", path, strerror(errno));
        if (fd >= 0)
            close(fd);
        return -1;
    }
    close(fd);
    if (!S_ISREG(s.st_mode))
        return error_set(e, EXIT_USAGE, "cannot read %s: it is not a file", path);
    const htri_t known = H5Fis_hdf5(path);
    if (known == 0)
        return error_set(e, EXIT_USAGE, "cannot read %s: it is not an HDF5 file", path);
    hid_t file = -1;
    const hid_t fapl = H5Pcreate(H5P_FILE_ACCESS);
    if (known > 0 && fapl >= 0) {
        H5Pset_fclose_degree(fapl, H5F_CLOSE_STRONG);
        file = H5Fopen(path, H5F_ACC_RDONLY, fapl);
    }
    if (file < 0)
        h5_error(e, EXIT_USAGE, "read", path);
    if (fapl >= 0)
        H5Pclose(fapl);
    return file;
}
