/* check/subject.c -- the item that is checked, its parameters, and its verdicts (see subject.h).
 * Writes to the pipe of the child and to the shared stage. */
#include "check/subject.h"

#include "base/text.h"
#include "registry/check.h"
#include "scene/json.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *const subject_kind[KIND_COUNT] = {"function", "eos",    "boundary",
                                              "kernel",   "scheme", "exact"};

void say(const struct subject *s, enum verdict v, const char *format, ...)
{
    char line[1200];
    size_t n = 1;
    va_list list;

    line[0] = "KFN"[v];
    va_start(list, format);
    vsnprintf(line + n, sizeof(line) - 1 - n, format, list);
    va_end(list);
    n = strlen(line);
    for (size_t i = 0; i < n; i++)
        if (line[i] == '\n')
            line[i] = ' ';
    line[n++] = '\n';
    /* A line is shorter than the pipe's promise of one piece; where it fails the parent sees the
     * end. */
    if (write(s->out, line, n) != (ssize_t)n)
        _exit(EXIT_RUN);
}

void stage(const struct subject *s, const char *format, ...)
{
    va_list list;

    va_start(list, format);
    vsnprintf(s->stage->text, sizeof(s->stage->text), format, list);
    va_end(list);
}

bool subject_works_in(const struct subject *s, int dim)
{
    return s->entry->item->dims >> dim & 1u;
}

const char *subject_dims(const struct subject *s, char *out, size_t size)
{
    size_t n = 0;
    int count = 0;

    out[0] = '\0';
    for (int dim = 1; dim <= 3; dim++)
        if (subject_works_in(s, dim) && n < size)
            n += (size_t)snprintf(out + n, size - n, "%s%d", count++ > 0 ? ", " : "", dim);
    if (n < size)
        snprintf(out + n, size - n, " dimension%s", strcmp(out, "1") == 0 ? "" : "s");
    return out;
}

/* -- Values -------- */

double subject_invented(const sph_param *p)
{
    if (p->choices || p->type == SPH_PARAM_TABLE)
        return 0;
    if (!(p->min <= p->max) || (isinf(p->min) && isinf(p->max)))
        return 1;
    if (p->min <= 1 && p->max >= 1)
        return 1;
    if (isinf(p->max))
        return 2 * p->min;
    if (isinf(p->min))
        return p->max < 0 ? 2 * p->max : p->max / 2;
    return p->min > 0 ? sqrt(p->min) * sqrt(p->max) : 0.5 * p->min + 0.5 * p->max;
}

const struct setting *subject_setting(const struct subject *s, const char *name)
{
    for (size_t i = s->n_setting; i-- > 0;) /* the last one holds */
        if (strcmp(s->setting[i].item, s->entry->item->name) == 0 &&
            strcmp(s->setting[i].name, name) == 0)
            return &s->setting[i];
    return NULL;
}

/* A number, or a choice's word; NULL as the second: it is a number. */
static double parsed(const struct setting *s, const char **word)
{
    char *end;
    const double number = strtod(s->value, &end);

    *word = end == s->value || *end ? s->value : NULL;
    return *word ? NAN : number;
}

/* A table, as a scene gives it: the name of a file, or an object of columns. */
static int set_table(struct use *u, const struct setting *s, struct error *e)
{
    struct document d;

    if (document_parse(&d, "--set", "{}", 2, e))
        return -1;
    int status = document_set(&d, s->argument, e);
    if (!status)
        status = use_set_table(u, &d, json_get(json_get(d.root, s->item), s->name), e);
    document_free(&d);
    return status;
}

static int set_chosen(struct use *u, const sph_param *p, const struct setting *s, struct error *e)
{
    const char *word;
    const double number = parsed(s, &word);

    if (p->type == SPH_PARAM_TABLE)
        return set_table(u, s, e);
    if (config_set(&u->config, p->name, number, word, e))
        return error_prefix(e, "--set %s", s->argument);
    return 0;
}

static int set_one(const struct subject *s, struct use *u, const sph_param *p, struct error *e)
{
    const struct setting *chosen = subject_setting(s, p->name);

    if (chosen)
        return set_chosen(u, p, chosen, e);
    if (!isnan(p->def))
        return 0;
    if (p->type == SPH_PARAM_TABLE)
        return error_set(e, EXIT_USAGE,
                         "parameter %s is a table without a default (--set %s.%s=FILE gives one)",
                         p->name, u->item->name, p->name);
    u->config.value[p - (const sph_param *)u->item->params.data] = subject_invented(p);
    return 0;
}

int subject_configure(const struct subject *s, struct use *u, struct error *e)
{
    const sph_item *item = s->entry->item;
    const sph_param *p = item->params.data;

    if (use_init(u, s->entry, item, entry_life(s->entry), e))
        return -1;
    for (uint32_t i = 0; i < item->params.count; i++)
        if (set_one(s, u, &p[i], e)) {
            use_fini(u, s->registry);
            return -1;
        }
    return 0;
}

/* -- Settings -------- */

int setting_parse(struct setting *out, const char *argument, struct error *e)
{
    const char *dot = strchr(argument, '.');
    const char *equals = dot ? strchr(dot, '=') : NULL;
    char *end;

    *out = (struct setting){.argument = argument, .low = NAN, .high = NAN};
    if (!equals || dot == argument || dot - argument >= SUBJECT_WORD || equals - dot < 2 ||
        equals - dot > SUBJECT_WORD || !equals[1])
        return error_set(e, EXIT_USAGE, "--set is ITEM.NAME=VALUE, not \"%s\"", argument);
    memcpy(out->item, argument, (size_t)(dot - argument));
    memcpy(out->name, dot + 1, (size_t)(equals - dot - 1));
    out->value = equals + 1;
    out->low = out->high = strtod(out->value, &end);
    if (*end == ':')
        out->high = strtod(end + 1, &end);
    if (*end || !isfinite(out->low) || !isfinite(out->high) || out->low > out->high)
        out->low = out->high = NAN;
    return 0;
}

static int check_value(const struct entry *x, const sph_param *p, const struct setting *setting,
                       struct error *e)
{
    struct use u;

    if (use_init(&u, x, x->item, NULL, e))
        return -1;
    int status = set_chosen(&u, p, setting, e);
    use_fini(&u, NULL);
    return status;
}

static int check_setting(const struct entry *x, const struct setting *setting, struct error *e)
{
    const sph_param *p = x->item->params.data;
    const sph_prop *prop = x->item->props.data;
    const char *known[64];
    char hint[512];
    size_t n = 0;

    for (uint32_t i = 0; i < x->item->params.count; i++) {
        if (n < 64)
            known[n++] = p[i].name;
        if (strcmp(p[i].name, setting->name) == 0)
            return check_value(x, &p[i], setting, e);
    }
    for (uint32_t i = 0; i < x->item->props.count; i++) {
        if (n < 64)
            known[n++] = prop[i].name;
        if (strcmp(prop[i].name, setting->name) != 0)
            continue;
        return isnan(setting->low)
                   ? error_set(e, EXIT_USAGE,
                               "--set %s: a property's values are a number, or LOW:HIGH",
                               setting->argument)
                   : 0;
    }
    return error_set(e, EXIT_USAGE, "--set %s: %s has no parameter or property \"%s\"%s",
                     setting->argument, setting->item, setting->name,
                     text_suggest(hint, sizeof(hint), setting->name, known, n));
}

int settings_check(const struct registry *r, size_t first, const struct setting *setting, size_t n,
                   struct error *e)
{
    for (size_t i = 0; i < n; i++) {
        bool found = false;
        for (size_t k = 0; k < r->n_entry; k++) {
            const struct entry *x = &r->entry[k];
            if (x->plugin < first || strcmp(x->item->name, setting[i].item) != 0)
                continue;
            found = true;
            if (check_setting(x, &setting[i], e))
                return -1;
        }
        if (!found)
            return error_set(e, EXIT_USAGE, "--set %s: no item that is checked is called \"%s\"",
                             setting[i].argument, setting[i].item);
    }
    return 0;
}
