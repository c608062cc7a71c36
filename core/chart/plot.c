/* chart/plot.c -- gathers the points of a picture from the results, and what is to be said of them. */
#include "chart/plot.h"

#include "base/text.h"
#include "chart/fit.h"
#include "io/render_parts.h"
#include "io/cells.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FLAT 0.1 /* a local slope below which an error no longer falls */

const char *plot_measure(const char *name)
{
    static const char *const known[][2] = {{"core_seconds", "core-seconds"},
                                           {"wall_s", "seconds"},
                                           {"time", "time reached"},
                                           {"particle_updates", "particle updates"},
                                           {"bytes_per_particle", "bytes per particle"},
                                           {"peak_rss_bytes", "bytes of memory at most"},
                                           {"bytes", "bytes of all particles"},
                                           {"ns_per_pair", "nanoseconds per pair"},
                                           {"energy_drift", "energy drift"}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strcmp(name, known[i][0]) == 0)
            return known[i][1];
    return name;
}

/* -- Points -------------------------------------------------------------------------------------- */

static double x_of(const struct plot *q, size_t run)
{
    if (q->p->kind == CHART_MAP)
        return 1; /* a cell has no place on an axis of numbers */
    if (q->p->x_axis == SIZE_MAX)
        return row_measure(&q->s->row[run], q->p->x);
    return q->c->axis[q->p->x_axis].value[q->c->run[run].value[q->p->x_axis]].number;
}

static bool same_series(const struct plot *q, size_t a, size_t b)
{
    for (size_t i = 0; i < q->p->n_series; i++)
        if (q->c->run[a].value[q->p->series[i]] != q->c->run[b].value[q->p->series[i]])
            return false;
    return true;
}

/* The series of a run: the first run of each stands for it in `first`. */
static size_t series_of(struct plot *q, size_t *first, size_t run)
{
    for (size_t i = 0; i < q->n_series; i++)
        if (same_series(q, first[i], run))
            return i;
    struct plot_series *s = &q->series[q->n_series];
    first[q->n_series] = run;
    chart_labels(q->c, &q->c->run[run], q->p->series, q->p->n_series, false, s->label,
                 sizeof s->label);
    if (!s->label[0])
        snprintf(s->label, sizeof s->label, "runs");
    return q->n_series++;
}

static int add_point(struct plot_series *s, double x, double y, double size, struct error *e)
{
    double *grown_x = realloc(s->x, (s->n + 1) * sizeof *grown_x);
    if (grown_x)
        s->x = grown_x;
    double *grown_y = realloc(s->y, (s->n + 1) * sizeof *grown_y);
    if (grown_y)
        s->y = grown_y;
    double *grown_size = realloc(s->size, (s->n + 1) * sizeof *grown_size);
    if (grown_size)
        s->size = grown_size;
    if (!grown_x || !grown_y || !grown_size)
        return error_memory(e, "a picture", s->n);
    s->x[s->n] = x;
    s->size[s->n] = size;
    s->y[s->n++] = y;
    return 0;
}

static int add_run(struct plot *q, size_t *first, size_t i, struct error *e)
{
    const struct row *r = &q->s->row[i];
    const double x = x_of(q, i);
    const size_t series = series_of(q, first, i);
    q->n_run++;
    q->n_missing += !r->there;
    if (!r->there)
        return 0;
    q->count[r->status]++;
    if (r->status != ROW_DONE) {
        q->failed[q->n_failed++] = (struct plot_failed){x > 0 ? x : (double)NAN, series};
        return 0;
    }
    if (!(x > 0 && r->error > 0)) {
        q->n_zero++;
        return 0;
    }
    q->x[q->n] = x;
    q->y[q->n] = r->error;
    q->run[q->n++] = i;
    return add_point(&q->series[series], x, r->error, r->number[ROW_PARTICLES], e);
}

static int add_peer(struct plot *q, const struct chart_peer *peer, struct error *e)
{
    const size_t x = cells_column(peer->table, q->p->x), y = cells_column(peer->table, "error");
    if (x == (size_t)-1)
        return 0;
    struct plot_series *s = &q->series[q->n_series++];
    snprintf(s->label, sizeof s->label, "%s", peer->label);
    s->peer = peer;
    for (size_t k = 0; k < peer->table->n_row; k++)
        if (add_point(s, chart_number(cells_at(peer->table, k, x)),
                      chart_number(cells_at(peer->table, k, y)), (double)NAN, e))
            return -1;
    return 0;
}

static int gather(struct plot *q, struct error *e)
{
    size_t *first = calloc(q->c->n_run, sizeof *first);
    int status = first ? 0 : error_memory(e, "a picture", q->c->n_run);
    for (size_t i = 0; i < q->c->n_run && !status; i++)
        if (chart_choice_has(q->c, &q->p->select, &q->c->run[i]))
            status = add_run(q, first, i, e);
    free(first);
    for (size_t i = 0; i < q->c->n_peer && !status && q->p->kind != CHART_MAP; i++)
        status = add_peer(q, &q->c->peer[i], e);
    return status;
}

/* -- Axes that matter ------------------------------------------------------------------------------ */

/* Which axes have more than one value among the runs of this picture. */
static int find_varied(struct plot *q, struct error *e)
{
    q->varied = calloc(q->c->n_axis, sizeof *q->varied);
    if (!q->varied)
        return error_memory(e, "a picture", q->c->n_axis);
    for (size_t k = 0; k < q->c->n_axis; k++) {
        const struct chart_run *one = NULL;
        bool varies = false;
        for (size_t i = 0; i < q->c->n_run; i++)
            if (chart_choice_has(q->c, &q->p->select, &q->c->run[i])) {
                one = one ? one : &q->c->run[i];
                varies = varies || q->c->run[i].value[k] != one->value[k];
            }
        if (varies)
            q->varied[q->n_varied++] = k;
    }
    return 0;
}

/* Axes that vary within a series. */
static size_t free_axes(const struct plot *q)
{
    size_t n = 0;
    for (size_t i = 0; i < q->n_varied; i++) {
        bool in_series = false;
        for (size_t k = 0; k < q->p->n_series; k++)
            in_series = in_series || q->p->series[k] == q->varied[i];
        n += !in_series;
    }
    return n;
}

/* -- Lines and fits -------------------------------------------------------------------------------- */

/* All points by x where a series is one family; else those of its own front, since a line through a
 * cloud says nothing. */
static int make_line(struct plot_series *s, bool all, struct error *e)
{
    s->line = calloc(s->n + 1, sizeof *s->line);
    if (!s->line)
        return error_memory(e, "a picture", s->n);
    if (!all) {
        s->n_line = fit_front(s->x, s->y, s->n, s->line);
        return 0;
    }
    for (size_t i = 0; i < s->n; i++) {
        size_t at = s->n_line++;
        for (; at > 0 && s->x[s->line[at - 1]] > s->x[i]; at--)
            s->line[at] = s->line[at - 1];
        s->line[at] = i;
    }
    return 0;
}

const char *plot_number(char *out, size_t size, double value, int digits)
{
    char rounded[32];
    snprintf(rounded, sizeof rounded, "%.*g", digits, value);
    return pretty_number(out, size, strtod(rounded, NULL));
}

/* "−0.93", never "−0.00" */
static const char *exponent(char out[32], double value)
{
    snprintf(out, 32, "%s%.2f", value <= -0.005 ? "−" : "", fabs(value));
    return out;
}

/* Of the runs with so many particles the one that gets most for its cost. */
static size_t best_of(const struct plot_series *s, double size)
{
    size_t best = s->n;
    for (size_t i = 0; i < s->n; i++)
        if (fabs(s->size[i] - size) <= 0 &&
            (best == s->n || s->x[i] * s->y[i] < s->x[best] * s->y[best]))
            best = i;
    return best;
}

/* The two finest: of the two largest numbers of particles, or else the last two of the line. */
static bool finest_two(const struct plot_series *s, double x[2], double y[2])
{
    double size[2] = {0, 0};
    for (size_t i = 0; i < s->n; i++)
        size[1] = fmax(size[1], s->size[i]);
    for (size_t i = 0; i < s->n; i++)
        if (s->size[i] < size[1])
            size[0] = fmax(size[0], s->size[i]);
    const bool by_size = size[0] > 0;
    if (!by_size && s->n_line < 3)
        return false;
    for (size_t k = 0; k < 2; k++) {
        const size_t i = by_size ? best_of(s, size[k]) : s->line[s->n_line - 2 + k];
        x[k] = s->x[i];
        y[k] = s->y[i];
    }
    return true;
}

/* "slope −0.93, finest two −0.95"; of errors against particles the order in the spacing. */
static void make_note(const struct plot *q, struct plot_series *s)
{
    double slope, factor, local, x[2], y[2];
    char a[32], b[32];
    if (!fit_power(s->x, s->y, s->n, &slope, &factor)) {
        snprintf(s->note, sizeof s->note, s->n == 0 ? "no finished run" : "one cost: no slope");
        return;
    }
    const cJSON *dim = json_get(q->c->scene.root, "dimensions");
    const bool order =
        q->p->kind == CHART_CONVERGENCE && strcmp(q->p->x, "particles") == 0 && cJSON_IsNumber(dim);
    const double scale = order ? -dim->valuedouble : 1;
    int n = snprintf(s->note, sizeof s->note, "%s %s", order ? "order" : "slope",
                     exponent(a, scale * slope));
    if (s->n < 3 || !finest_two(s, x, y) || !fit_power(x, y, 2, &local, &factor))
        return;
    n += snprintf(s->note + n, sizeof s->note - (size_t)n, ", finest two %s",
                  exponent(b, scale * local));
    if (fabs(local) < FLAT)
        snprintf(s->note + n, sizeof s->note - (size_t)n, ": floor near %s",
                 plot_number(a, sizeof a, sqrt(y[0] * y[1]), 2));
}

static int make_series(struct plot *q, struct error *e)
{
    const bool family = free_axes(q) <= 1;
    for (size_t i = 0; i < q->n_series; i++) {
        if (make_line(&q->series[i], family || q->series[i].peer != NULL, e))
            return -1;
        make_note(q, &q->series[i]);
    }
    q->front = calloc(q->n + 1, sizeof *q->front);
    if (!q->front)
        return error_memory(e, "a picture", q->n);
    q->n_front = fit_front(q->x, q->y, q->n, q->front);
    return 0;
}

static void make_ranges(struct plot *q)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {0, 0};
    for (size_t i = 0; i < q->n_series; i++)
        for (size_t k = 0; k < q->series[i].n; k++) {
            const double at[2] = {q->series[i].x[k], q->series[i].y[k]};
            for (int d = 0; d < 2; d++) {
                low[d] = fmin(low[d], at[d]);
                high[d] = fmax(high[d], at[d]);
            }
        }
    for (size_t i = 0; i < q->n_failed; i++) {
        low[0] = fmin(low[0], q->failed[i].x);
        high[0] = fmax(high[0], q->failed[i].x);
    }
    for (int d = 0; d < 2; d++)
        if (low[d] <= high[d])
            fit_range(low[d], high[d], &q->low[d], &q->high[d]);
        else
            fit_range(1, 10, &q->low[d], &q->high[d]);
}

/* -- Words ----------------------------------------------------------------------------------------- */

const char *plot_failures(const struct plot *q, char *out, size_t size)
{
    size_t at = 0;
    out[0] = '\0';
    for (size_t i = 0; i < ROW_STATUSES && at < size; i++)
        if (i != ROW_DONE && q->count[i]) {
            const int more = snprintf(out + at, size - at, "%s%zu %s", at ? ", " : "", q->count[i],
                                      row_status_name[i]);
            at += more > 0 ? (size_t)more : 0;
        }
    return out;
}

/* What "select" pins: "; AXIS = LABEL". */
static void put_selected(const struct plot *q, char *out, size_t size)
{
    size_t at = strlen(out);
    for (size_t k = 0; k < q->c->n_axis && at < size; k++) {
        size_t n = 0, last = 0;
        for (size_t i = 0; i < q->c->axis[k].n_value; i++)
            if (q->p->select.has[k][i]) {
                n++;
                last = i;
            }
        if (n != 1 || q->c->axis[k].n_value == 1)
            continue;
        const int more = snprintf(out + at, size - at, "; %s = %s", q->c->axis[k].name,
                                  q->c->axis[k].value[last].label);
        at += more > 0 ? (size_t)more : 0;
    }
}

static void put_counts(const struct plot *q, char *out, size_t size, const char *how)
{
    size_t at = strlen(out), failed = q->n_run - q->n_missing - q->count[ROW_DONE];
    at += (size_t)snprintf(out + at, size - at, "; %zu run%s", q->n_run, q->n_run == 1 ? "" : "s");
    if (failed > 0 && at < size)
        at += (size_t)snprintf(out + at, size - at, ", %zu failed (%s)", failed, how);
    if (q->n_missing > 0 && at < size)
        at += (size_t)snprintf(out + at, size - at, ", %zu not made yet", q->n_missing);
    if (q->n_zero > 0 && at < size)
        snprintf(out + at, size - at, ", %zu without an error or a cost above 0", q->n_zero);
}

static void make_words(struct plot *q)
{
    const char *error = q->c->error.title;
    const char *x = plot_measure(q->p->x);
    snprintf(q->x_label, sizeof q->x_label, "%s", x);
    snprintf(q->y_label, sizeof q->y_label, "%s", error);
    plot_failures(q, q->failures, sizeof q->failures);
    if (q->p->kind == CHART_MAP) {
        snprintf(q->y_label, sizeof q->y_label, "%s", q->c->axis[q->p->y_axis].name);
        snprintf(q->subtitle, sizeof q->subtitle, "%s by %s and %s; darker is better", error,
                 q->p->x, q->y_label);
    } else {
        snprintf(q->subtitle, sizeof q->subtitle, "%s against %s; %s is better", error, x,
                 q->p->kind == CHART_COST ? "lower left" : "lower");
    }
    put_selected(q, q->subtitle, sizeof q->subtitle);
    put_counts(q, q->subtitle, sizeof q->subtitle,
               q->p->kind == CHART_MAP ? "hatched" : "triangles at the top");
}

/* -- All of it --------------------------------------------------------------------------------------- */

int plot_make(struct plot *q, const struct chart *c, const struct chart_picture *p,
              const struct results *s, struct error *e)
{
    const size_t n = c->n_run;
    *q = (struct plot){.c = c, .p = p, .s = s};
    q->series = calloc(n + c->n_peer, sizeof *q->series);
    q->failed = calloc(n, sizeof *q->failed);
    q->x = calloc(n, sizeof *q->x);
    q->y = calloc(n, sizeof *q->y);
    q->run = calloc(n, sizeof *q->run);
    if (!q->series || !q->failed || !q->x || !q->y || !q->run)
        return error_memory(e, "a picture", n);
    if (find_varied(q, e) || gather(q, e) || make_series(q, e))
        return -1;
    make_ranges(q);
    make_words(q);
    return 0;
}

void plot_free(struct plot *q)
{
    for (size_t i = 0; i < q->n_series; i++) {
        free(q->series[i].x);
        free(q->series[i].y);
        free(q->series[i].size);
        free(q->series[i].line);
    }
    free(q->series);
    free(q->failed);
    free(q->x);
    free(q->y);
    free(q->run);
    free(q->front);
    free(q->varied);
    *q = (struct plot){0};
}
