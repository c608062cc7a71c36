/* chart/expand.c -- from axes to runs: their product in order, the last axis fastest, and what each
 * run is called and started with. */
#include "chart/chart.h"

#include "base/text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SETS_MOST 64 /* that `sph run` takes (cli/scene_options.h) */

/* FNV-1a with 64 bits. */
static uint64_t hash(const char *text, size_t n)
{
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < n; i++)
        h = (h ^ (unsigned char)text[i]) * 0x100000001b3u;
    return h;
}

/* -- What a run is started with ------------------------------------------------------------------ */

struct arguments {
    char **text;
    size_t n, room;
    bool failed;
};

static void put(struct arguments *a, const char *text)
{
    if (a->n + 2 > a->room) {
        char **grown = realloc(a->text, (2 * a->room + 16) * sizeof *grown);
        if (!grown) {
            a->failed = true;
            return;
        }
        a->text = grown;
        a->room = 2 * a->room + 16;
    }
    a->text[a->n] = text_format("%s", text);
    a->failed = a->failed || !a->text[a->n];
    a->n += a->text[a->n] != NULL;
    a->text[a->n] = NULL;
}

static void put_pair(struct arguments *a, const char *option, const char *value)
{
    put(a, option);
    put(a, value);
}

char **chart_arguments(const struct chart *c, const struct chart_run *r)
{
    struct arguments a = {0};
    put(&a, c->scene_path);
    for (size_t i = 0; i < c->n_load; i++)
        put_pair(&a, "--load", c->load[i]);
    for (size_t i = 0; i < c->n_set; i++)
        put_pair(&a, "--set", c->set[i]);
    for (size_t k = 0; k < c->n_axis; k++) {
        const struct chart_value *v = &c->axis[k].value[r->value[k]];
        for (size_t i = 0; i < v->n_set; i++)
            put_pair(&a, "--set", v->set[i]);
        if (v->option) {
            char option[32];
            snprintf(option, sizeof option, "--%s", c->axis[k].option);
            put_pair(&a, option, v->option);
        }
    }
    if (!a.failed)
        return a.text;
    chart_arguments_free(a.text);
    return NULL;
}

void chart_arguments_free(char **argument)
{
    for (size_t i = 0; argument && argument[i]; i++)
        free(argument[i]);
    free(argument);
}

/* The scene's text stands for its path: a scene that is edited is another one. */
static int make_settings(const struct chart *c, struct chart_run *r, struct error *e)
{
    char **argument = chart_arguments(c, r), *text = NULL;
    if (argument)
        text =
            text_format("scene %016llx", (unsigned long long)hash(c->scene.text, c->scene.length));
    for (size_t i = 1; text && argument[i]; i++) {
        char *longer = text_format("%s\n%s", text, argument[i]);
        free(text);
        text = longer;
    }
    chart_arguments_free(argument);
    if (!text)
        return error_memory(e, "a chart's runs", 1);
    r->settings = text;
    snprintf(r->id, sizeof r->id, "%016llx", (unsigned long long)hash(text, strlen(text)));
    return 0;
}

/* -- The product --------------------------------------------------------------------------------- */

static bool is_skipped(const struct chart *c, const struct chart_run *r)
{
    for (size_t i = 0; i < c->n_skip; i++)
        if (chart_choice_has(c, &c->skip[i], r))
            return true;
    return false;
}

/* --only AXIS=LABEL: of one axis any of its labels that are named, of several all. */
static int apply_only(struct chart *c, const char *const *only, size_t n_only, struct error *e)
{
    struct chart_choice chosen = {0};
    bool *named = calloc(c->n_axis, sizeof *named);
    int status = named ? chart_choice_make(c, &chosen, e) : error_memory(e, "a chart", 1);
    for (size_t i = 0; i < n_only && !status; i++) {
        const char *equals = strchr(only[i], '=');
        char *name = equals ? text_format("%.*s", (int)(equals - only[i]), only[i]) : NULL;
        size_t axis = 0, value = 0;
        struct error inner = {0};
        if (!name)
            status = error_set(e, EXIT_USAGE, "--only %s: give AXIS=LABEL", only[i]);
        else if (chart_axis_of(c, NULL, name, &axis, &inner))
            status = error_set(e, EXIT_USAGE, "--only %s: %s", only[i], inner.text);
        free(name);
        if (status)
            break;
        if (!named[axis])
            memset(chosen.has[axis], false, c->axis[axis].n_value);
        named[axis] = true;
        cJSON label = {.type = cJSON_String, .valuestring = (char *)(equals + 1)};
        if (!equals[1] || chart_label_of(c, axis, &label, &value, &inner))
            status = error_set(e, EXIT_USAGE, "--only %s: axis \"%s\" has no label \"%s\"", only[i],
                               c->axis[axis].name, equals + 1);
        else
            chosen.has[axis][value] = true;
    }
    for (size_t i = 0; i < c->n_run && !status; i++)
        c->run[i].wanted = chart_choice_has(c, &chosen, &c->run[i]);
    chart_choice_free(c, &chosen);
    free(named);
    return status;
}

static int too_many_sets(const struct chart *c, struct error *e)
{
    size_t n = c->n_set;
    for (size_t k = 0; k < c->n_axis; k++) {
        size_t most = 0;
        for (size_t i = 0; i < c->axis[k].n_value; i++)
            most = c->axis[k].value[i].n_set > most ? c->axis[k].value[i].n_set : most;
        n += most;
    }
    if (n <= SETS_MOST)
        return 0;
    return document_fail(&c->doc, json_get(c->doc.root, "axes"), e,
                         "a run would have %zu changes of the scene; %d are possible", n,
                         SETS_MOST);
}

/* Two runs of the same settings would share a folder and a row. */
static int twins(const struct chart *c, struct error *e)
{
    char a[256], b[256];
    for (size_t i = 0; i < c->n_run; i++)
        for (size_t k = i + 1; k < c->n_run; k++)
            if (strcmp(c->run[i].id, c->run[k].id) == 0)
                return document_fail(
                    &c->doc, json_get(c->doc.root, "axes"), e,
                    "%s and %s are the same run: their labels differ, their settings do not",
                    chart_labels(c, &c->run[i], NULL, 0, true, a, sizeof a),
                    chart_labels(c, &c->run[k], NULL, 0, true, b, sizeof b));
    return 0;
}

int chart_expand(struct chart *c, const char *const *only, size_t n_only, struct error *e)
{
    double product = 1;
    for (size_t k = 0; k < c->n_axis; k++)
        product *= (double)c->axis[k].n_value;
    if (product > CHART_RUNS_MOST)
        return document_fail(&c->doc, json_get(c->doc.root, "axes"), e,
                             "%.0f runs are too many; a chart has at most %d", product,
                             CHART_RUNS_MOST);
    if (too_many_sets(c, e))
        return -1;
    const size_t all = (size_t)product;
    c->run = calloc(all, sizeof *c->run);
    if (!c->run)
        return error_memory(e, "a chart's runs", all * sizeof *c->run);
    for (size_t i = 0; i < all; i++) {
        struct chart_run *r = &c->run[c->n_run];
        size_t rest = i;
        r->value = calloc(c->n_axis, sizeof *r->value);
        if (!r->value)
            return error_memory(e, "a chart's runs", c->n_axis);
        for (size_t k = c->n_axis; k-- > 0;) {
            r->value[k] = rest % c->axis[k].n_value;
            rest /= c->axis[k].n_value;
        }
        if (is_skipped(c, r)) {
            free(r->value);
            r->value = NULL;
            continue;
        }
        c->n_run++;
        if (make_settings(c, r, e))
            return -1;
    }
    if (c->n_run == 0)
        return document_fail(&c->doc, json_get(c->doc.root, "skip"), e, "all runs are skipped");
    return twins(c, e) || apply_only(c, only, n_only, e) ? -1 : 0;
}

/* -- For people ---------------------------------------------------------------------------------- */

const char *chart_labels(const struct chart *c, const struct chart_run *r, const size_t *axes,
                         size_t n, bool names, char *out, size_t size)
{
    size_t at = 0;
    out[0] = '\0';
    for (size_t i = 0; i < (axes ? n : c->n_axis) && at < size; i++) {
        const size_t k = axes ? axes[i] : i;
        const char *label = c->axis[k].value[r->value[k]].label;
        const int more =
            names ? snprintf(out + at, size - at, "%s%s=%s", at ? " " : "", c->axis[k].name, label)
                  : snprintf(out + at, size - at, "%s%s", at ? " · " : "", label);
        at += more > 0 ? (size_t)more : 0;
    }
    return out;
}
