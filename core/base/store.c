/* base/store.c -- see store.h: names put together, memory made, sizes checked. */
#include "base/store.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH 256

size_t store_size(enum store_type type)
{
    static const size_t size[] = {1, 2, 4, 8, 4, 8, 4, 8};
    return size[type];
}

void store_enter(struct store *s, const char *name, size_t index)
{
    const size_t n = strlen(s->group);
    snprintf(s->group + n, sizeof s->group - n, "%s%zu/", name, index);
}

void store_leave(struct store *s)
{
    size_t n = strlen(s->group);
    if (n > 0)
        s->group[--n] = '\0';
    while (n > 0 && s->group[n - 1] != '/')
        s->group[--n] = '\0';
}

static const char *full(const struct store *s, const char *name, char out[PATH])
{
    snprintf(out, PATH, "%s%s", s->group, name);
    return out;
}

int store_block(struct store *s, const char *name, enum store_type type, void *data, size_t n,
                struct error *e)
{
    char path[PATH];
    return s->block(s, full(s, name, path), type, data, n, e);
}

int store_piece(struct store *s, const char *name, enum store_type type, void *data, size_t first,
                size_t n, struct error *e)
{
    char path[PATH];
    return s->piece(s, full(s, name, path), type, data, first, n, e);
}

bool store_has(struct store *s, const char *name)
{
    char path[PATH];
    return s->count(s, full(s, name, path)) != SIZE_MAX;
}

/* Pointers to what differs in type are alike in form, but not in the language's eyes. */
static void *pointer_get(const void *at)
{
    void *p;
    memcpy(&p, at, sizeof p);
    return p;
}

int store_array(struct store *s, const char *name, enum store_type type, void *data, size_t *n,
                size_t spare, struct error *e)
{
    char path[PATH];
    void *at = pointer_get(data);
    full(s, name, path);
    if (s->reading) {
        const size_t found = s->count(s, path), size = store_size(type);
        if (found == SIZE_MAX || found > SIZE_MAX / 16 - spare)
            return store_broken(s, e, "%s is missing", path);
        free(at);
        at = calloc(found + spare + 1, size);
        memcpy(data, &at, sizeof at);
        *n = at ? found : 0;
        if (!at)
            return error_memory(e, path, found * size);
    }
    return s->block(s, path, type, at, *n, e);
}

int store_text(struct store *s, const char *name, char **text, struct error *e)
{
    size_t n = *text && !s->reading ? strlen(*text) : 0;
    if (s->reading && !store_has(s, name)) {
        free(*text);
        *text = NULL;
        return 0;
    }
    if (!s->reading && !*text)
        return 0;
    return store_array(s, name, STORE_U8, text, &n, 1, e); /* the spare one ends it */
}

int store_flags(struct store *s, const char *name, bool *flag, size_t n, struct error *e)
{
    uint8_t *byte = calloc(n + 1, 1);
    if (!byte)
        return error_memory(e, name, n);
    for (size_t i = 0; i < n; i++)
        byte[i] = flag[i];
    const int status = store_block(s, name, STORE_U8, byte, n, e);
    for (size_t i = 0; !status && s->reading && i < n; i++)
        flag[i] = byte[i] != 0;
    free(byte);
    return status;
}

int store_count(struct store *s, const char *name, size_t *value, struct error *e)
{
    uint64_t wide = *value;
    const int status = store_block(s, name, STORE_U64, &wide, 1, e);
    *value = (size_t)wide;
    return status;
}

int store_u64(struct store *s, const char *name, uint64_t *value, struct error *e)
{
    return store_block(s, name, STORE_U64, value, 1, e);
}

int store_f64(struct store *s, const char *name, double *value, struct error *e)
{
    return store_block(s, name, STORE_F64, value, 1, e);
}

int store_broken(const struct store *s, struct error *e, const char *format, ...)
{
    char why[512];
    va_list list;
    va_start(list, format);
    vsnprintf(why, sizeof why, format, list);
    va_end(list);
    return error_set(e, EXIT_USAGE, "%s is a broken checkpoint: %s", s->shown, why);
}
