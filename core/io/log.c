/* log.c -- log.csv, a row at a time, and the line that a terminal shows meanwhile. */
#include "config.h"

#include "io/log.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* -- log.csv ----------------------------------------------------------------------------------- */

int log_open(struct log *l, const char *path, int dim, struct error *e)
{
    *l = (struct log){.dim = dim};
    return csv_open(&l->csv, path, CSV_OVER, e);
}

int log_append(struct log *l, const char *path, int dim, struct error *e)
{
    *l = (struct log){.dim = dim};
    if (csv_open(&l->csv, path, CSV_GO_ON, e))
        return -1;
    l->header_done = l->csv.good > 0;
    return 0;
}

static const char axis[] = "xyz";

/* Angular momentum has no component in 1D, one in 2D, three in 3D. */
static int angular_first(int dim)
{
    return dim == 3 ? 0 : dim == 2 ? 2 : 3;
}

static void put_axes(struct csv *c, const char *what, int first, int end)
{
    char name[32];
    for (int k = first; k < end; k++) {
        snprintf(name, sizeof name, "%s_%c", what, axis[k]);
        csv_name(c, name);
    }
}

static void put_header(struct log *l, const struct log_row *row)
{
    static const char *const first[] = {"step", "time", "dt", "kinetic", "internal", "potential"};
    for (size_t i = 0; i < sizeof first / sizeof *first; i++)
        csv_name(&l->csv, first[i]);
    put_axes(&l->csv, "momentum", 0, l->dim);
    put_axes(&l->csv, "angular", angular_first(l->dim), 3);
    csv_name(&l->csv, "mass");
    for (uint64_t i = 0; i < row->n_extra; i++)
        csv_name(&l->csv, row->extra_name[i]);
    csv_name(&l->csv, "wall_s");
    csv_end_row(&l->csv);
}

static void put_row(struct log *l, const struct log_row *row)
{
    const double first[] = {row->time, row->dt, row->kinetic, row->internal, row->potential};
    csv_count(&l->csv, row->step);
    for (size_t i = 0; i < sizeof first / sizeof *first; i++)
        csv_number(&l->csv, first[i]);
    for (int k = 0; k < l->dim; k++)
        csv_number(&l->csv, row->momentum[k]);
    for (int k = angular_first(l->dim); k < 3; k++)
        csv_number(&l->csv, row->angular[k]);
    csv_number(&l->csv, row->mass);
    for (uint64_t i = 0; i < row->n_extra; i++)
        csv_number(&l->csv, row->extra[i]);
    csv_fixed(&l->csv, row->wall, 3);
    csv_end_row(&l->csv);
}

int log_write(struct log *l, const struct log_row *row, struct error *e)
{
    if (!l->header_done)
        put_header(l, row);
    put_row(l, row);
    if (csv_commit(&l->csv, e))
        return -1;
    l->header_done = true;
    return 0;
}

int log_close(struct log *l, struct error *e)
{
    const int result = csv_close(&l->csv, e);
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
