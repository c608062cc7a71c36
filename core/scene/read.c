/* scene/read.c -- particles from a file as a table of named columns: CSV here, HDF5 in
 * read_hdf5.c. Reads the file, touches nothing else. */
#include "scene/read.h"
#include "base/text.h"
#include "scene/read_private.h"
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void table_free(struct table *t)
{
    for (size_t i = 0; i < t->n_column; i++) {
        free(t->column[i].name);
        free(t->column[i].value);
    }
    free(t->column);
    *t = (struct table){0};
}

int table_find(const struct table *t, const char *name)
{
    for (size_t i = 0; i < t->n_column; i++)
        if (!strcmp(t->column[i].name, name))
            return (int)i;
    return -1;
}

double *table_add(struct table *t, const char *name)
{
    struct table_column *grown = realloc(t->column, (t->n_column + 1) * sizeof *grown);
    if (!grown)
        return NULL;
    t->column = grown;
    struct table_column *c = &t->column[t->n_column];
    c->name = text_format("%s", name);
    c->value = calloc(t->n + 1, sizeof *c->value);
    if (!c->name || !c->value) {
        free(c->name);
        free(c->value);
        return NULL;
    }
    t->n_column++;
    return c->value;
}

/* -- CSV ------------------------------------------------------------------------------------- */

struct csv {
    const char *path;
    FILE *file;
    char *line; /* getline's */
    size_t size, number, capacity;
    struct table *t;
    struct error *e;
};

/* The next line that is neither empty nor a comment, without its end; false at the end. */
static bool next_line(struct csv *c)
{
    ssize_t n;
    while ((n = getline(&c->line, &c->size, c->file)) >= 0) {
        c->number++;
        while (n > 0 && strchr("\r\n", c->line[n - 1]) && c->line[n - 1])
            c->line[--n] = '\0';
        if (c->number == 1 && !strncmp(c->line, "\xef\xbb\xbf", 3))
            memmove(c->line, c->line + 3, (size_t)n - 2);
        if (c->line[strspn(c->line, " \t")] && c->line[0] != '#')
            return true;
    }
    return false;
}

/* Cuts the next cell off *rest: without blanks and quotation marks around it. NULL after the
 * last. */
static char *next_cell(char **rest)
{
    char *cell = *rest;
    if (!cell)
        return NULL;
    char *comma = strchr(cell, ',');
    *rest = comma ? comma + 1 : NULL;
    if (comma)
        *comma = '\0';
    cell += strspn(cell, " \t");
    size_t n = strlen(cell);
    while (n && strchr(" \t", cell[n - 1]))
        cell[--n] = '\0';
    if (n >= 2 && cell[0] == '"' && cell[n - 1] == '"') {
        cell[n - 1] = '\0';
        cell++;
    }
    return cell;
}

static int read_header(struct csv *c)
{
    char *rest, *cell;
    if (!next_line(c))
        return error_set(c->e, EXIT_USAGE,
                         "%s: is empty; a line of column names should stand first", c->path);
    rest = c->line;
    while ((cell = next_cell(&rest)) != NULL) {
        size_t column = (size_t)(cell - c->line) + 1;
        char *end;
        if (!cell[0])
            return error_set(c->e, EXIT_USAGE, "%s:%zu:%zu: a column without a name", c->path,
                             c->number, column);
        strtod(cell, &end);
        if (!*end)
            return error_set(
                c->e, EXIT_USAGE,
                "%s:%zu:%zu: %.40s is a number; a line of column names should stand first", c->path,
                c->number, column, cell);
        if (text_invalid_utf8(cell, strlen(cell)) != (size_t)-1)
            return error_set(c->e, EXIT_USAGE, "%s:%zu:%zu: a column's name is not UTF-8", c->path,
                             c->number, column);
        if (table_find(c->t, cell) >= 0)
            return error_set(c->e, EXIT_USAGE,
                             "%s:%zu:%zu: the column \"%.40s\" stands there twice", c->path,
                             c->number, column, cell);
        if (!table_add(c->t, cell))
            return error_memory(c->e, c->path, 0);
    }
    return 0;
}

static int grow(struct csv *c)
{
    size_t capacity = c->capacity ? 2 * c->capacity : 1024;
    for (size_t k = 0; k < c->t->n_column; k++) {
        double *value = realloc(c->t->column[k].value, capacity * sizeof *value);
        if (!value)
            return error_memory(c->e, c->path, capacity * sizeof *value);
        c->t->column[k].value = value;
    }
    c->capacity = capacity;
    return 0;
}

static int read_row(struct csv *c)
{
    char *rest = c->line, *cell;
    size_t k = 0;
    if (c->t->n == c->capacity && grow(c) < 0)
        return -1;
    while ((cell = next_cell(&rest)) != NULL) {
        char *end;
        size_t column = (size_t)(cell - c->line) + 1;
        double value = strtod(cell, &end);
        if (k == c->t->n_column)
            return error_set(c->e, EXIT_USAGE, "%s:%zu:%zu: more cells than the %zu columns",
                             c->path, c->number, column, c->t->n_column);
        if (!cell[0] || *end || !isfinite(value)) {
            bool text = text_invalid_utf8(cell, strlen(cell)) == (size_t)-1;
            return error_set(c->e, EXIT_USAGE,
                             "%s:%zu:%zu: \"%.40s\" in column \"%.40s\" is not a number", c->path,
                             c->number, column, text ? cell : "...", c->t->column[k].name);
        }
        c->t->column[k++].value[c->t->n] = value;
    }
    if (k < c->t->n_column)
        return error_set(c->e, EXIT_USAGE, "%s:%zu: %zu cell%s for %zu columns", c->path, c->number,
                         k, k == 1 ? "" : "s", c->t->n_column);
    c->t->n++;
    return 0;
}

static int read_csv(struct table *t, const char *path, struct error *e)
{
    struct csv c = {.path = path, .t = t, .e = e, .file = fopen(path, "rb")};
    if (!c.file)
        return error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(errno));
    int status = read_header(&c);
    while (!status && next_line(&c))
        status = read_row(&c);
    if (!status && ferror(c.file))
        status = error_set(e, EXIT_USAGE, "%s: cannot be read to its end", path);
    free(c.line);
    fclose(c.file);
    return status;
}

/* -- Either ---------------------------------------------------------------------------------- */

static bool is_hdf5(const char *path)
{
    char magic[8] = "";
    FILE *file = fopen(path, "rb");
    size_t n = file ? fread(magic, 1, sizeof magic, file) : 0;
    if (file)
        fclose(file);
    return n == sizeof magic && !memcmp(magic, "\211HDF\r\n\032\n", sizeof magic);
}

int table_read(struct table *t, const char *path, const char *array, struct error *e)
{
    struct stat about;
    int status;
    *t = (struct table){0};
    if (stat(path, &about) < 0)
        return error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(errno));
    if (S_ISDIR(about.st_mode))
        return error_set(e, EXIT_USAGE, "%s: is a folder; give a file", path);
    if (is_hdf5(path))
        status = table_read_hdf5(t, path, array, e);
    else if (array)
        status = error_set(e, EXIT_USAGE, "%s: is no snapshot, so it has no array \"%.60s\"", path,
                           array);
    else
        status = read_csv(t, path, e);
    if (status < 0)
        table_free(t);
    return status;
}
