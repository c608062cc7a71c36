/* registry/config.c -- the parameters of one use of an item, checked against its declarations. */
#include "registry/registry.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int config_init(struct sph_config *c, const sph_item *item, struct error *e)
{
    const sph_param *p = item->params.data;
    const size_t n = item->params.count;

    c->item = item;
    c->table = NULL;
    c->value = calloc(n + 1, sizeof(*c->value));
    if (!c->value)
        return error_memory(e, "parameters", n * sizeof(*c->value));
    for (size_t i = 0; i < n; i++)
        c->value[i] = p[i].def;
    return 0;
}

void config_fini(struct sph_config *c)
{
    free(c->value);
    free(c->table);
    c->value = NULL;
    c->table = NULL;
    c->item = NULL;
}

static int unknown(const sph_item *item, const char *name, struct error *e)
{
    const sph_param *p = item->params.data;
    const char **names;
    char hint[512];

    if (item->params.count == 0)
        return error_set(e, EXIT_USAGE, "\"%s\" has no parameters", item->name);
    names = malloc(item->params.count * sizeof(*names));
    if (!names)
        return error_memory(e, "parameters", item->params.count * sizeof(*names));
    for (uint32_t i = 0; i < item->params.count; i++)
        names[i] = p[i].name;
    error_set(e, EXIT_USAGE, "\"%s\" has no parameter \"%s\"%s", item->name, name,
              text_suggest(hint, sizeof(hint), name, names, item->params.count));
    free(names);
    return -1;
}

/* "one|other" -> "one, other" */
static const char *listed(char *out, size_t size, const char *choices)
{
    size_t n = 0;

    for (const char *s = choices; *s && n + 3 < size; s++) {
        out[n++] = *s == '|' ? ',' : *s;
        if (*s == '|')
            out[n++] = ' ';
    }
    out[n] = '\0';
    return out;
}

static int set_choice(double *value, const sph_param *p, const char *word, struct error *e)
{
    char all[512];
    double i = 0;

    for (const char *s = p->choices; word && *s; i++) {
        const size_t n = strcspn(s, "|");
        if (strlen(word) == n && strncmp(s, word, n) == 0) {
            *value = i;
            return 0;
        }
        s += n + (s[n] == '|');
    }
    if (!word)
        return error_set(e, EXIT_USAGE, "%s must be a word, one of %s", p->name,
                         listed(all, sizeof(all), p->choices));
    return error_set(e, EXIT_USAGE, "%s is one of %s, not \"%s\"", p->name,
                     listed(all, sizeof(all), p->choices), word);
}

static int set_number(double *value, const sph_param *p, double number, struct error *e)
{
    if (!isfinite(number))
        return error_set(e, EXIT_USAGE, "%s must be a finite number", p->name);
    if (p->min <= p->max && (number < p->min || number > p->max)) {
        if (isinf(p->max))
            return error_set(e, EXIT_USAGE, "%s must be at least %g, not %g", p->name, p->min,
                             number);
        if (isinf(p->min))
            return error_set(e, EXIT_USAGE, "%s must be at most %g, not %g", p->name, p->max,
                             number);
        return error_set(e, EXIT_USAGE, "%s must lie between %g and %g, not be %g", p->name, p->min,
                         p->max, number);
    }
    *value = number;
    return 0;
}

int config_set(struct sph_config *c, const char *name, double number, const char *word,
               struct error *e)
{
    const sph_param *p = c->item->params.data;

    for (uint32_t i = 0; i < c->item->params.count; i++) {
        if (strcmp(p[i].name, name) != 0)
            continue;
        if (p[i].type == SPH_PARAM_TABLE)
            return error_set(e, EXIT_USAGE, "%s is a table: give a file or an object of columns",
                             name);
        if (p[i].choices)
            return set_choice(&c->value[i], &p[i], word, e);
        if (word)
            return error_set(e, EXIT_USAGE, "%s must be a number, not \"%s\"", name, word);
        return set_number(&c->value[i], &p[i], number, e);
    }
    return unknown(c->item, name, e);
}

int config_set_table(struct sph_config *c, const char *name, const sph_table *table,
                     struct error *e)
{
    const sph_param *p = c->item->params.data;

    if (!c->table)
        c->table = calloc(c->item->params.count + 1, sizeof(*c->table));
    if (!c->table)
        return error_memory(e, "parameters", c->item->params.count * sizeof(*c->table));
    for (uint32_t i = 0; i < c->item->params.count; i++)
        if (p[i].type == SPH_PARAM_TABLE && strcmp(p[i].name, name) == 0) {
            c->table[i] = table;
            c->value[i] = 1.0;
            return 0;
        }
    return unknown(c->item, name, e);
}

int config_check(const struct sph_config *c, struct error *e)
{
    const sph_param *p = c->item->params.data;

    for (uint32_t i = 0; i < c->item->params.count; i++)
        if (isnan(c->value[i]))
            return error_set(e, EXIT_USAGE, "parameter %s of \"%s\" is missing: it has no default",
                             p[i].name, c->item->name);
    return 0;
}
