/* summary_table.c -- the table that a run ends with, for people. Reads a summary, prints. */
#include "config.h"

#include "io/summary.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define WIDTH 80
#define LABEL_LEAST 14
#define LABEL_MOST 30
#define VALUE_WIDTH 12

/* Columns that a UTF-8 text takes on a terminal: characters, wide ones aside. */
static int columns(const char *text)
{
    int n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

static int widest(int width, const char *prefix, const char *text)
{
    const int n = columns(prefix) + columns(text);
    return n > width && n <= LABEL_MOST ? n : width;
}

/* The labels' column: as wide as the widest needs. */
static int label_width(const struct summary *s)
{
    int width = LABEL_LEAST;
    for (size_t i = 0; i < s->n_probe; i++)
        width = widest(width, "", s->probe[i].name);
    for (size_t i = 0; i < s->n_error; i++)
        width = widest(width, "error of ", s->error[i].field);
    return width;
}

static void label(FILE *out, int width, const char *prefix, const char *text)
{
    const int pad = width - columns(prefix) - columns(text);
    fprintf(out, "%s%s%*s  ", prefix, text, pad > 0 ? pad : 0, "");
}

/* A number of people's length; "-" if there is none. */
static const char *number(char *text, size_t size, double value)
{
    if (isnan(value))
        snprintf(text, size, "-");
    else
        snprintf(text, size, "%.4g", value);
    return text;
}

static const char *seconds(char *text, size_t size, double s)
{
    if (!(s >= 120))
        snprintf(text, size, "%.3g s", s);
    else if (s < 7200)
        snprintf(text, size, "%d min %02d s", (int)(s / 60), (int)fmod(s, 60));
    else
        snprintf(text, size, "%d h %02d min", (int)(s / 3600), (int)fmod(s / 60, 60));
    return text;
}

static void print_particles(const struct summary *s, FILE *out, int width)
{
    int column = width + 2;
    label(out, width, "particles", "");
    for (size_t i = 0; i < s->n_array; i++) {
        char text[160];
        snprintf(text, sizeof text, "%s %llu%s", s->array_name[i],
                 (unsigned long long)s->array_n[i], i + 1 < s->n_array ? ", " : "");
        if (i > 0 && column + columns(text) > WIDTH) {
            fprintf(out, "\n%*s", width + 2, "");
            column = width + 2;
        }
        fputs(text, out);
        column += columns(text);
    }
    fputs(s->n_array ? "\n" : "none\n", out);
}

static void print_probes(const struct summary *s, FILE *out, int width)
{
    char a[32], b[32];
    for (size_t i = 0; i < s->n_probe; i++) {
        const bool expected = !isnan(s->probe[i].expected);
        label(out, width, "", s->probe[i].name);
        fprintf(out, "%-*s", expected ? VALUE_WIDTH : 0, number(a, sizeof a, s->probe[i].value));
        if (expected)
            fprintf(out, "  (expected %s)", number(b, sizeof b, s->probe[i].expected));
        fputs("\n", out);
    }
}

/* The norms, then against what; on one line if that fits. */
static void print_errors(const struct summary *s, FILE *out, int width)
{
    for (size_t i = 0; i < s->n_error; i++) {
        const struct summary_error *from = &s->error[i];
        const char *reference = from->reference ? from->reference : "";
        char norms[128];
        const int n = snprintf(norms, sizeof norms, "l1 %-8.3g l1_rel %-8.3g l2 %-8.3g linf %.3g",
                               from->l1, from->l1_rel, from->l2, from->linf);
        label(out, width, "error of ", from->field);
        fputs(norms, out);
        if (*reference && width + 2 + n + columns(reference) + 3 <= WIDTH)
            fprintf(out, " (%s)", reference);
        else if (*reference)
            fprintf(out, "\n%*s(%s)", width + 2, "", reference);
        fputs("\n", out);
    }
}

static void print_drift(const struct summary *s, FILE *out, int width)
{
    const int n = s->dim >= 1 && s->dim <= 3 ? s->dim : 0;
    double momentum = 0;
    for (int k = 0; k < n; k++)
        momentum += s->momentum_drift[k] * s->momentum_drift[k];
    label(out, width, "energy drift", "");
    fprintf(out, "%-*.2g  momentum %.2g, mass %.2g\n", VALUE_WIDTH, s->energy_drift, sqrt(momentum),
            s->mass_drift);
}

/* What was counted, if anything was. */
static void print_watch(const struct summary *s, FILE *out, int width)
{
    for (size_t i = 0; i < s->n_watch; i++) {
        const struct summary_watch *w = &s->watch[i];
        if (!w->happened)
            continue;
        label(out, width, "watch", "");
        fprintf(out, "%s %llu times, first at step %llu, t = %.4g\n", w->cause,
                (unsigned long long)w->n, (unsigned long long)w->step, w->time);
    }
}

static void print_cost(const struct summary *s, FILE *out, int width)
{
    char text[64];
    const double pair = summary_ns_per_pair(s), update = summary_us_per_update(s);
    label(out, width, "cost", "");
    if (!isnan(pair))
        fprintf(out, "%.3g ns per pair, ", pair);
    if (!isnan(update))
        fprintf(out, "%.3g us per particle update, ", update);
    fprintf(out, "%s\n", seconds(text, sizeof text, s->cost.wall));
    if (s->cost.peak_rss > 0) {
        label(out, width, "memory", "");
        fprintf(out, "%-*.4g  MB at most, %.4g bytes per particle in arrays\n", VALUE_WIDTH,
                1e-6 * (double)s->cost.peak_rss, s->cost.bytes_per_particle);
    }
}

static double member(const cJSON *object, const char *name)
{
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(value) ? value->valuedouble : (double)NAN;
}

/* Where it ran, and what of that device its sweeps reach. */
static void print_device(const struct summary *s, FILE *out, int width)
{
    const cJSON *sweeps = cJSON_GetObjectItemCaseSensitive(s->device, "sweeps");
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(s->device, "name"));
    const double pair = member(sweeps, "ns_per_pair");
    label(out, width, "device", "");
    fprintf(out, "%.*s (opencl:%.0f)\n", WIDTH - width - 14, name ? name : "",
            member(s->device, "number"));
    label(out, width, "", "");
    fprintf(out, "%.3g s of %.3g busy, programs: %.3g s\n", member(s->device, "busy_s"),
            s->cost.loop, member(s->device, "build_s"));
    if (isnan(pair))
        return;
    label(out, width, "sweeps", "");
    fprintf(out, "%.3g ns per pair, %.0f %% of its rate, %.0f %% of its bandwidth\n", pair,
            100 * member(sweeps, "share_of_rate"), 100 * member(sweeps, "share_of_bandwidth"));
}

/* How evenly the work was shared, and what that took. */
static void print_ranks(const struct summary *s, FILE *out, int width)
{
    const cJSON *imbalance = cJSON_GetObjectItemCaseSensitive(s->on_ranks, "imbalance");
    const cJSON *exchange = cJSON_GetObjectItemCaseSensitive(s->on_ranks, "exchange");
    const char *partition =
        cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(s->on_ranks, "partition"));
    const double bytes = member(exchange, "bytes_per_step");
    label(out, width, "ranks", "");
    fprintf(out, "%s, imbalance %.3g (%.3g at most), %.2g ghosts a particle",
            partition ? partition : "", member(imbalance, "last"), member(imbalance, "most"),
            member(s->on_ranks, "ghosts"));
    if (!isnan(bytes))
        fprintf(out, "\n%*s%.3g kB in %.0f messages a step, %.0f %% of the time waiting", width + 2,
                "", 1e-3 * bytes, member(exchange, "messages_per_step"),
                s->cost.wall > 0.0 ? 100.0 * s->cost.mpi / s->cost.wall : 0.0);
    fputs("\n", out);
}

void summary_table(const struct summary *s, FILE *out)
{
    const int width = label_width(s);
    const char *title = s->title ? s->title : "", *scene = s->scene ? s->scene : "";
    const int gap = WIDTH - columns(title) - columns(scene);
    char steps[32], time[32];
    if (*title && gap >= 2)
        fprintf(out, "%s%*s%s\n", title, gap, "", scene);
    else
        fprintf(out, "%s%s%s\n", title, *title ? "\n" : "", scene);
    if (s->status && strcmp(s->status, "done") != 0) {
        label(out, width, s->status, "");
        fprintf(out, "%s\n", s->reason ? s->reason : "before its end");
    }
    print_particles(s, out, width);
    label(out, width, "steps", "");
    snprintf(steps, sizeof steps, "%llu", (unsigned long long)s->steps);
    fprintf(out, "%-*s  to t = %s", VALUE_WIDTH, steps, number(time, sizeof time, s->time));
    if (s->ranks > 1)
        fprintf(out, ", %d ranks", s->ranks);
    if (s->threads > 0)
        fprintf(out, ", %d thread%s", s->threads, s->threads == 1 ? "" : "s");
    fputs("\n", out);
    print_probes(s, out, width);
    print_errors(s, out, width);
    print_drift(s, out, width);
    print_watch(s, out, width);
    print_cost(s, out, width);
    if (s->device)
        print_device(s, out, width);
    if (s->on_ranks)
        print_ranks(s, out, width);
    if (s->picture) {
        label(out, width, "picture", "");
        fprintf(out, "%s\n", s->picture);
    }
}
