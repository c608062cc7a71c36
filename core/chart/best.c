/* chart/best.c -- chooses among finished runs, and writes a scene with a run's settings. */
#include "config.h"

#include "chart/best.h"

#include "base/text.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SHOWN 6 /* the best and the runners-up */

/* -- The table --------------------------------------------------------------------------------------- */

static double cost_of(const struct results *s, size_t i)
{
    return s->row[i].number[ROW_CORE_SECONDS];
}

/* Indices of the runs that are good enough, by cost; of equal ones the first. */
static size_t choose(const struct results *s, double tolerance, size_t *index)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++) {
        const struct row *r = &s->row[i];
        if (!r->there || r->status != ROW_DONE || !(r->error <= tolerance))
            continue;
        size_t at = n++;
        for (; at > 0 && cost_of(s, index[at - 1]) > cost_of(s, i); at--)
            index[at] = index[at - 1];
        index[at] = i;
    }
    return n;
}

static int none(const struct chart *c, const struct results *s, double tolerance, struct error *e)
{
    char labels[256];
    size_t n = 0, nearest = 0;
    for (size_t i = 0; i < s->n; i++)
        if (s->row[i].there && s->row[i].status == ROW_DONE) {
            if (n == 0 || s->row[i].error < s->row[nearest].error)
                nearest = i;
            n++;
        }
    if (n == 0)
        return error_set(e, EXIT_RUN,
                         "no run of %s has been finished; make them first: sph chart %s",
                         c->doc.path, c->doc.path);
    return error_set(
        e, EXIT_RUN,
        "none of %zu finished runs has an error of at most %g (%s); the nearest has %.4g: %s", n,
        tolerance, c->error.title, s->row[nearest].error,
        chart_labels(c, &c->run[nearest], NULL, 0, true, labels, sizeof labels));
}

/* A word for the shell. */
static void put_word(FILE *out, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-./=:,+";
    if (word[0] && strspn(word, plain) == strlen(word)) {
        fprintf(out, " %s", word);
        return;
    }
    fputs(" '", out);
    for (; *word; word++)
        if (*word == '\'')
            fputs("'\\''", out);
        else
            putc(*word, out);
    putc('\'', out);
}

/* With a scene of its own only the options are left to say. */
static int put_command(const struct chart *c, const struct chart_run *r, const char *scene,
                       FILE *out, struct error *e)
{
    char **argument = chart_arguments(c, r);
    if (!argument)
        return error_memory(e, "a command", 1);
    fputs("sph run", out);
    put_word(out, scene ? scene : argument[0]);
    for (size_t i = 1; argument[i]; i += 2)
        if (!scene || (strcmp(argument[i], "--set") != 0 && strcmp(argument[i], "--load") != 0)) {
            put_word(out, argument[i]);
            put_word(out, argument[i + 1]);
        }
    putc('\n', out);
    chart_arguments_free(argument);
    return 0;
}

int best_print(const struct chart *c, const struct results *s, double tolerance,
               const char *scene_path, FILE *out, size_t *best, struct error *e)
{
    char labels[256];
    size_t *index = calloc(s->n, sizeof *index);
    const size_t n = index ? choose(s, tolerance, index) : 0;
    int status = !index ? error_memory(e, "a table", s->n) : n ? 0 : none(c, s, tolerance, e);
    if (!status) {
        fprintf(out, "%-12s  %-12s  run\n", "core-seconds", "error");
        for (size_t k = 0; k < n && k < SHOWN; k++)
            fprintf(out, "%-12.4g  %-12.4g  %s\n", cost_of(s, index[k]), s->row[index[k]].error,
                    chart_labels(c, &c->run[index[k]], NULL, 0, true, labels, sizeof labels));
        if (n > SHOWN)
            fprintf(out, "and %zu more with an error of at most %g\n", n - SHOWN, tolerance);
        *best = index[0];
        status = put_command(c, &c->run[index[0]], scene_path, out, e);
    }
    free(index);
    return status;
}

/* -- The scene --------------------------------------------------------------------------------------- */

/* A text that names a file beside the scene gets its absolute path, so that the scene may lie anywhere:
 * which keys are files only plugins know. */
static int free_of_folder(struct document *d, cJSON *node, struct error *e)
{
    if (cJSON_IsString(node) && strpbrk(node->valuestring, "./") && node->valuestring[0] != '/') {
        char absolute[PATH_MAX];
        char *path = document_relative(d, node->valuestring);
        if (!path)
            return error_memory(e, "a path", 1);
        const bool found = realpath(path, absolute) != NULL;
        free(path);
        if (found && !cJSON_SetValuestring(node, absolute))
            return error_memory(e, "a path", strlen(absolute));
    }
    for (cJSON *child = node->child; child; child = child->next)
        if (free_of_folder(d, child, e))
            return -1;
    return 0;
}

/* --load is a plugin that the scene names. */
static int add_plugins(const struct chart *c, cJSON *root, struct error *e)
{
    cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "plugins");
    if (!list && c->n_load > 0)
        list = cJSON_AddArrayToObject(root, "plugins");
    for (size_t i = 0; i < c->n_load; i++) {
        char absolute[PATH_MAX];
        const bool path = strchr(c->load[i], '/') && realpath(c->load[i], absolute);
        cJSON *plugin = cJSON_CreateString(path ? absolute : c->load[i]);
        if (!plugin || !cJSON_AddItemToArray(list, plugin)) {
            cJSON_Delete(plugin);
            return error_memory(e, "a scene", 1);
        }
    }
    return 0;
}

char *best_scene(const struct chart *c, const struct chart_run *r, struct error *e)
{
    struct document d;
    if (document_parse(&d, c->scene.path, c->scene.text, c->scene.length, e))
        return NULL;
    char **argument = chart_arguments(c, r), *text = NULL, *line = NULL;
    int status = argument ? 0 : error_memory(e, "a scene", 1);
    for (size_t i = 1; !status && argument[i]; i += 2)
        if (strcmp(argument[i], "--set") == 0)
            status = document_set(&d, argument[i + 1], e);
    if (!status)
        status = free_of_folder(&d, d.root, e) || add_plugins(c, d.root, e);
    if (!status) {
        text = cJSON_Print(d.root);
        line = text ? text_format("%s\n", text) : NULL;
        if (!line)
            error_memory(e, "a scene", 1);
    }
    cJSON_free(text);
    chart_arguments_free(argument);
    document_free(&d);
    return line;
}
