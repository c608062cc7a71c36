/* check/check_declared.c -- the check `declared`: what the loader has looked at already, and advice
 * on what is left unsaid. Reads descriptors, calls nothing. */
#include "check/checks.h"

#include <math.h>
#include <string.h>

#define LONG_DOC 160

/* The first of a list without a doc, or NULL. */
static const char *undocumented(const sph_item *item)
{
    const sph_param *param = item->params.data;
    const sph_prop *prop = item->props.data;

    for (uint32_t i = 0; i < item->params.count; i++)
        if (!param[i].doc[0])
            return param[i].name;
    for (uint32_t i = 0; i < item->props.count; i++)
        if (!prop[i].doc[0])
            return prop[i].name;
    return NULL;
}

/* "" is a pure number; that all of several are is seldom meant. */
static bool no_units(const sph_item *item)
{
    const sph_prop *prop = item->props.data;

    for (uint32_t i = 0; i < item->props.count; i++)
        if (prop[i].unit[0])
            return false;
    return item->props.count > 1;
}

static void advise(const struct subject *s)
{
    const sph_item *item = s->entry->item;
    const bool physics = s->entry->kind != KIND_SCHEME && s->entry->kind != KIND_BOUNDARY;
    const char *name = undocumented(item);

    if (physics && !item->source[0])
        say(s, VERDICT_NOTE, "source is missing: say which paper and equation");
    if (name)
        say(s, VERDICT_NOTE, "doc of \"%s\" is missing", name);
    if (no_units(item))
        say(s, VERDICT_NOTE, "no property has a unit");
    if (item->doc[0] == ' ' || item->doc[strlen(item->doc) - 1] == ' ')
        say(s, VERDICT_NOTE, "doc begins or ends with a space");
    if (strlen(item->doc) > LONG_DOC)
        say(s, VERDICT_NOTE, "doc is longer than a sentence (%zu bytes)", strlen(item->doc));
}

/* What the other checks put where nothing is given. */
static void say_invented(const struct subject *s)
{
    const sph_param *p = s->entry->item->params.data;

    for (uint32_t i = 0; i < s->entry->item->params.count; i++)
        if (isnan(p[i].def) && p[i].type == SPH_PARAM_NUMBER && !subject_setting(s, p[i].name))
            say(s, VERDICT_NOTE,
                "parameter %s has no default: %g is taken here (--set %s.%s=VALUE chooses another)",
                p[i].name, subject_invented(&p[i]), s->entry->item->name, p[i].name);
}

void check_declared(const struct subject *s)
{
    const sph_item *item = s->entry->item;

    say(s, VERDICT_OK, "descriptor keeps the rules; parameters: %u, properties: %u",
        item->params.count, item->props.count);
    advise(s);
    say_invented(s);
}
