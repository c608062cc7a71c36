/* io/csv.c -- rows on disk: see csv.h. Touches the file that it is given, nothing else. */
#include "config.h"

#include "io/csv.h"

#include "base/text.h"
#include <errno.h>
#include <math.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int cannot(struct error *e, const char *path, int error_number)
{
    return error_set(e, EXIT_RUN, "cannot write %s: %s", path, strerror(error_number));
}

/* What is there already. */
static int count(struct csv *c, struct error *e)
{
    FILE *there = fopen(c->path, "re");
    int letter;
    if (!there)
        return cannot(e, c->path, errno);
    while ((letter = getc(there)) != EOF) {
        c->good++;
        c->rows += letter == '\n';
    }
    fclose(there);
    return 0;
}

int csv_open(struct csv *c, const char *path, enum csv_mode mode, struct error *e)
{
    static const char *const how[] = {"we", "wxe", "ae"};
    *c = (struct csv){0};
    c->path = text_format("%s", path);
    if (!c->path)
        return error_memory(e, "a path", strlen(path) + 1);
    c->file = fopen(path, how[mode]);
    if (c->file)
        return mode == CSV_GO_ON ? count(c, e) : 0;
    const int error_number = errno;
    free(c->path);
    *c = (struct csv){0};
    if (mode == CSV_NEW && error_number == EEXIST)
        return error_set(e, EXIT_USAGE,
                         "%s is not of an earlier run and would be overwritten; choose another "
                         "output folder",
                         path);
    return cannot(e, path, error_number);
}

static void separate(struct csv *c)
{
    if (c->begun)
        putc(',', c->file);
    c->begun = true;
}

/* Quoted where RFC 4180 asks for it. */
void csv_name(struct csv *c, const char *name)
{
    separate(c);
    text_put_cell(c->file, name);
}

void csv_count(struct csv *c, uint64_t value)
{
    separate(c);
    fprintf(c->file, "%llu", (unsigned long long)value);
}

void csv_number(struct csv *c, double value)
{
    separate(c);
    if (isnan(value))
        fputs("nan", c->file);
    else
        fprintf(c->file, "%.17g", value);
}

void csv_fixed(struct csv *c, double value, int digits)
{
    separate(c);
    fprintf(c->file, "%.*f", digits, value);
}

void csv_end_row(struct csv *c)
{
    putc('\n', c->file);
    c->begun = false;
    c->rows++;
}

/* Takes back what stands behind the last whole row, in the file and in the buffer: nothing is tried
 * again later, and a run that goes on may write on. A device has no length; nothing is lost there. */
static int take_back(struct csv *c, int error_number, struct error *e)
{
    __fpurge(c->file);
    clearerr(c->file);
    c->begun = false;
    if (c->good >= 0 && ftruncate(fileno(c->file), c->good) == 0)
        (void)fseek(c->file, c->good, SEEK_SET);
    return cannot(e, c->path, error_number);
}

int csv_commit(struct csv *c, struct error *e)
{
    errno = 0;
    if (fflush(c->file) || ferror(c->file))
        return take_back(c, errno ? errno : EIO, e);
    c->good = ftell(c->file);
    return 0;
}

int csv_head(struct csv *c, const char *line, struct error *e)
{
    if (c->good == 0) {
        fputs(line, c->file);
        c->rows++;
        return csv_commit(c, e);
    }
    char *there = NULL;
    size_t size = 0;
    FILE *file = fopen(c->path, "re");
    const bool same = file && getline(&there, &size, file) > 0 && strcmp(there, line) == 0;
    if (file)
        fclose(file);
    free(there);
    return same ? 0
                : error_set(e, EXIT_USAGE,
                            "%s has other columns than the scene asks for: choose another output "
                            "folder",
                            c->path);
}

int csv_sync(struct csv *c, struct error *e)
{
    if (c->file && fsync(fileno(c->file)) && errno != EINVAL && errno != EROFS)
        return cannot(e, c->path, errno);
    return 0;
}

int csv_close(struct csv *c, struct error *e)
{
    int result = csv_sync(c, e);
    if (c->file) {
        if (fclose(c->file) && result == 0)
            result = cannot(e, c->path, errno);
    }
    free(c->path);
    *c = (struct csv){0};
    return result;
}

/* -- Read back --------------------------------------------------------------------------------- */

int csv_cut_from(const char *path, uint64_t step, struct error *e)
{
    FILE *file = fopen(path, "r+e");
    if (!file)
        return errno == ENOENT ? 0 : cannot(e, path, errno);
    char *line = NULL;
    size_t size = 0;
    long keep = 0;
    ssize_t n;
    bool head = true;
    while ((n = getline(&line, &size, file)) > 0 && line[n - 1] == '\n') {
        if (!head && strtoull(line, NULL, 10) >= step)
            break;
        head = false;
        keep += n;
    }
    free(line);
    int result =
        (n < 0 && !feof(file)) || ftruncate(fileno(file), keep) ? cannot(e, path, errno) : 0;
    fclose(file);
    return result;
}

/* Index of a column in a line of names that need no quotes, or -1. */
static int column_of(const char *head, const char *name)
{
    const size_t n = strlen(name);
    for (int k = 0;; k++) {
        const size_t cell = strcspn(head, ",\n");
        if (cell == n && strncmp(head, name, n) == 0)
            return k;
        if (head[cell] != ',')
            return -1;
        head += cell + 1;
    }
}

static double cell_at(const char *row, int k)
{
    for (; k > 0 && row; k--) {
        row = strchr(row, ',');
        row = row ? row + 1 : NULL;
    }
    return row ? strtod(row, NULL) : (double)NAN;
}

int csv_read_two(const char *path, const char *const name[2], double *value[2], size_t *n,
                 struct error *e)
{
    FILE *file = fopen(path, "re");
    char *line = NULL;
    size_t size = 0, room = 0;
    int at[2] = {-1, -1}, status = 0;
    value[0] = value[1] = NULL;
    *n = 0;
    if (!file)
        return error_set(e, EXIT_RUN, "cannot read %s: %s", path, strerror(errno));
    if (getline(&line, &size, file) > 0)
        for (int k = 0; k < 2; k++)
            at[k] = column_of(line, name[k]);
    if (at[0] < 0 || at[1] < 0)
        status = error_set(e, EXIT_RUN, "%s has no column \"%s\"", path, name[at[0] >= 0]);
    while (!status && getline(&line, &size, file) > 0) {
        for (int k = 0; k < 2 && *n == room; k++) {
            double *more = realloc(value[k], (2 * room + 64) * sizeof *more);
            if (!more)
                status = error_memory(e, path, (2 * room + 64) * sizeof *more);
            else
                value[k] = more;
        }
        room = *n == room ? 2 * room + 64 : room;
        for (int k = 0; k < 2 && !status; k++)
            value[k][*n] = cell_at(line, at[k]);
        *n += !status;
    }
    free(line);
    fclose(file);
    if (status) {
        free(value[0]);
        free(value[1]);
        value[0] = value[1] = NULL;
    }
    return status;
}
