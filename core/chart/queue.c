/* chart/queue.c -- the queue of runs: what is left to do, each as a child, its row, its folder. Writes
 * only results.csv and the runs' folders under OUT/runs. */
#include "config.h"

#include "chart/queue.h"

#include "base/text.h"
#include "chart/child.h"
#include "io/log.h"
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

struct queue {
    const struct chart *c;
    struct results *s;
    const struct output *out;
    struct progress progress;
    size_t done, all; /* of this time */
    char label[128];  /* of the run that goes on */
    double begin;     /* [s] */
};

/* -- What is left ------------------------------------------------------------------------------ */

static const char *time_is_up(const struct chart *c, char out[64])
{
    snprintf(out, 64, "no end within %.6g s", c->seconds);
    return out;
}

static bool is_left(const struct chart *c, const struct results *s, size_t i)
{
    char reason[64];
    const struct row *r = &s->row[i];
    if (!c->run[i].wanted)
        return false;
    /* What was refused cost nothing, and may want a plugin that is there by now. */
    return !r->there || r->status == ROW_REFUSED ||
           (r->status == ROW_TIMEOUT && r->reason && strcmp(r->reason, time_is_up(c, reason)) != 0);
}

size_t queue_left(const struct chart *c, const struct results *s)
{
    size_t n = 0;
    for (size_t i = 0; i < c->n_run; i++)
        n += is_left(c, s, i);
    return n;
}

/* -- Folders ----------------------------------------------------------------------------------- */

static bool is_id(const char *name)
{
    return strlen(name) == 16 && strspn(name, "0123456789abcdef") == 16;
}

/* Removes what a run wrote (its folder is flat), all but the summary if that is `kept`. The run that we
 * were killed in may still be dying: its claim is waited for. */
static void clear_folder(const char *path, bool kept)
{
    struct output o;
    struct error ignored;
    struct stat about;
    if (lstat(path, &about) || !S_ISDIR(about.st_mode))
        return;
    const struct timespec moment = {0, 20000000};
    int tries = 0;
    while (output_claim(&o, path, &ignored)) {
        if (++tries == 250)
            return;
        nanosleep(&moment, NULL);
    }
    DIR *folder = opendir(path);
    const struct dirent *entry;
    while (folder && (entry = readdir(folder)))
        if (!(kept && strcmp(entry->d_name, "summary.json") == 0))
            unlinkat(dirfd(folder), entry->d_name, 0);
    if (folder)
        closedir(folder);
    output_close(&o);
    if (!kept)
        rmdir(path);
}

static bool has_row(const struct chart *c, const struct results *s, const char *id)
{
    for (size_t i = 0; i < c->n_run; i++)
        if (strcmp(c->run[i].id, id) == 0)
            return s->row[i].there;
    return false;
}

/* Leftovers of a run that was killed with us go; of one that came to its end the summary stays, which
 * is a result whether or not the chart has that run at present. */
static void sweep(const struct queue *q, bool keep)
{
    char *runs = output_path(q->out, RESULTS_RUNS);
    DIR *folder = runs ? opendir(runs) : NULL;
    const struct dirent *entry;
    while (folder && (entry = readdir(folder))) {
        if (!is_id(entry->d_name))
            continue;
        char *path = text_format("%s/%s", runs, entry->d_name);
        cJSON *summary = results_summary(q->out->dir, entry->d_name);
        const bool kept = has_row(q->c, q->s, entry->d_name) || results_is_done(summary);
        if (path && !(kept && keep))
            clear_folder(path, kept);
        cJSON_Delete(summary);
        free(path);
    }
    if (folder)
        closedir(folder);
    free(runs);
    output_sweep(q->out);
}

/* -- A row from what became of a run ------------------------------------------------------------- */

/* One word for a failure, from its sentence. */
static enum row_status sort_reason(const char *reason)
{
    if (strstr(reason, "time step collapsed"))
        return ROW_DT;
    if (strstr(reason, "no longer a number") || strstr(reason, "not a number") ||
        strstr(reason, " infinite "))
        return ROW_NAN;
    return ROW_FAILED;
}

static int fail_row(struct row *r, enum row_status status, const char *reason, struct error *e)
{
    r->ended = false;
    r->status = status;
    return row_set_reason(r, reason[0] ? reason : "no word was said", e);
}

static int judge(const struct chart *c, struct row *r, const struct child_outcome *o,
                 const cJSON *summary, struct error *e)
{
    char text[128];
    const cJSON *reason = summary ? json_get(summary, "reason") : NULL;
    const char *why = cJSON_IsString(reason) ? reason->valuestring : o->words;
    const int code = WIFEXITED(o->status) ? WEXITSTATUS(o->status) : -1;
    if (code == EXIT_DONE && results_is_done(summary)) {
        r->ended = true;
        return 0;
    }
    if (o->late)
        return fail_row(r, ROW_TIMEOUT, time_is_up(c, text), e);
    if (WIFSIGNALED(o->status)) {
        snprintf(text, sizeof text, "ended by signal %d (%s)", WTERMSIG(o->status),
                 strsignal(WTERMSIG(o->status)));
        return fail_row(r, ROW_CRASH, text, e);
    }
    if (code == EXIT_REFUSED && strstr(why, "it crashed"))
        return fail_row(r, ROW_CRASH, why, e);
    if (code == EXIT_USAGE || code == EXIT_REFUSED)
        return fail_row(r, ROW_REFUSED, why, e);
    return fail_row(r, sort_reason(why), why, e);
}

/* Of a run that left no summary: as the chart has it, at least one. */
static double threads(const struct chart *c, const struct chart_run *run)
{
    for (size_t k = 0; k < c->n_axis; k++)
        if (c->axis[k].option && strcmp(c->axis[k].option, "threads") == 0)
            return fmax(chart_number(c->axis[k].value[run->value[k]].option), 1.0);
    return 1;
}

static int make_row(struct queue *q, size_t i, const struct child_outcome *o, struct error *e)
{
    struct row *r = &q->s->row[i];
    cJSON *summary = results_summary(q->out->dir, q->c->run[i].id);
    row_clear(r);
    int status = summary ? row_from_summary(q->c, r, summary, e) : 0;
    if (!status)
        status = judge(q->c, r, o, summary, e);
    cJSON_Delete(summary);
    if (status)
        return -1;
    r->there = true;
    if (isnan(r->number[ROW_WALL])) {
        r->number[ROW_WALL] = o->seconds;
        r->number[ROW_CORE_SECONDS] = o->seconds * threads(q->c, &q->c->run[i]);
    }
    return 0;
}

/* -- One run ------------------------------------------------------------------------------------- */

/* As a bar: 5/48  [=====>      ]  ETA 3 min 20 s  labels */
static void show(void *data, double seconds)
{
    struct queue *q = data;
    char bar[21], eta[32] = "?", line[200];
    struct timespec t;
    (void)seconds;
    clock_gettime(CLOCK_MONOTONIC, &t);
    const double elapsed = (double)t.tv_sec + 1e-9 * (double)t.tv_nsec - q->begin;
    const size_t full = 20 * q->done / q->all;
    memset(bar, ' ', 20);
    memset(bar, '=', full);
    bar[full < 20 ? full : 19] = '>';
    bar[20] = '\0';
    if (q->done > 0)
        progress_duration(eta, sizeof eta, elapsed / (double)q->done * (double)(q->all - q->done));
    const int n = snprintf(line, sizeof line, "run %zu of %zu  [%s]  ETA %s  ", q->done + 1, q->all,
                           bar, eta);
    if (n < 79)
        snprintf(line + n, sizeof line - (size_t)n, "%.*s", 79 - n, q->label);
    progress_text(&q->progress, line);
}

/* The arguments of a run with those that only the queue adds; the strings in the middle belong to
 * `inner`. */
static char **full_arguments(char **inner, char *out)
{
    size_t n = 0;
    while (inner[n])
        n++;
    char **all = calloc(n + 6, sizeof *all);
    if (!all)
        return NULL;
    all[0] = (char *)"sph";
    all[1] = (char *)"run";
    memcpy(all + 2, inner, n * sizeof *all);
    all[n + 2] = (char *)"--out";
    all[n + 3] = out;
    all[n + 4] = (char *)"--quiet";
    return all;
}

static int start(struct queue *q, size_t i, struct child_outcome *o, struct error *e)
{
    const struct chart_run *run = &q->c->run[i];
    char *path = text_format("%s/" RESULTS_RUNS "/%s", q->out->dir, run->id);
    char **inner = chart_arguments(q->c, run), **all = inner ? full_arguments(inner, path) : NULL;
    int status = path && all ? 0 : error_memory(e, "a run's arguments", 1);
    chart_labels(q->c, run, NULL, 0, true, q->label, sizeof q->label);
    if (!status) {
        clear_folder(path, false);
        status = child_run(all, q->c->seconds, show, q, o, e);
    }
    free(all);
    chart_arguments_free(inner);
    free(path);
    return status;
}

static int run_one(struct queue *q, size_t i, bool keep, bool *interrupted, struct error *e)
{
    struct child_outcome o;
    if (start(q, i, &o, e))
        return -1;
    char *path = text_format("%s/" RESULTS_RUNS "/%s", q->out->dir, q->c->run[i].id);
    int status = path ? 0 : error_memory(e, "a path", 1);
    *interrupted = o.interrupted;
    if (!status && !o.interrupted)
        status = make_row(q, i, &o, e) || row_assess(q->c, &q->s->row[i], e) ||
                 results_write(q->s, q->c, q->out, e);
    if (path && (o.interrupted || !keep))
        clear_folder(path, !o.interrupted);
    free(path);
    return status ? -1 : 0;
}

/* -- All of them --------------------------------------------------------------------------------- */

int queue_run(const struct chart *c, struct results *s, const struct output *o,
              const struct queue_options *options, size_t *made, bool *interrupted, struct error *e)
{
    struct queue q = {.c = c, .s = s, .out = o, .all = queue_left(c, s)};
    struct timespec t;
    int status = 0;
    sweep(&q, options->keep);
    clock_gettime(CLOCK_MONOTONIC, &t);
    q.begin = (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
    progress_start(&q.progress, options->progress, 0, 1);
    *interrupted = false;
    child_signals(true);
    for (size_t i = 0; i < c->n_run && !status && !*interrupted; i++)
        if (is_left(c, s, i)) {
            status = run_one(&q, i, options->keep, interrupted, e);
            q.done += !status && !*interrupted;
        }
    child_signals(false);
    progress_end(&q.progress);
    *made = q.done;
    return status;
}
