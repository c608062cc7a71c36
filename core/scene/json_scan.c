/* scene/json_scan.c -- a scanner for JSON (RFC 8259): cJSON makes the tree, but keeps no places, is
 * lenient where a slip of the pen should be told, and its errors are a pointer without a word. This
 * scanner is run first: it knows every rule, the place of every value, and what people write by
 * mistake. Touches nothing but the text it is given. */
#include "scene/json_scan.h"
#include "base/text.h"
#include "scene/json.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int scan_value(struct scan *s, size_t key, int depth);

void scan_line(const char *text, size_t offset, size_t *line, size_t *column)
{
    size_t l = 1, c = 1;
    for (size_t i = 0; i < offset; i++) {
        if (text[i] == '\n') {
            l++;
            c = 1;
        } else if (((unsigned char)text[i] & 0xc0) != 0x80) {
            c++;
        }
    }
    *line = l;
    *column = c;
}

__attribute__((format(printf, 3, 4))) static int scan_fail(struct scan *s, size_t at,
                                                           const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(s->error, sizeof s->error, format, list);
    va_end(list);
    s->error_at = at;
    return -1;
}

static int peek(const struct scan *s)
{
    return s->at < s->n ? (unsigned char)s->text[s->at] : -1;
}

static void skip_space(struct scan *s)
{
    while (s->at < s->n && s->text[s->at] && strchr(" \t\r\n", s->text[s->at]))
        s->at++;
}

static int push_spot(struct scan *s, size_t value, size_t key)
{
    if (s->n_spot == s->capacity) {
        size_t capacity = s->capacity ? 2 * s->capacity : 64;
        struct spot *grown = realloc(s->spot, capacity * sizeof *grown);
        if (!grown)
            return scan_fail(s, value, "out of memory");
        s->spot = grown;
        s->capacity = capacity;
    }
    s->spot[s->n_spot++] = (struct spot){value, key};
    return 0;
}

/* The text ended inside something that began at `begin`. */
static int fail_end(struct scan *s, const char *what, size_t begin)
{
    size_t line, column;
    scan_line(s->text, begin, &line, &column);
    return scan_fail(s, s->n, "the text ends within the %s that begins in line %zu, column %zu",
                     what, line, column);
}

/* Four hexadecimal digits at `at`, or -1. */
static long scan_hex(const struct scan *s, size_t at)
{
    long value = 0;
    for (size_t i = at; i < at + 4; i++) {
        const char *digits = "0123456789abcdef";
        char c = i < s->n ? s->text[i] : '\0';
        if (c >= 'A' && c <= 'F')
            c = (char)(c - 'A' + 'a');
        const char *found = c ? strchr(digits, c) : NULL;
        if (!found)
            return -1;
        value = 16 * value + (found - digits);
    }
    return value;
}

/* After a backslash at s->at. */
static int scan_escape(struct scan *s)
{
    size_t begin = s->at++;
    int c = peek(s);
    if (c > 0 && strchr("\"\\/bfnrt", c)) {
        s->at++;
        return 0;
    }
    if (c != 'u')
        return scan_fail(s, begin, "unknown escape in a string; a backslash is written \\\\");
    long unit = scan_hex(s, s->at + 1);
    if (unit < 0)
        return scan_fail(s, begin, "\\u is followed by four hexadecimal digits");
    if (unit == 0)
        return scan_fail(s, begin, "\\u0000 cannot stand in a string");
    s->at += 5;
    if (unit >= 0xdc00 && unit <= 0xdfff)
        return scan_fail(s, begin, "the second half of a surrogate pair without its first");
    if (unit >= 0xd800 && unit <= 0xdbff) {
        long low = peek(s) == '\\' && s->at + 1 < s->n && s->text[s->at + 1] == 'u'
                       ? scan_hex(s, s->at + 2)
                       : -1;
        if (low < 0xdc00 || low > 0xdfff)
            return scan_fail(s, begin, "the first half of a surrogate pair without its second");
        s->at += 6;
    }
    return 0;
}

static int scan_string(struct scan *s)
{
    size_t begin = s->at++;
    for (;;) {
        int c = peek(s);
        if (c < 0)
            return fail_end(s, "string", begin);
        if (c == '"') {
            s->at++;
            return 0;
        }
        if (c == '\n' || c == '\r')
            return scan_fail(s, begin, "this string is not closed in its line");
        if (c < 0x20)
            return scan_fail(s, s->at, "control character 0x%02x in a string", (unsigned)c);
        if (c == '\\') {
            if (scan_escape(s) < 0)
                return -1;
        } else {
            s->at++;
        }
    }
}

static size_t scan_digits(struct scan *s)
{
    size_t begin = s->at;
    while (peek(s) >= '0' && peek(s) <= '9')
        s->at++;
    return s->at - begin;
}

static int scan_number(struct scan *s)
{
    size_t begin = s->at;
    char copy[64];
    if (peek(s) == '-')
        s->at++;
    size_t integer = s->at;
    if (!scan_digits(s))
        return scan_fail(s, begin, "a number begins with a digit, or with \"-\" and a digit");
    if (s->text[integer] == '0' && s->at > integer + 1)
        return scan_fail(s, begin, "a number does not begin with 0 and another digit");
    if (peek(s) == '.') {
        s->at++;
        if (!scan_digits(s))
            return scan_fail(s, begin, "digits are missing behind the decimal point");
    }
    if (peek(s) == 'e' || peek(s) == 'E') {
        s->at++;
        if (peek(s) == '+' || peek(s) == '-')
            s->at++;
        if (!scan_digits(s))
            return scan_fail(s, begin, "the exponent's digits are missing");
    }
    size_t length = s->at - begin;
    if (length >= sizeof copy) /* cJSON cuts there without a word */
        return scan_fail(s, begin, "a number of %zu characters; give at most %zu", length,
                         sizeof copy - 1);
    memcpy(copy, s->text + begin, length);
    copy[length] = '\0';
    if (!isfinite(strtod(copy, NULL)))
        return scan_fail(s, begin, "%s is too large for a number; give a finite one", copy);
    return 0;
}

/* true, false, null; and what people write instead of JSON. */
static int scan_word(struct scan *s)
{
    static const char *const known[] = {"true", "false", "null"};
    size_t begin = s->at;
    char word[32];
    size_t n = 0;
    while (s->at < s->n && n < sizeof word - 1) {
        char c = s->text[s->at];
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (n && c == '-')))
            break;
        word[n++] = c;
        s->at++;
    }
    word[n] = '\0';
    for (size_t i = 0; i < 3; i++)
        if (!strcmp(word, known[i]))
            return 0;
    static const char *const not_finite[] = {"nan", "NaN", "NAN",      "inf",
                                             "Inf", "INF", "Infinity", "infinity"};
    for (size_t i = 0; i < sizeof not_finite / sizeof *not_finite; i++)
        if (!strcmp(word, not_finite[i]))
            return scan_fail(s, begin, "%s is not a number; give a finite one", word);
    char hint[128];
    return scan_fail(s, begin, "unknown word \"%s\"%s; text is put in double quotes", word,
                     text_nearest(word, known, 3) ? text_suggest(hint, sizeof hint, word, known, 3)
                                                  : "");
}

static int scan_other(struct scan *s)
{
    int c = peek(s);
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_')
        return scan_word(s);
    if (c == '\'')
        return scan_fail(s, s->at, "text is put in double quotes");
    if (c == '/' || c == '#')
        return scan_fail(s, s->at, "JSON has no comments; use a key that begins with \"//\"");
    if (c == ',' || c == ']' || c == '}' || c == ':')
        return scan_fail(s, s->at, "a value is missing before \"%c\"", c);
    if (c > 0x20 && c < 0x7f)
        return scan_fail(s, s->at, "unexpected \"%c\"; a value should stand here", c);
    return scan_fail(s, s->at, "unexpected character; a value should stand here");
}

static int scan_array(struct scan *s, int depth)
{
    size_t begin = s->at++;
    skip_space(s);
    if (peek(s) == ']') {
        s->at++;
        return 0;
    }
    for (;;) {
        skip_space(s);
        if (peek(s) < 0)
            return fail_end(s, "array", begin);
        if (scan_value(s, s->at, depth + 1) < 0)
            return -1;
        skip_space(s);
        int c = peek(s);
        if (c < 0)
            return fail_end(s, "array", begin);
        if (c != ',' && c != ']')
            return scan_fail(s, s->at, "\",\" or \"]\" is missing here");
        s->at++;
        if (c == ']')
            return 0;
    }
}

static int scan_member(struct scan *s, size_t begin, int depth)
{
    skip_space(s);
    size_t key = s->at;
    if (peek(s) < 0)
        return fail_end(s, "object", begin);
    if (peek(s) == '}')
        return scan_fail(s, s->at, "a comma before the closing \"}\"");
    if (peek(s) == '/' || peek(s) == '#')
        return scan_other(s);
    if (peek(s) != '"')
        return scan_fail(s, s->at, "a key in double quotes should stand here");
    if (scan_string(s) < 0)
        return -1;
    skip_space(s);
    if (peek(s) < 0)
        return fail_end(s, "object", begin);
    if (peek(s) != ':')
        return scan_fail(s, s->at, "\":\" is missing behind the key");
    s->at++;
    skip_space(s);
    if (peek(s) < 0)
        return fail_end(s, "object", begin);
    return scan_value(s, key, depth + 1);
}

static int scan_object(struct scan *s, int depth)
{
    size_t begin = s->at++;
    skip_space(s);
    if (peek(s) == '}') {
        s->at++;
        return 0;
    }
    for (;;) {
        if (scan_member(s, begin, depth) < 0)
            return -1;
        skip_space(s);
        int c = peek(s);
        if (c < 0)
            return fail_end(s, "object", begin);
        if (c != ',' && c != '}')
            return scan_fail(s, s->at, "\",\" or \"}\" is missing here");
        s->at++;
        if (c == '}')
            return 0;
    }
}

static int scan_value(struct scan *s, size_t key, int depth)
{
    if (depth > DOCUMENT_DEPTH)
        return scan_fail(s, s->at, "nested deeper than %d", DOCUMENT_DEPTH);
    if (push_spot(s, s->at, key) < 0)
        return -1;
    int c = peek(s);
    if (c == '{')
        return scan_object(s, depth);
    if (c == '[')
        return scan_array(s, depth);
    if (c == '"')
        return scan_string(s);
    if (c >= '0' && c <= '9')
        return scan_number(s);
    if (c == '-') {
        char next = s->at + 1 < s->n ? s->text[s->at + 1] : '\0';
        if (next == 'I' || next == 'i' || next == 'N' || next == 'n') {
            s->at++;
            return scan_word(s);
        }
        return scan_number(s);
    }
    return scan_other(s);
}

int scan_text(struct scan *s, const char *text, size_t n)
{
    *s = (struct scan){.text = text, .n = n};
    size_t bad = text_invalid_utf8(text, n);
    if (bad != (size_t)-1)
        return scan_fail(s, bad, "byte 0x%02x is not UTF-8", (unsigned)(unsigned char)text[bad]);
    if (n >= 3 && !memcmp(text, "\xef\xbb\xbf", 3))
        s->at = 3;
    skip_space(s);
    if (s->at == n)
        return scan_fail(s, n, "the text is empty");
    if (scan_value(s, s->at, 1) < 0)
        return -1;
    skip_space(s);
    if (s->at < n)
        return scan_fail(s, s->at, "something stands behind the end");
    return 0;
}

void scan_fini(struct scan *s)
{
    free(s->spot);
    *s = (struct scan){0};
}
