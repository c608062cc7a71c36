/* base/text.c -- small helpers on strings. Touches only what it is handed. */
#include "base/text.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MAX 128 /* nobody mistypes a longer word by a third */

static size_t min_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Edits that turn a into b: insert, delete, replace, swap two neighbours (Damerau-Levenshtein in
 * its restricted form: no part is edited twice). Three rows of the table suffice. */
static size_t distance(const char *a, size_t na, const char *b, size_t nb)
{
    size_t table[3][WORD_MAX + 1];
    size_t *before = table[0], *above = table[1], *row = table[2];

    for (size_t j = 0; j <= nb; j++) {
        before[j] = 0;
        above[j] = j;
    }
    for (size_t i = 1; i <= na; i++) {
        row[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            size_t d = above[j - 1] + (a[i - 1] != b[j - 1]);

            d = min_size(d, min_size(above[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                d = min_size(d, before[j - 2] + 1);
            }
            row[j] = d;
        }
        size_t *spare = before;

        before = above;
        above = row;
        row = spare;
    }
    return above[nb];
}

const char *text_nearest(const char *word, const char *const *known, size_t n)
{
    size_t length = strlen(word), best = (length + 2) / 3;
    const char *nearest = NULL;

    if (length > WORD_MAX) {
        return NULL;
    }
    for (size_t k = 0; k < n; k++) {
        size_t other = strlen(known[k]), d;

        if (other > WORD_MAX) {
            continue;
        }
        d = distance(word, length, known[k], other);
        if (d < best || (d == best && !nearest)) {
            best = d;
            nearest = known[k];
        }
    }
    return nearest;
}

const char *text_suggest(char *out, size_t size, const char *word, const char *const *known,
                         size_t n)
{
    static const char intro[] = "; known are: ", more[] = ", ...";
    const char *nearest = text_nearest(word, known, n);
    size_t used, whole = sizeof intro;

    if (size == 0) {
        return out;
    }
    out[0] = '\0';
    if (nearest) {
        int need = snprintf(out, size, " (did you mean \"%s\"?)", nearest);

        if (need < 0 || (size_t)need >= size) {
            out[0] = '\0'; /* half a suggestion is worse than none */
        }
        return out;
    }
    if (n == 0) {
        return out;
    }
    for (size_t k = 0; k < n; k++) {
        whole += strlen(known[k]) + (k > 0 ? 2 : 0);
    }
    used = (size_t)snprintf(out, size, "%s", intro);
    for (size_t k = 0; k < n; k++) {
        size_t need = strlen(known[k]) + (k > 0 ? 2 : 0);

        /* Room for this one, and for cutting the list after it. */
        if (whole > size && used + need + sizeof more > size) {
            /* With the first name cut off there is no list at all. */
            snprintf(k > 0 ? out + used : out, k > 0 ? size - used : size, "%s", k > 0 ? more : "");
            return out;
        }
        used += (size_t)snprintf(out + used, size - used, "%s%s", k > 0 ? ", " : "", known[k]);
    }
    return out;
}

char *text_format(const char *format, ...)
{
    va_list args, again;
    char *text = NULL;
    int need;

    va_start(args, format);
    va_copy(again, args);
    need = vsnprintf(NULL, 0, format, args);
    if (need >= 0) {
        text = malloc((size_t)need + 1);
    }
    if (text) {
        vsnprintf(text, (size_t)need + 1, format, again);
    }
    va_end(again);
    va_end(args);
    return text;
}

/* Bytes of the UTF-8 character at s, of which n bytes are there; 0 if it is not one. */
static size_t utf8_character(const unsigned char *s, size_t n)
{
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    uint32_t code;
    size_t length;

    if (s[0] < 0x80) {
        return 1;
    }
    if (s[0] < 0xC0) {
        return 0;
    }
    length = s[0] < 0xE0 ? 2 : s[0] < 0xF0 ? 3 : s[0] < 0xF8 ? 4 : 0;
    if (length == 0 || length > n) {
        return 0;
    }
    code = s[0] & (0x7Fu >> length);
    for (size_t k = 1; k < length; k++) {
        if ((s[k] & 0xC0u) != 0x80u) {
            return 0;
        }
        code = code << 6 | (s[k] & 0x3Fu);
    }
    /* Too long a form, half a surrogate pair, or beyond the last code point. */
    if (code < least[length] || (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF) {
        return 0;
    }
    return length;
}

size_t text_invalid_utf8(const char *s, size_t n)
{
    const unsigned char *u = (const unsigned char *)s;
    size_t i = 0;

    while (i < n) {
        size_t length = utf8_character(u + i, n - i);

        if (length == 0) {
            return i;
        }
        i += length;
    }
    return (size_t)-1;
}

char *text_join(const char *const *part)
{
    size_t bytes = 1;
    for (size_t k = 0; part[k]; k++)
        bytes += strlen(part[k]);
    char *text = malloc(bytes);
    if (text)
        *text = '\0';
    for (size_t k = 0; text && part[k]; k++)
        strcat(text, part[k]);
    return text;
}

void text_one_line(char *s)
{
    size_t bad;

    while ((bad = text_invalid_utf8(s, strlen(s))) != (size_t)-1)
        s[bad] = '?';
    for (; *s; s++)
        if ((unsigned char)*s < 0x20 || *s == 0x7f)
            *s = '?';
}

void text_put_cell(FILE *f, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, f);
        return;
    }
    putc('"', f);
    for (; *text; text++) {
        if (*text == '"')
            putc('"', f);
        putc(*text, f);
    }
    putc('"', f);
}
