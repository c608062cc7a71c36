/* cli/template.c -- copies a folder of templates (see template.h). */
#include "config.h"

#include "cli/template.h"

#include "base/text.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* -- Text -------- */

/* The word that stands at s, or NULL. */
static const struct template_word *word_at(const char *s, const struct template_word *words,
                                           size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strncmp(s, words[i].from, strlen(words[i].from)) == 0)
            return &words[i];
    return NULL;
}

/* `text` with its words replaced, in fresh memory; NULL when out of memory. */
static char *replace(const char *text, const struct template_word *words, size_t n)
{
    char *out = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&out, &size);

    while (f && *text) {
        const struct template_word *word = word_at(text, words, n);
        if (word)
            fputs(word->to, f);
        else
            fputc(*text, f);
        text += word ? strlen(word->from) : 1;
    }
    if (f && fclose(f) == 0)
        return out;
    free(out);
    return NULL;
}

/* -- Files -------- */

/* A whole file as text, in fresh memory. */
static char *read_text(const char *path, struct error *e)
{
    char *text = NULL, *line = NULL;
    size_t size = 0, room = 0;
    FILE *in = fopen(path, "r");
    FILE *out = in ? open_memstream(&text, &size) : NULL;
    ssize_t length;

    while (out && (length = getline(&line, &room, in)) > 0)
        fwrite(line, 1, (size_t)length, out);
    const bool good = out && !ferror(in);
    if (!good)
        error_set(e, EXIT_RUN, "the template %s cannot be read: %s", path, strerror(errno));
    free(line);
    if (in)
        fclose(in);
    if (out && fclose(out) != 0 && good)
        error_memory(e, "a template", size);
    else if (good)
        return text;
    free(text);
    return NULL;
}

static int append_text(const char *path, const char *text, struct error *e)
{
    FILE *f = fopen(path, "a");
    bool good = f && fputs(text, f) >= 0;

    if (f && fclose(f) != 0)
        good = false;
    if (good && strncmp(text, "#!", 2) == 0)
        good = chmod(path, 0755) == 0;
    return good ? 0 : error_set(e, EXIT_RUN, "%s cannot be written: %s", path, strerror(errno));
}

static int copy_file(const char *from, const char *to, const struct template_word *words, size_t n,
                     struct error *e)
{
    char *text = read_text(from, e);
    char *replaced = text ? replace(text, words, n) : NULL;
    int status = -1;

    if (replaced)
        status = append_text(to, replaced, e);
    else if (text)
        error_memory(e, "a template", strlen(text));
    free(text);
    free(replaced);
    return status;
}

/* -- Folders -------- */

static int is_named(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

static int is_header(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name);

    return is_named(entry) && n > 2 && strcmp(entry->d_name + n - 2, ".h") == 0;
}

/* The folder's entries, sorted: what is made must not depend on the file system. */
static int scan(const char *folder, int (*filter)(const struct dirent *), struct dirent ***list,
                struct error *e)
{
    const int count = scandir(folder, list, filter, alphasort);

    if (count < 0)
        error_set(e, EXIT_RUN, "the folder of templates %s cannot be read: %s", folder,
                  strerror(errno));
    return count;
}

static int copy_entry(const char *from, const char *to, const char *name,
                      const struct template_word *words, size_t n, struct error *e)
{
    char *new_name =
        strcmp(name, "gitignore") == 0 ? strdup(".gitignore") : replace(name, words, n);
    char *source = text_format("%s/%s", from, name);
    char *target = new_name ? text_format("%s/%s", to, new_name) : NULL;
    int status = -1;

    if (source && target)
        status = copy_file(source, target, words, n, e);
    else
        error_memory(e, "a path", strlen(name));
    free(new_name);
    free(source);
    free(target);
    return status;
}

int template_copy(const char *from, const char *to, const struct template_word *words, size_t n,
                  struct error *e)
{
    struct dirent **list = NULL;
    const int count = scan(from, is_named, &list, e);
    int status = count < 0 ? -1 : 0;

    for (int i = 0; i < count; i++) {
        if (!status)
            status = copy_entry(from, to, list[i]->d_name, words, n, e);
        free(list[i]);
    }
    free(list);
    return status;
}

char *template_headers(const char *from, const struct template_word *words, size_t n,
                       struct error *e)
{
    struct dirent **list = NULL;
    const int count = scan(from, is_header, &list, e);
    char *names = count < 0 ? NULL : strdup("");

    for (int i = 0; i < count; i++) {
        char *longer =
            names ? text_format("%s%s%s", names, i > 0 ? " " : "", list[i]->d_name) : NULL;
        free(names);
        names = longer;
        free(list[i]);
    }
    free(list);
    char *replaced = names ? replace(names, words, n) : NULL;
    if (!replaced && count >= 0)
        error_memory(e, "a list of headers", 0);
    free(names);
    return replaced;
}
