/* chart/results.c -- results.csv: read by run, written whole in the chart's order. */
#include "chart/results.h"

#include "base/text.h"
#include "io/cells.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *results_number(char out[32], double value)
{
    out[0] = '\0';
    for (int digits = 15; digits <= 17 && !isnan(value); digits++) {
        snprintf(out, 32, "%.*g", digits, value);
        if (fabs(strtod(out, NULL) - value) <= 0)
            break;
    }
    return out;
}

cJSON *results_summary(const char *dir, const char *id)
{
    struct document d;
    struct error ignored;
    char *path = text_format("%s/" RESULTS_RUNS "/%s/summary.json", dir, id);
    cJSON *root = NULL;
    if (path && document_load(&d, path, &ignored) == 0) {
        root = d.root;
        d.root = NULL;
        document_free(&d);
    }
    free(path);
    return root;
}

bool results_is_done(const cJSON *summary)
{
    const cJSON *status = summary ? json_get(summary, "status") : NULL;
    return cJSON_IsString(status) && strcmp(status->valuestring, "done") == 0;
}

/* -- Reading ------------------------------------------------------------------------------------- */

static double number(const char *cell)
{
    return *cell ? chart_number(cell) : (double)NAN;
}

static bool is_fixed(const char *name)
{
    static const char *const others[] = {"id", "status", "reason", "error"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (strcmp(name, others[i]) == 0)
            return true;
    for (size_t i = 0; i < ROW_NUMBERS; i++)
        if (strcmp(name, row_number_name[i]) == 0)
            return true;
    return strncmp(name, "axis.", 5) == 0;
}

static int read_row(struct row *r, const struct cells *t, size_t k, struct error *e)
{
    const char *status = cells_at(t, k, cells_column(t, "status"));
    const char *reason = cells_at(t, k, cells_column(t, "reason"));
    r->status = ROW_FAILED;
    for (size_t i = 0; i < ROW_STATUSES; i++)
        if (strcmp(status, row_status_name[i]) == 0)
            r->status = (enum row_status)i;
    r->ended = row_has_ended(r->status, reason);
    if (*reason && row_set_reason(r, reason, e))
        return -1;
    for (size_t i = 0; i < ROW_NUMBERS; i++)
        r->number[i] = number(cells_at(t, k, cells_column(t, row_number_name[i])));
    for (size_t i = 0; i < t->n_column; i++) {
        const char *cell = cells_at(t, k, i);
        /* An empty cell of a run that ended is a number that is none (nan). */
        if (!is_fixed(t->name[i]) && (*cell || r->ended) &&
            row_set_extra(r, t->name[i], number(cell), e))
            return -1;
    }
    r->there = true;
    return 0;
}

static bool is_ours(const struct cells *t)
{
    static const char *const needed[] = {"id", "status", "reason", "error"};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++)
        if (cells_column(t, needed[i]) == (size_t)-1)
            return false;
    for (size_t i = 0; i < ROW_NUMBERS; i++)
        if (cells_column(t, row_number_name[i]) == (size_t)-1)
            return false;
    return true;
}

/* A row whose run the chart has; what the chart's error needs and the row lacks comes from the run's
 * summary, which is kept. Without it the run is made again. */
static int take_row(struct results *s, const struct chart *c, const struct cells *t, size_t k,
                    struct error *e)
{
    const char *id = cells_at(t, k, cells_column(t, "id"));
    size_t i = 0;
    while (i < c->n_run && strcmp(c->run[i].id, id) != 0)
        i++;
    if (i == c->n_run)
        return 0;
    struct row *r = &s->row[i];
    row_clear(r);
    if (read_row(r, t, k, e))
        return -1;
    if (!row_is_complete(c, r))
        row_clear(r); /* take_summary makes it anew, if it can */
    return row_assess(c, r, e);
}

/* A run without a row whose summary says that it came to its end: we were killed before the row was
 * written, or the chart had not this run for a while. */
static int take_summary(struct row *r, const struct chart *c, const char *dir, const char *id,
                        struct error *e)
{
    cJSON *summary = results_summary(dir, id);
    int result = 0;
    if (results_is_done(summary)) {
        r->there = r->ended = true;
        result = row_from_summary(c, r, summary, e) || row_assess(c, r, e) ? -1 : 0;
    }
    cJSON_Delete(summary);
    return result;
}

int results_read(struct results *s, const struct chart *c, const char *dir, struct error *e)
{
    struct cells t;
    *s = (struct results){calloc(c->n_run, sizeof *s->row), c->n_run};
    char *path = text_format("%s/" RESULTS_NAME, dir);
    int status = s->row && path ? 0 : error_memory(e, "a chart's results", c->n_run);
    for (size_t i = 0; i < c->n_run && s->row; i++)
        row_clear(&s->row[i]);
    if (!status && access(path, F_OK) == 0) {
        status = cells_read(&t, path, e);
        if (!status && !is_ours(&t))
            status = error_set(
                e, EXIT_USAGE,
                "%s is not of a chart and would be overwritten; choose another --out", path);
        for (size_t k = 0; !status && k < t.n_row; k++)
            status = take_row(s, c, &t, k, e);
        cells_free(&t);
    }
    free(path);
    for (size_t i = 0; i < c->n_run && !status; i++)
        if (!s->row[i].there)
            status = take_summary(&s->row[i], c, dir, c->run[i].id, e);
    if (status)
        results_free(s);
    return status;
}

void results_free(struct results *s)
{
    for (size_t i = 0; i < s->n && s->row; i++)
        row_clear(&s->row[i]);
    free(s->row);
    *s = (struct results){0};
}

/* -- Writing ------------------------------------------------------------------------------------- */

/* The columns beyond the fixed ones, as they first come: [n] names that belong to the rows. */
static const char **extra_names(const struct results *s, size_t *n)
{
    size_t room = 64;
    const char **name = malloc(room * sizeof *name);
    *n = 0;
    for (size_t i = 0; i < s->n; i++)
        for (size_t k = 0; s->row[i].there && k < s->row[i].n_extra; k++) {
            size_t at = 0;
            while (at < *n && strcmp(name[at], s->row[i].extra[k].name) != 0)
                at++;
            if (at < *n)
                continue;
            if (*n == room) {
                const char **grown = realloc(name, 2 * room * sizeof *grown);
                if (!grown) {
                    free(name);
                    return NULL;
                }
                name = grown;
                room *= 2;
            }
            if (name)
                name[(*n)++] = s->row[i].extra[k].name;
        }
    return name;
}

static void put_number(FILE *f, double value)
{
    char text[32];
    fprintf(f, ",%s", results_number(text, value));
}

static void put_text(FILE *f, const char *text)
{
    putc(',', f);
    text_put_cell(f, text);
}

static void put_row(FILE *f, const struct chart *c, size_t i, const struct row *r,
                    const char *const *extra, size_t n_extra)
{
    fputs(c->run[i].id, f);
    for (size_t k = 0; k < c->n_axis; k++)
        put_text(f, c->axis[k].value[c->run[i].value[k]].label);
    put_text(f, row_status_name[r->status]);
    put_text(f, r->reason ? r->reason : "");
    put_number(f, r->error);
    for (size_t k = 0; k < ROW_NUMBERS; k++)
        put_number(f, r->number[k]);
    for (size_t k = 0; k < n_extra; k++)
        put_number(f, row_extra(r, extra[k]));
    putc('\n', f);
}

static void put_header(FILE *f, const struct chart *c, const char *const *extra, size_t n_extra)
{
    fputs("id", f);
    for (size_t k = 0; k < c->n_axis; k++) {
        char *name = text_format("axis.%s", c->axis[k].name);
        put_text(f, name ? name : "");
        free(name);
    }
    fputs(",status,reason,error", f);
    for (size_t k = 0; k < ROW_NUMBERS; k++)
        put_text(f, row_number_name[k]);
    for (size_t k = 0; k < n_extra; k++)
        put_text(f, extra[k]);
    putc('\n', f);
}

int results_write(const struct results *s, const struct chart *c, const struct output *o,
                  struct error *e)
{
    char *text = NULL;
    size_t size = 0, n_extra;
    const char **extra = extra_names(s, &n_extra);
    FILE *f = extra ? open_memstream(&text, &size) : NULL;
    if (f) {
        put_header(f, c, extra, n_extra);
        for (size_t i = 0; i < s->n; i++)
            if (s->row[i].there)
                put_row(f, c, i, &s->row[i], extra, n_extra);
    }
    const bool good = f && !ferror(f);
    const int status = f && fclose(f) == 0 && good ? output_write(o, RESULTS_NAME, text, size, e)
                                                   : error_memory(e, "a chart's results", size);
    free(text);
    free(extra);
    return status;
}
