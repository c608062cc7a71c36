/* base/text.h -- small helpers on strings: the nearest known word, formatted copies, UTF-8. */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The nearest of `known` to `word` (Damerau-Levenshtein distance at most a third of its length,
 * rounded up), or NULL. */
const char *text_nearest(const char *word, const char *const *known, size_t n);

/* Writes " (did you mean \"X\"?)" or, if none is near, "; known are: a, b, c" to out. Returns out. */
const char *text_suggest(char *out, size_t size, const char *word, const char *const *known,
                         size_t n);

/* printf into fresh memory (free it); NULL when out of memory. */
char *text_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Texts one after the other, up to the first NULL, likewise. */
char *text_join(const char *const *part);

/* Replaces what is no printable text, line breaks among it, by question marks. */
void text_one_line(char *s);

/* Offset of the first byte that is not valid UTF-8, or (size_t)-1. */
size_t text_invalid_utf8(const char *s, size_t n);

/* A text as a cell of CSV: quoted where RFC 4180 asks for it. */
void text_put_cell(FILE *f, const char *text);

#endif
