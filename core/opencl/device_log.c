/* opencl/device_log.c -- reads logs of compilers (see device_log.h). All of today's come from clang, yet each
 * driver prints in its own way:
 *     error: FILE:LINE:COLUMN: MESSAGE        pocl
 *     FILE:LINE:COLUMN: error: MESSAGE        clang itself, AMD; for what no `#line` names, a file of theirs
 *     <kernel>:LINE:COLUMN: error: MESSAGE    NVIDIA, whatever file `#line` names; the source's line follows
 *     FILE(LINE): error: MESSAGE              older ones
 */
#include "config.h"

#include "opencl/device_log.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A piece of a text. */
struct piece {
    const char *at;
    size_t n;
};

static struct piece line_at(const char *s)
{
    return (struct piece){s, strcspn(s, "\n")};
}

static const char *next_line(const char *s)
{
    s += strcspn(s, "\n");
    return *s ? s + 1 : s;
}

static struct piece trimmed(struct piece p)
{
    while (p.n > 0 && isspace((unsigned char)p.at[0]))
        p = (struct piece){p.at + 1, p.n - 1};
    while (p.n > 0 && isspace((unsigned char)p.at[p.n - 1]))
        p.n--;
    return p;
}

static bool same(struct piece a, struct piece b)
{
    a = trimmed(a);
    b = trimmed(b);
    return a.n == b.n && memcmp(a.at, b.at, a.n) == 0;
}

static void copy(char *out, size_t size, struct piece p)
{
    snprintf(out, size, "%.*s", (int)p.n, p.at);
}

/* -- The source -------- */

/* Walks the lines of a source with the numbers that `#line` gives them. */
struct walk {
    const char *next;
    struct piece line, file; /* file: empty before the first `#line` */
    unsigned long number, physical;
};

/* `#line NUMBER "FILE"`; the next line has that number. */
static bool directive(struct walk *w)
{
    const char *at = w->line.at, *const end = at + w->line.n;
    char *after;

    if (w->line.n < 7 || strncmp(at, "#line ", 6) != 0)
        return false;
    w->number = strtoul(at + 6, &after, 10) - 1;
    at = memchr(after, '"', after < end ? (size_t)(end - after) : 0);
    if (at) {
        const char *const close = memchr(at + 1, '"', (size_t)(end - at - 1));
        if (close)
            w->file = (struct piece){at + 1, (size_t)(close - at - 1)};
    }
    return true;
}

/* The next line that is no directive. */
static bool step(struct walk *w)
{
    while (*w->next) {
        w->line = line_at(w->next);
        w->next = next_line(w->next);
        w->physical++;
        if (!directive(w)) {
            w->number++;
            return true;
        }
    }
    return false;
}

static bool names_file(const char *text, struct piece file)
{
    struct walk w = {.next = text};

    while (step(&w))
        if (w.file.n == file.n && file.n > 0 && memcmp(w.file.at, file.at, file.n) == 0)
            return true;
    return false;
}

/* How well a line of the source fits what the driver says where it has a file name of its own: it may count
 * as `#line` does or not. The line it quotes decides, unless that is a macro's. */
static int fitness(const struct walk *w, unsigned long line, struct piece quoted)
{
    const int alike = quoted.n > 0 && same(w->line, quoted) ? 2 : 0;

    if (w->physical == line)
        return 2 + alike;
    return w->number == line ? 1 + alike : 0;
}

static void find_line(const char *text, unsigned long line, struct piece quoted,
                      struct device_complaint *out)
{
    struct walk w = {.next = text};
    int best = 0;

    while (step(&w)) {
        const int fit = fitness(&w, line, quoted);
        if (fit <= best)
            continue;
        best = fit;
        copy(out->file, sizeof(out->file), w.file);
        out->line = w.number;
    }
}

/* -- The log -------- */

/* Takes a number off the end of p, and what stands before it; 0: there is none. */
static unsigned long take_number(struct piece *p, char before)
{
    size_t n = p->n;

    while (n > 0 && isdigit((unsigned char)p->at[n - 1]))
        n--;
    if (n == p->n || n == 0 || p->at[n - 1] != before)
        return 0;
    const unsigned long number = strtoul(p->at + n, NULL, 10);
    p->n = n - 1;
    return number;
}

/* "FILE:LINE:COLUMN", "FILE:LINE" or "FILE(LINE)"; leaves FILE. */
static unsigned long take_line(struct piece *place)
{
    unsigned long first, second;

    if (place->n > 0 && place->at[place->n - 1] == ')') {
        place->n--;
        return take_number(place, '(');
    }
    first = take_number(place, ':');
    second = first ? take_number(place, ':') : 0;
    return second ? second : first;
}

/* Where `word` stands in the piece, or NULL. */
static const char *find(struct piece p, const char *word)
{
    const size_t n = strlen(word);

    for (size_t i = 0; i + n <= p.n; i++)
        if (memcmp(p.at + i, word, n) == 0)
            return p.at + i;
    return NULL;
}

/* Takes an error apart; false: the line is none. */
static bool take_apart(struct piece line, struct piece *place, struct piece *message)
{
    const char *const word = find(line, "error");
    const char *const end = line.at + line.n;
    const char *colon, *close, *after = word ? word + 5 : NULL;

    while (word && after < end && *after == ' ')
        after++;
    if (!word || after == end || *after != ':')
        return false;
    *place = (struct piece){line.at, (size_t)(word - line.at)};
    *message = (struct piece){word + 5, (size_t)(end - word - 5)};
    while (message->n > 0 && (message->at[0] == ':' || message->at[0] == ' '))
        *message = (struct piece){message->at + 1, message->n - 1};
    if (word > line.at) { /* "PLACE: error: ", "PLACE: fatal error: " */
        colon = find(*place, ": ");
        place->n = colon ? (size_t)(colon - line.at) : 0;
        return true;
    }
    colon = find(*message, ": ");
    close = find(*message, " <Spelling="); /* a macro's place */
    if (!colon)
        return true;
    *place = (struct piece){message->at, (size_t)(colon - message->at)};
    if (close && close < colon)
        place->n = (size_t)(close - message->at);
    *message = (struct piece){colon + 2, (size_t)(end - colon - 2)};
    return true;
}

bool device_log_read(const char *text, const char *log, struct device_complaint *out)
{
    struct piece place, message;

    memset(out, 0, sizeof(*out));
    for (; *log; log = next_line(log)) {
        if (!take_apart(line_at(log), &place, &message))
            continue;
        copy(out->message, sizeof(out->message), trimmed(message));
        out->line = take_line(&place);
        if (out->line > 0 && names_file(text, place))
            copy(out->file, sizeof(out->file), place);
        else if (out->line > 0)
            find_line(text, out->line, trimmed(line_at(next_line(log))), out);
        return true;
    }
    return false;
}
