/* chart/row.c -- a run's result: from its summary, and what it means for the chart. */
#include "chart/row.h"

#include "base/text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NO_NUMBER "the error is no number"

const char *const row_number_name[ROW_NUMBERS] = {"particles",      "steps",
                                                  "time",           "core_seconds",
                                                  "wall_s",         "particle_updates",
                                                  "pairs",          "bytes_per_particle",
                                                  "peak_rss_bytes", "ns_per_pair",
                                                  "energy_drift"};
const char *const row_status_name[ROW_STATUSES] = {
    "done",   "unstable", "nan",     "dt",    "rho",     "u",     "escaped",
    "energy", "crowd",    "timeout", "crash", "refused", "failed"};

const char *const row_norm_name[ROW_NORMS] = {"l1", "l1_rel", "l2", "l2_rel", "linf"};

void row_clear(struct row *r)
{
    for (size_t i = 0; i < r->n_extra; i++)
        free(r->extra[i].name);
    free(r->extra);
    free(r->reason);
    *r = (struct row){.error = (double)NAN};
    for (size_t i = 0; i < ROW_NUMBERS; i++)
        r->number[i] = (double)NAN;
}

static const struct row_extra *find(const struct row *r, const char *name)
{
    for (size_t i = 0; i < r->n_extra; i++)
        if (strcmp(r->extra[i].name, name) == 0)
            return &r->extra[i];
    return NULL;
}

double row_extra(const struct row *r, const char *name)
{
    const struct row_extra *x = find(r, name);
    return x ? x->value : (double)NAN;
}

int row_set_extra(struct row *r, const char *name, double value, struct error *e)
{
    for (size_t i = 0; i < r->n_extra; i++)
        if (strcmp(r->extra[i].name, name) == 0) {
            r->extra[i].value = value;
            return 0;
        }
    struct row_extra *grown = realloc(r->extra, (r->n_extra + 1) * sizeof *grown);
    if (grown)
        r->extra = grown;
    char *copy = text_format("%s", name);
    if (!grown || !copy) {
        free(copy);
        return error_memory(e, "a chart's results", sizeof *grown);
    }
    r->extra[r->n_extra++] = (struct row_extra){copy, value};
    return 0;
}

int row_set_reason(struct row *r, const char *reason, struct error *e)
{
    char *copy = text_format("%s", reason);
    if (!copy)
        return error_memory(e, "a chart's results", strlen(reason));
    text_one_line(copy);
    free(r->reason);
    r->reason = copy;
    return 0;
}

/* -- Measures ---------------------------------------------------------------------------------- */

double row_measure(const struct row *r, const char *name)
{
    if (strcmp(name, "bytes") == 0)
        return r->number[ROW_BYTES_PER_PARTICLE] * r->number[ROW_PARTICLES];
    for (size_t i = 0; i < ROW_NUMBERS; i++)
        if (strcmp(name, row_number_name[i]) == 0)
            return r->number[i];
    return (double)NAN;
}

size_t row_measures(const char *out[ROW_NUMBERS + 1])
{
    memcpy(out, row_number_name, sizeof row_number_name);
    out[ROW_NUMBERS] = "bytes";
    return ROW_NUMBERS + 1;
}

bool row_is_measure(const char *name)
{
    const char *known[ROW_NUMBERS + 1];
    const size_t n = row_measures(known);
    for (size_t i = 0; i < n; i++)
        if (strcmp(known[i], name) == 0)
            return true;
    return false;
}

/* -- From a summary ---------------------------------------------------------------------------- */

static double number_at(const cJSON *object, const char *key)
{
    const cJSON *node = json_get(object, key);
    return cJSON_IsNumber(node) ? node->valuedouble : (double)NAN;
}

/* The node that "conservation.momentum_drift.0" names. Keys have dots themselves ("fluid.rho"): the
 * longest that fits is taken. */
static const cJSON *node_at(const cJSON *from, const char *path)
{
    const cJSON *best = NULL;
    size_t longest = 0, index = 0;
    if (!*path)
        return from;
    for (const cJSON *child = from->child; child; child = child->next, index++) {
        char number[24];
        snprintf(number, sizeof number, "%zu", index);
        const char *key = cJSON_IsArray(from) ? number : child->string;
        const size_t n = key ? strlen(key) : 0;
        if (n > longest && strncmp(path, key, n) == 0 && (path[n] == '.' || !path[n])) {
            const cJSON *found = node_at(child, path + n + (path[n] == '.'));
            longest = found ? n : longest;
            best = found ? found : best;
        }
    }
    return best;
}

static int put_norms(struct row *r, const cJSON *summary, struct error *e)
{
    const cJSON *errors = json_get(summary, "errors"), *field;
    cJSON_ArrayForEach(field, errors) for (size_t i = 0; i < ROW_NORMS; i++)
    {
        char name[256];
        snprintf(name, sizeof name, "%s.%s", field->string, row_norm_name[i]);
        if (row_set_extra(r, name, number_at(field, row_norm_name[i]), e))
            return -1;
    }
    return 0;
}

static int put_probes(struct row *r, const cJSON *summary, struct error *e)
{
    const cJSON *probes = json_get(summary, "probes"), *probe;
    cJSON_ArrayForEach(probe, probes)
    {
        char name[256];
        snprintf(name, sizeof name, "probe.%s", probe->string);
        if (row_set_extra(r, name, number_at(probe, "value"), e))
            return -1;
        const double expected = number_at(probe, "expected");
        snprintf(name, sizeof name, "probe.%s.expected", probe->string);
        if (!isnan(expected) && row_set_extra(r, name, expected, e))
            return -1;
    }
    return 0;
}

/* A time or a count that a failed run did not come to tell is 0 in its summary: none, here. */
static double told(double value)
{
    return value > 0 ? value : (double)NAN;
}

int row_from_summary(const struct chart *c, struct row *r, const cJSON *summary, struct error *e)
{
    const cJSON *cost = json_get(summary, "cost"), *array;
    const double wall = number_at(cost, "wall_s"), loop = told(number_at(cost, "loop_s"));
    double particles = 0;
    cJSON_ArrayForEach(array, json_get(summary, "particles")) particles += array->valuedouble;
    r->number[ROW_PARTICLES] = particles;
    r->number[ROW_STEPS] = number_at(summary, "steps");
    r->number[ROW_TIME] = number_at(summary, "time");
    r->number[ROW_CORE_SECONDS] = (isnan(loop) ? wall : loop) * number_at(cost, "threads");
    r->number[ROW_WALL] = wall;
    r->number[ROW_UPDATES] = number_at(cost, "particle_updates");
    r->number[ROW_PAIRS] = number_at(cost, "pairs");
    r->number[ROW_BYTES_PER_PARTICLE] = number_at(cost, "bytes_per_particle");
    r->number[ROW_PEAK_RSS] = number_at(cost, "peak_rss_bytes");
    r->number[ROW_NS_PER_PAIR] = told(number_at(cost, "ns_per_pair"));
    r->number[ROW_ENERGY_DRIFT] = number_at(json_get(summary, "conservation"), "energy_drift");
    if (put_norms(r, summary, e) || put_probes(r, summary, e))
        return -1;
    const cJSON *node = c->error.path ? node_at(summary, c->error.path) : NULL;
    if (node && !find(r, c->error.column))
        return row_set_extra(r, c->error.column,
                             cJSON_IsNumber(node) ? node->valuedouble : (double)NAN, e);
    return 0;
}

/* -- What it means ------------------------------------------------------------------------------- */

bool row_has_ended(enum row_status status, const char *reason)
{
    return status == ROW_DONE || status == ROW_UNSTABLE ||
           (status == ROW_NAN && strcmp(reason, NO_NUMBER) == 0);
}

bool row_is_complete(const struct chart *c, const struct row *r)
{
    return !r->ended || find(r, c->error.column);
}

/* What a run has instead of the error that the chart names. */
static int no_such_error(const struct chart *c, const struct row *r, struct error *e)
{
    const char *known[64];
    size_t n = 0;
    char hint[640];
    for (size_t i = 0; i < r->n_extra && n < 64; i++)
        if (c->error.probe ? strncmp(r->extra[i].name, "probe.", 6) == 0
                           : strncmp(r->extra[i].name, "probe.", 6) != 0)
            known[n++] = r->extra[i].name;
    if (c->error.path)
        return document_fail(&c->doc, json_get(c->error.node, "path"), e,
                             "a run's summary has no \"%s\"", c->error.path);
    if (n == 0)
        return document_fail(&c->doc, c->error.node, e, "the scene has no %s",
                             c->error.probe ? "\"probes\"" : "\"compare\": no error comes of it");
    return document_fail(&c->doc, json_get(c->error.node, c->error.probe ? "probe" : "of"), e,
                         "a run has no \"%s\"%s", c->error.column,
                         text_suggest(hint, sizeof hint, c->error.column, known, n));
}

static double error_of(const struct chart *c, const struct row *r)
{
    const double value = row_extra(r, c->error.column);
    char *expected = c->error.probe ? text_format("%s.expected", c->error.column) : NULL;
    const double wanted = expected ? row_extra(r, expected) : (double)NAN;
    free(expected);
    return fabs(isnan(wanted) ? value : value - wanted);
}

int row_assess(const struct chart *c, struct row *r, struct error *e)
{
    char reason[160];
    if (!r->there || !r->ended)
        return 0;
    if (!row_is_complete(c, r))
        return no_such_error(c, r, e);
    const double drift = fabs(r->number[ROW_ENERGY_DRIFT]);
    r->error = error_of(c, r);
    free(r->reason);
    r->reason = NULL;
    r->status = ROW_DONE;
    if (!isfinite(r->error)) {
        r->status = ROW_NAN;
        return row_set_reason(r, NO_NUMBER, e);
    }
    if (r->error > c->unstable)
        snprintf(reason, sizeof reason, "the error %.3g is above %.6g", r->error, c->unstable);
    else if (drift > c->drift)
        snprintf(reason, sizeof reason, "the energy drift %.3g is above %.6g", drift, c->drift);
    else
        return 0;
    r->status = ROW_UNSTABLE;
    return row_set_reason(r, reason, e);
}
