/* cli/template.h -- copies a folder of templates, with words replaced in the files and in their
 * names. */
#ifndef CLI_TEMPLATE_H
#define CLI_TEMPLATE_H

#include "base/error.h"

#include <stddef.h>

/* `from` is replaced by `to` wherever it stands. */
struct template_word {
    const char *from, *to;
};

/* Copies every file of the folder `from`, which holds no other folders, into `to`. A file that is
 * there already is continued: so several templates make one project. "gitignore" becomes
 * ".gitignore", and a file that begins with #! becomes executable. [main] */
int template_copy(const char *from, const char *to, const struct template_word *words, size_t n,
                  struct error *e);

/* The names of the C headers in a folder of templates, replaced likewise, sorted, with a blank
 * between, in fresh memory; NULL after an error. [main] */
char *template_headers(const char *from, const struct template_word *words, size_t n,
                       struct error *e);

#endif
