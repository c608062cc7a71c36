/* cli/info_id.c -- what a name on the command line of `sph info` means: a plugin (by its name or its
 * file), an item, or an item of one kind ("kernel/NAME"); and versions. */
#include "cli/info.h"

#include "base/text.h"

#include <stdlib.h>
#include <string.h>

#define PLUGIN_WORD "plugin"

const char *const info_kind[KIND_COUNT] = {"function", "eos",    "boundary",
                                           "kernel",   "scheme", "exact"};

/* Behind "WORD/", or NULL where the id does not begin so. */
static const char *behind(const char *id, const char *word)
{
    const size_t n = strlen(word);

    return strncmp(id, word, n) == 0 && id[n] == '/' ? id + n + 1 : NULL;
}

bool info_is_path(const char *id)
{
    bool kind = behind(id, PLUGIN_WORD) != NULL;

    for (int k = 0; k < KIND_COUNT; k++)
        kind = kind || behind(id, info_kind[k]);
    return strchr(id, '/') && (!kind || strchr(strchr(id, '/') + 1, '/'));
}

/* "eos.so" and "/a/b/eos.so" mean the plugin of that file. */
bool info_names_plugin(const struct plugin *p, const char *id)
{
    const char *name = behind(id, PLUGIN_WORD);
    const char *base = strrchr(id, '/') ? strrchr(id, '/') + 1 : id;
    const char *own = strrchr(p->path, '/') ? strrchr(p->path, '/') + 1 : p->path;

    if (name && !info_is_path(id))
        return strcmp(p->name, name) == 0;
    if (strchr(id, '/') && !info_is_path(id))
        return false;
    return strcmp(p->name, id) == 0 || strcmp(own, base) == 0;
}

bool info_names_entry(const struct entry *x, const char *id)
{
    const char *name = behind(id, info_kind[x->kind]);

    return strcmp(x->item->name, name ? name : id) == 0;
}

/* With a kind, the names of that kind; else all. Both lists end up in `known`. */
static size_t known_names(const struct registry *r, const char *id, const char **known)
{
    const bool kind = strchr(id, '/') && !info_is_path(id);
    size_t n = 0;

    for (size_t i = 0; i < r->n_entry; i++)
        if (!kind || behind(id, info_kind[r->entry[i].kind]))
            known[n++] = r->entry[i].item->name;
    for (size_t i = 0; i < r->n_plugin; i++)
        if (!kind || behind(id, PLUGIN_WORD))
            known[n++] = r->plugin[i].name;
    return n;
}

int info_unknown(const struct registry *r, const char *id, struct error *e)
{
    const size_t most = r->n_entry + r->n_plugin;
    const char **known = malloc((most + 1) * sizeof(*known));
    const char *name = strrchr(id, '/') ? strrchr(id, '/') + 1 : id;
    char hint[512];

    if (!known)
        return error_memory(e, "names", most * sizeof(*known));
    if (most == 0)
        error_set(e, EXIT_USAGE, "no plugin or item \"%s\": no plugin was found", id);
    else
        error_set(e, EXIT_USAGE, "no plugin or item \"%s\"%s", id,
                  text_suggest(hint, sizeof(hint), name, known, known_names(r, id, known)));
    free(known);
    return -1;
}

/* -- Versions -------- */

bool info_is_version(const char *text)
{
    bool digit = false; /* the character before */

    for (; *text; text++) {
        if (*text == '.' ? !digit : *text < '0' || *text > '9')
            return false;
        digit = *text != '.';
    }
    return digit;
}

/* Steps over a number, of any length, and the dot behind it. */
static const char *number(const char **text, size_t *n)
{
    const char *first = *text + strspn(*text, "0");

    *n = strspn(first, "0123456789");
    *text = first + *n;
    if (**text == '.')
        ++*text;
    else
        *text = "";
    return first;
}

bool info_at_least(const char *version, const char *least)
{
    while (*version || *least) {
        size_t n, m;
        const char *a = number(&version, &n), *b = number(&least, &m);
        const int order = n != m ? (n > m) - (n < m) : strncmp(a, b, n);
        if (order != 0)
            return order > 0;
    }
    return true;
}

bool info_exists(const struct registry *r, const char *id, const char *least)
{
    for (size_t i = 0; i < r->n_plugin; i++)
        if (info_names_plugin(&r->plugin[i], id) &&
            (!least || info_at_least(r->plugin[i].version, least)))
            return true;
    for (size_t i = 0; i < r->n_entry; i++)
        if (info_names_entry(&r->entry[i], id) &&
            (!least || info_at_least(r->plugin[r->entry[i].plugin].version, least)))
            return true;
    return false;
}
