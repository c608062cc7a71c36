/* cli/chart.c -- `sph chart CHART.json`: error against cost for a family of runs. */
#include "config.h"

#include "chart/best.h"
#include "chart/plot.h"
#include "chart/queue.h"
#include "cli/cli.h"

#include "base/text.h"
#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct arguments {
    const char *path, *out, *scene; /* scene: where --output-scene writes */
    const char *only[64];
    size_t n_only;
    double tolerance; /* --error; NaN: none */
    bool list, redraw, best, keep, quiet;
};

enum {
    KEY_OUT = 'o',
    KEY_QUIET = 'q',
    KEY_LIST = 256,
    KEY_REDRAW,
    KEY_ONLY,
    KEY_KEEP,
    KEY_BEST,
    KEY_ERROR,
    KEY_SCENE
};

static const struct argp_option options[] = {
    {"out", KEY_OUT, "DIR", 0,
     "Folder for results and pictures (default: the chart's name with .chart, here)", 0},
    {"only", KEY_ONLY, "AXIS=LABEL", 0, "Only these runs now; may be repeated", 0},
    {"list", KEY_LIST, NULL, 0, "Print the runs and their settings; run nothing", 0},
    {"redraw", KEY_REDRAW, NULL, 0, "Draw from the results that there are; run nothing", 0},
    {"keep-runs", KEY_KEEP, NULL, 0, "Keep the snapshots of finished runs, not the summary alone",
     0},
    {"best", KEY_BEST, NULL, 0, "Name the cheapest finished run that --error allows; run nothing",
     0},
    {"error", KEY_ERROR, "E|P%", 0, "With --best: the error allowed, 0.01 or 1%", 0},
    {"output-scene", KEY_SCENE, "FILE", 0,
     "With --best: write the scene with that run's settings (-: standard output)", 0},
    {"quiet", KEY_QUIET, NULL, 0, "No progress, no table", 0},
    {0}};

static double tolerance(struct argp_state *state, const char *text)
{
    char *end;
    const double value = strtod(text, &end);
    const bool percent = end > text && strcmp(end, "%") == 0;
    if (end == text || (*end && !percent) || !isfinite(value) || value <= 0)
        argp_error(state, "--error: \"%s\" is no error above 0, as 0.01 or 1%%", text);
    return percent ? value / 100 : value;
}

/* Options that only make sense with others. */
static void check(const struct arguments *a, struct argp_state *state)
{
    if (a->list + a->redraw + a->best > 1)
        argp_error(state, "--list, --redraw and --best exclude each other");
    if (a->best && isnan(a->tolerance))
        argp_error(state, "--best wants --error, as --error 1%%");
    if (!a->best && (!isnan(a->tolerance) || a->scene))
        argp_error(state, "--%s goes with --best", a->scene ? "output-scene" : "error");
}

static error_t parse(int key, char *arg, struct argp_state *state)
{
    struct arguments *a = state->input;
    switch (key) {
    case KEY_OUT:
        a->out = arg;
        break;
    case KEY_ONLY:
        if (a->n_only == sizeof a->only / sizeof a->only[0])
            argp_error(state, "too many --only");
        a->only[a->n_only++] = arg;
        break;
    case KEY_LIST:
        a->list = true;
        break;
    case KEY_REDRAW:
        a->redraw = true;
        break;
    case KEY_KEEP:
        a->keep = true;
        break;
    case KEY_BEST:
        a->best = true;
        break;
    case KEY_ERROR:
        a->tolerance = tolerance(state, arg);
        break;
    case KEY_SCENE:
        a->scene = arg;
        break;
    case KEY_QUIET:
        a->quiet = true;
        break;
    case ARGP_KEY_ARG:
        if (a->path)
            argp_error(state, "one chart at a time: \"%s\" and \"%s\"", a->path, arg);
        a->path = arg;
        break;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no chart is given");
        break;
    case ARGP_KEY_END:
        check(a, state);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* "tube.chart" of "charts/tube.chart.json" and of "charts/tube.json". */
static void default_out(const char *path, char *out, size_t size)
{
    const char *slash = strrchr(path, '/');
    snprintf(out, size - strlen(".chart"), "%s", slash ? slash + 1 : path);
    char *dot = strrchr(out, '.');
    if (dot && dot != out && strcmp(dot, ".json") == 0)
        *dot = '\0';
    dot = strrchr(out, '.');
    if (!dot || strcmp(dot, ".chart") != 0)
        strcat(out, ".chart");
}

/* -- What it does -------------------------------------------------------------------------------- */

static int list(const struct chart *c, struct error *e)
{
    char labels[512];
    for (size_t i = 0; i < c->n_run; i++) {
        if (!c->run[i].wanted)
            continue;
        printf("%s  %s\n", c->run[i].id,
               chart_labels(c, &c->run[i], NULL, 0, true, labels, sizeof labels));
        char **argument = chart_arguments(c, &c->run[i]);
        if (!argument)
            return error_memory(e, "a list", 1);
        for (size_t k = 1; argument[k]; k += 2)
            printf("    %s %s\n", argument[k], argument[k + 1]);
        chart_arguments_free(argument);
    }
    return 0;
}

static int draw(const struct chart *c, const struct results *s, const struct output *o, bool tell,
                struct error *e)
{
    for (size_t i = 0; i < c->n_picture; i++) {
        struct plot q;
        int status = plot_make(&q, c, &c->picture[i], s, e);
        if (!status)
            status = plot_write(&q, o, e);
        plot_free(&q);
        if (status)
            return -1;
        if (tell)
            printf("%s/%s.svg\n%s/%s.png\n", o->dir, c->picture[i].name, o->dir,
                   c->picture[i].name);
    }
    return 0;
}

static void tell(const struct chart *c, const struct results *s, const struct output *o)
{
    size_t count[ROW_STATUSES] = {0}, n = 0;
    for (size_t i = 0; i < s->n; i++)
        if (s->row[i].there) {
            count[s->row[i].status]++;
            n++;
        }
    printf("%zu of %zu runs", n, c->n_run);
    for (size_t i = 0; i < ROW_STATUSES; i++)
        if (count[i])
            printf("%s %zu %s", i == ROW_DONE ? ":" : ",", count[i], row_status_name[i]);
    printf("\n%s/" RESULTS_NAME "\n", o->dir);
}

static int interrupted(const struct chart *c, const struct arguments *a, const struct results *s,
                       struct error *e)
{
    return error_set(e, EXIT_RUN,
                     "interrupted; %zu runs are left, and the results of the others are kept: the "
                     "same command goes on (sph chart %s%s%s)",
                     queue_left(c, s), a->path, a->out ? " --out " : "", a->out ? a->out : "");
}

static int redraw(const struct chart *c, const struct arguments *a, const struct results *s,
                  const struct output *o, struct error *e)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        n += s->row[i].there;
    if (n == 0)
        return error_set(e, EXIT_USAGE, "%s holds no results of %s to draw", o->dir, a->path);
    return draw(c, s, o, !a->quiet, e);
}

/* With the folder claimed. */
static int work(const struct chart *c, const struct arguments *a, const struct output *o,
                struct error *e)
{
    struct results s;
    size_t made;
    bool stopped = false;
    const struct queue_options q = {.keep = a->keep, .progress = !a->quiet};
    if (results_read(&s, c, o->dir, e))
        return -1;
    int status = 0;
    if (a->redraw) {
        status = redraw(c, a, &s, o, e);
    } else {
        status = results_write(&s, c, o, e) || queue_run(c, &s, o, &q, &made, &stopped, e) ? -1 : 0;
        if (!status && stopped)
            status = interrupted(c, a, &s, e);
        if (!status && !a->quiet)
            tell(c, &s, o);
        if (!status)
            status = draw(c, &s, o, !a->quiet, e);
    }
    results_free(&s);
    return status;
}

static int write_scene(const char *path, const char *text, struct error *e)
{
    if (strcmp(path, "-") != 0)
        return output_write_path(path, text, strlen(text), e);
    fputs(text, stdout);
    return 0;
}

/* The scene on standard output has it to itself. */
static int best(const struct chart *c, const struct arguments *a, const char *dir, struct error *e)
{
    struct results s;
    size_t run = 0;
    const bool alone = a->scene && strcmp(a->scene, "-") == 0;
    if (results_read(&s, c, dir, e))
        return -1;
    int status = best_print(c, &s, a->tolerance, a->scene, alone ? stderr : stdout, &run, e);
    char *text = !status && a->scene ? best_scene(c, &c->run[run], e) : NULL;
    if (text)
        status = write_scene(a->scene, text, e);
    else if (!status && a->scene)
        status = -1;
    free(text);
    results_free(&s);
    return status;
}

static int run(const struct arguments *a, struct error *e)
{
    struct chart c;
    struct output o = {NULL, -1};
    char folder[512];
    default_out(a->path, folder, sizeof folder);
    const char *dir = a->out ? a->out : folder;
    int status = chart_read(&c, a->path, a->only, a->n_only, e);
    if (!status && a->list)
        status = list(&c, e);
    else if (!status && a->best)
        status = best(&c, a, dir, e);
    else if (!status)
        status = output_claim(&o, dir, e) || work(&c, a, &o, e) ? -1 : 0;
    if (o.dir)
        output_close(&o);
    chart_free(&c);
    return status;
}

int cli_chart(int argc, char **argv)
{
    static const struct argp argp = {
        .options = options,
        .parser = parse,
        .args_doc = "CHART.json",
        .doc = "Runs a scene in all combinations of the settings that a chart file names, and "
               "draws error against cost. Run again it makes only what is not there yet.\v"
               "The folder holds results.csv, a row a run, and each picture as SVG and PNG. Runs "
               "that fail are results as well. Exit status: 0 done; 1 interrupted, or with --best "
               "no run is good enough; 2 the command line or the chart is wrong."};
    struct arguments a = {.tolerance = (double)NAN};
    struct error e = {0};
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    return run(&a, &e) ? cli_error(&e) : EXIT_DONE;
}
