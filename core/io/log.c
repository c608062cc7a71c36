/* log.c -- log.csv, a row at a time, and the line that a terminal shows meanwhile. */
#include "config.h"

#include "io/log.h"

#include "base/text.h"
#include <errno.h>
#include <math.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* -- log.csv ----------------------------------------------------------------------------------- */

static int open_as(struct log *l, const char *path, int dim, const char *mode, struct error *e)
{
    *l = (struct log){.dim = dim};
    l->path = text_format("%s", path);
    if (!l->path)
        return error_memory(e, "a path", strlen(path) + 1);
    l->file = fopen(path, mode);
    if (l->file)
        return 0;
    error_set(e, EXIT_RUN, "cannot write %s: %s", path, strerror(errno));
    free(l->path);
    *l = (struct log){0};
    return -1;
}

int log_open(struct log *l, const char *path, int dim, struct error *e)
{
    return open_as(l, path, dim, "we", e);
}

int log_append(struct log *l, const char *path, int dim, struct error *e)
{
    if (open_as(l, path, dim, "ae", e))
        return -1;
    if (fseek(l->file, 0, SEEK_END) == 0)
        l->good = ftell(l->file);
    l->header_done = l->good > 0;
    return 0;
}

/* 17 digits: what is read back is what was. */
static void put_number(FILE *f, double value)
{
    fprintf(f, ",%.17g", value);
}

static const char axis[] = "xyz";

/* Angular momentum has no component in 1D, one in 2D, three in 3D. */
static int angular_first(int dim)
{
    return dim == 3 ? 0 : dim == 2 ? 2 : 3;
}

static void put_header(const struct log *l, const struct log_row *row)
{
    fputs(OUTPUT_LOG_MARK "kinetic,internal,potential", l->file);
    for (int k = 0; k < l->dim; k++)
        fprintf(l->file, ",momentum_%c", axis[k]);
    for (int k = angular_first(l->dim); k < 3; k++)
        fprintf(l->file, ",angular_%c", axis[k]);
    fputs(",mass", l->file);
    for (uint64_t i = 0; i < row->n_extra; i++) {
        putc(',', l->file);
        text_put_cell(l->file, row->extra_name[i]);
    }
    fputs(",wall_s\n", l->file);
}

static void put_row(const struct log *l, const struct log_row *row)
{
    fprintf(l->file, "%llu", (unsigned long long)row->step);
    put_number(l->file, row->time);
    put_number(l->file, row->dt);
    put_number(l->file, row->kinetic);
    put_number(l->file, row->internal);
    put_number(l->file, row->potential);
    for (int k = 0; k < l->dim; k++)
        put_number(l->file, row->momentum[k]);
    for (int k = angular_first(l->dim); k < 3; k++)
        put_number(l->file, row->angular[k]);
    put_number(l->file, row->mass);
    for (uint64_t i = 0; i < row->n_extra; i++)
        put_number(l->file, row->extra[i]);
    fprintf(l->file, ",%.3f\n", row->wall);
}

/* Takes back what stands behind the last whole row, in the file and in the buffer: nothing is tried
 * again later, and a run that goes on may log on. A device has no length; nothing is lost there. */
static int take_back(struct log *l, int error_number, struct error *e)
{
    __fpurge(l->file);
    clearerr(l->file);
    if (l->good >= 0 && ftruncate(fileno(l->file), l->good) == 0)
        (void)fseek(l->file, l->good, SEEK_SET);
    return error_set(e, EXIT_RUN, "cannot write %s: %s", l->path, strerror(error_number));
}

int log_write(struct log *l, const struct log_row *row, struct error *e)
{
    errno = 0;
    if (!l->header_done)
        put_header(l, row);
    put_row(l, row);
    if (fflush(l->file) || ferror(l->file))
        return take_back(l, errno ? errno : EIO, e);
    l->header_done = true;
    l->good = ftell(l->file);
    return 0;
}

int log_sync(struct log *l, struct error *e)
{
    if (l->file && fsync(fileno(l->file)) && errno != EINVAL && errno != EROFS)
        return error_set(e, EXIT_RUN, "cannot write %s: %s", l->path, strerror(errno));
    return 0;
}

/* All of a file, in fresh memory; *text NULL: there is none. */
static int read_all(const char *path, char **text, size_t *n, struct error *e)
{
    *text = NULL;
    *n = 0;
    FILE *f = fopen(path, "re");
    if (!f)
        return errno == ENOENT
                   ? 0
                   : error_set(e, EXIT_USAGE, "cannot read %s: %s", path, strerror(errno));
    for (size_t room = 65536;; room *= 2) {
        char *grown = realloc(*text, room);
        if (!grown) {
            error_memory(e, path, room);
            break;
        }
        *text = grown;
        *n += fread(*text + *n, 1, room - *n, f);
        if (*n < room && !ferror(f)) {
            fclose(f);
            return 0;
        }
        if (ferror(f)) {
            error_set(e, EXIT_USAGE, "cannot read %s: %s", path, strerror(errno));
            break;
        }
    }
    fclose(f);
    free(*text);
    *text = NULL;
    return -1;
}

int log_cut(const struct output *o, const char *name, uint64_t step, struct error *e)
{
    char *text, *path = output_path(o, name);
    size_t n, end = 0;
    if (!path)
        return error_memory(e, "a path", strlen(name));
    int status = read_all(path, &text, &n, e);
    while (text && end < n) {
        const char *row = text + end, *stop = memchr(row, '\n', n - end);
        /* The header's first cell is no number. */
        if (!stop || (end > 0 && strtoull(row, NULL, 10) >= step))
            break;
        end += (size_t)(stop - row) + 1;
    }
    if (!status && text && end < n)
        status = output_write(o, name, text, end, e);
    free(text);
    free(path);
    return status;
}

int log_close(struct log *l, struct error *e)
{
    int result = 0;
    if (l->file) {
        if (fsync(fileno(l->file)) && errno != EINVAL && errno != EROFS)
            result = error_set(e, EXIT_RUN, "cannot write %s: %s", l->path, strerror(errno));
        if (fclose(l->file) && result == 0)
            result = error_set(e, EXIT_RUN, "cannot write %s: %s", l->path, strerror(errno));
    }
    free(l->path);
    *l = (struct log){0};
    return result;
}

/* -- Progress ---------------------------------------------------------------------------------- */

#define PROGRESS_INTERVAL 0.1 /* [s] */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_start(struct progress *p, bool wanted, double begin, double end)
{
    const char *terminal = getenv("TERM");
    const bool able = isatty(STDERR_FILENO) && !(terminal && strcmp(terminal, "dumb") == 0);
    *p = (struct progress){wanted && able, begin, end, now(), -1.0};
}

void progress_duration(char *out, size_t size, double seconds)
{
    if (!(seconds < 1e7))
        snprintf(out, size, "?");
    else if (seconds < 60)
        snprintf(out, size, "%.0f s", seconds);
    else if (seconds < 3600)
        snprintf(out, size, "%d min %02d s", (int)seconds / 60, (int)seconds % 60);
    else
        snprintf(out, size, "%d h %02d min", (int)seconds / 3600, (int)seconds / 60 % 60);
}

const char *progress_line(char *out, size_t size, const struct progress *p, uint64_t step,
                          double time, double dt, double drift, double elapsed)
{
    const double done = (time - p->begin) / (p->end - p->begin);
    char eta[32] = "?", percent[16] = "";
    if (done > 0 && done <= 1) {
        progress_duration(eta, sizeof eta, elapsed / done - elapsed);
        snprintf(percent, sizeof percent, "%3.0f %%  ", 100 * done);
    }
    snprintf(out, size, "%sstep %llu  t %.4g  dt %.2e  energy drift %.1e  ETA %s", percent,
             (unsigned long long)step, time, dt, drift, eta);
    return out;
}

static bool is_due(const struct progress *p)
{
    return p->on && !(p->shown >= 0 && now() - p->shown < PROGRESS_INTERVAL);
}

void progress_text(struct progress *p, const char *line)
{
    if (!is_due(p))
        return;
    p->shown = now();
    fprintf(stderr, "\r%s\033[K", line);
    fflush(stderr);
}

void progress_show(struct progress *p, uint64_t step, double time, double dt, double drift)
{
    char line[80];
    if (is_due(p))
        progress_text(
            p, progress_line(line, sizeof line, p, step, time, dt, drift, now() - p->started));
}

void progress_end(struct progress *p)
{
    if (p->on && p->shown >= 0)
        fputs("\r\033[K", stderr);
    p->on = false;
}
