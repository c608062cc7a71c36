/* base/error.c -- makes the sentences that travel upwards. Touches nothing but the caller's
 * struct. */
#include "base/error.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Copies to a text of fixed size; what does not fit is cut before, not inside, a UTF-8
 * character. */
static void copy_cut(char *to, size_t size, const char *from)
{
    size_t n = strlen(from);

    if (n >= size) {
        n = size - 1;
        while (n > 0 && ((unsigned char)from[n] & 0xC0u) == 0x80u) {
            n--;
        }
    }
    memcpy(to, from, n);
    to[n] = '\0';
}

/* Four bytes more than fit, so that a cut character is seen as such. */
#define ROOM (sizeof(((struct error *)0)->text) + 4)

int error_set(struct error *e, enum exit_code code, const char *format, ...)
{
    char text[ROOM]; /* the arguments may point into e->text */
    va_list args;

    if (!e) {
        return -1;
    }
    va_start(args, format);
    if (vsnprintf(text, sizeof text, format, args) < 0) {
        text[0] = '\0';
    }
    va_end(args);
    e->exit_code = (int)code;
    copy_cut(e->text, sizeof e->text, text);
    return -1;
}

int error_prefix(struct error *e, const char *format, ...)
{
    char text[2 * ROOM];
    va_list args;
    size_t n;

    if (!e || !e->text[0]) { /* that of another rank, which says it itself */
        return -1;
    }
    va_start(args, format);
    if (vsnprintf(text, ROOM, format, args) < 0) {
        text[0] = '\0';
    }
    va_end(args);
    n = strlen(text);
    snprintf(text + n, sizeof text - n, ": %s", e->text);
    copy_cut(e->text, sizeof e->text, text);
    return -1;
}

int error_memory(struct error *e, const char *what, unsigned long long bytes)
{
    return error_set(e, EXIT_RUN, "out of memory: %llu bytes for %s", bytes, what);
}
