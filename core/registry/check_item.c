/* registry/check_item.c -- the checks that all kinds share: an item's name, dimensions, parameters
 * and properties. Reads host's copies only. */
#include "config.h"

#include "registry/check.h"

#include "base/text.h"
#include "registry/reach.h"
#include <math.h>
#include <string.h>

static bool is_lower(char c)
{
    return c >= 'a' && c <= 'z';
}

static bool is_letter(char c)
{
    return is_lower(c) || (c >= 'A' && c <= 'Z');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool check_is_name(const char *s)
{
    size_t n;

    if (!reach_text(s, CHECK_NAME_MAX + 1) || !is_lower(s[0]))
        return false;
    for (n = 1; n <= CHECK_NAME_MAX && s[n]; n++)
        if (!is_lower(s[n]) && !is_digit(s[n]) && s[n] != '-')
            return false;
    return n <= CHECK_NAME_MAX;
}

bool check_is_word(const char *s, bool dash)
{
    size_t n;

    if (!reach_text(s, CHECK_NAME_MAX + 1) || !is_letter(s[0]))
        return false;
    for (n = 1; n <= CHECK_NAME_MAX && s[n]; n++)
        if (!is_letter(s[n]) && !is_digit(s[n]) && s[n] != '_' && !(dash && s[n] == '-'))
            return false;
    return n <= CHECK_NAME_MAX;
}

bool check_is_text(const char *s)
{
    const bool there = reach_text(s, CHECK_TEXT_MAX + 1);
    const size_t n = there ? strnlen(s, CHECK_TEXT_MAX + 1) : CHECK_TEXT_MAX + 1;

    if (n > CHECK_TEXT_MAX || text_invalid_utf8(s, n) != (size_t)-1)
        return false;
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)s[i] < 0x20 || s[i] == 0x7f)
            return false;
    return true;
}

/* The unit and doc of the thing `what` "name". */
static int check_texts(const char *unit, const char *doc, const char *what, const char *name,
                       struct error *e)
{
    if (!check_is_text(unit) || !check_is_text(doc))
        return error_set(e, EXIT_REFUSED, "%s of %s \"%s\" is not one line of UTF-8 text",
                         check_is_text(unit) ? "doc" : "unit", what, name);
    return 0;
}

/* "one|other": words, each once; their number, or 0. */
static uint32_t count_choices(const char *choices)
{
    uint32_t n = 0;

    if (!check_is_text(choices))
        return 0;
    for (const char *s = choices;; s++) {
        size_t length = strcspn(s, "|");
        if (length == 0 || length > CHECK_NAME_MAX || strcspn(s, " \"") < length)
            return 0;
        for (const char *t = choices; t < s; t += strcspn(t, "|") + 1)
            if (strcspn(t, "|") == length && strncmp(s, t, length) == 0)
                return 0;
        n++;
        s += length;
        if (*s == '\0')
            return n;
    }
}

static int check_param(const sph_param *p, struct error *e)
{
    if (check_texts(p->unit, p->doc, "parameter", p->name, e))
        return -1;
    if (p->type != SPH_PARAM_NUMBER && p->type != SPH_PARAM_TABLE)
        return error_set(e, EXIT_REFUSED, "type of parameter \"%s\" is %u, which is unknown",
                         p->name, p->type);
    if (p->type == SPH_PARAM_TABLE && (p->choices || !(isnan(p->def) || p->def == 0)))
        return error_set(e, EXIT_REFUSED,
                         "parameter \"%s\" is a table: it has no choices, and its default is 0 "
                         "or, if it is mandatory, NaN",
                         p->name);
    if (p->type == SPH_PARAM_TABLE)
        return 0;
    if (p->choices) {
        uint32_t n = count_choices(p->choices);
        if (n == 0)
            return error_set(e, EXIT_REFUSED,
                             "choices of parameter \"%s\" are not different words separated by |",
                             p->name);
        if (!isnan(p->def) && !(p->def >= 0 && p->def < n && p->def == floor(p->def)))
            return error_set(e, EXIT_REFUSED,
                             "default of parameter \"%s\" is %g, but it has choices 0 to %u",
                             p->name, p->def, n - 1);
        return 0;
    }
    if (isnan(p->min) || isnan(p->max))
        return error_set(e, EXIT_REFUSED, "range of parameter \"%s\" is not a number", p->name);
    if (isinf(p->def))
        return error_set(e, EXIT_REFUSED, "default of parameter \"%s\" is infinite", p->name);
    if (p->min <= p->max && (p->def < p->min || p->def > p->max))
        return error_set(e, EXIT_REFUSED,
                         "default of parameter \"%s\" is %g, outside its range %g to %g", p->name,
                         p->def, p->min, p->max);
    return 0;
}

static int check_params(const sph_list *params, struct error *e)
{
    const sph_param *p = params->data;

    for (uint32_t i = 0; i < params->count; i++) {
        if (!check_is_word(p[i].name, true))
            return error_set(e, EXIT_REFUSED, "name of parameter %u is not a word", i);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(p[i].name, p[k].name) == 0)
                return error_set(e, EXIT_REFUSED, "parameter \"%s\" is declared twice", p[i].name);
        if (check_param(&p[i], e))
            return -1;
    }
    return 0;
}

static int check_prop(const sph_prop *p, struct error *e)
{
    const uint32_t sets = p->access & (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN);
    const uint32_t known =
        sets | (p->access & (SPH_DST_READ | SPH_SRC_READ | SPH_WORK | SPH_DST_SWEEP));

    if (p->type < SPH_SCALAR || p->type > SPH_INT64)
        return error_set(e, EXIT_REFUSED, "type of property \"%s\" is %u, which is unknown",
                         p->name, p->type);
    if ((p->access & ~SPH_WORK) == 0)
        return error_set(e, EXIT_REFUSED, "access of property \"%s\" is none", p->name);
    if (p->access != known)
        return error_set(e, EXIT_REFUSED, "access of property \"%s\" has unknown bits (0x%x)",
                         p->name, p->access & ~known);
    if ((p->access & SPH_DST_SWEEP) && (sets || !(p->access & SPH_DST_READ)))
        return error_set(e, EXIT_REFUSED,
                         "access of property \"%s\" is for the sweep alone (SPH_DST_SWEEP), which "
                         "goes with SPH_DST_READ and nothing that sets it",
                         p->name);
    if (sets & (sets - 1))
        return error_set(e, EXIT_REFUSED,
                         "access of property \"%s\" is more than one of write, sum, max and min",
                         p->name);
    /* NaN says that a scene must give the value; a sum cannot start there. */
    if (isnan(p->start) && (sets & (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)))
        return error_set(e, EXIT_REFUSED, "start of property \"%s\" is not a number", p->name);
    return check_texts(p->unit, p->doc, "property", p->name, e);
}

int check_props(const sph_list *props, const char *list, struct error *e)
{
    const sph_prop *p = props->data;

    for (uint32_t i = 0; i < props->count; i++) {
        if (!check_is_word(p[i].name, false))
            return error_set(e, EXIT_REFUSED, "name of %s[%u] is not a word", list, i);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(p[i].name, p[k].name) == 0)
                return error_set(e, EXIT_REFUSED, "property \"%s\" is declared twice in %s",
                                 p[i].name, list);
        if (check_prop(&p[i], e))
            return -1;
    }
    return 0;
}

const sph_prop *check_find_prop(const sph_list *props, const char *name)
{
    const sph_prop *p = props->data;

    for (uint32_t i = 0; i < props->count; i++)
        if (strcmp(p[i].name, name) == 0)
            return &p[i];
    return NULL;
}

int check_item(const sph_item *item, struct error *e)
{
    if (item->dims == 0)
        return error_set(e, EXIT_REFUSED, "dims is 0: it works in no dimension");
    if (item->dims & ~SPH_ALL_DIMS)
        return error_set(e, EXIT_REFUSED, "dims has unknown bits (0x%x)",
                         item->dims & ~SPH_ALL_DIMS);
    if (!check_is_text(item->doc) || item->doc[0] == '\0')
        return error_set(e, EXIT_REFUSED, "doc is missing or not one line of UTF-8 text");
    if (!check_is_text(item->source))
        return error_set(e, EXIT_REFUSED, "source is not one line of UTF-8 text");
    return check_params(&item->params, e) ? -1 : check_props(&item->props, "props", e);
}
