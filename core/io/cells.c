/* io/cells.c -- CSV files of texts: reading. */
#include "io/cells.h"

#include "base/text.h"
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CELLS_BYTES ((size_t)64 << 20)

struct reader {
    const char *path, *text;
    size_t n, at, line;
    char **cell; /* of the line that is read */
    size_t n_cell, room;
};

static void drop_cells(struct reader *r)
{
    for (size_t i = 0; i < r->n_cell; i++)
        free(r->cell[i]);
    r->n_cell = 0;
}

static int add_cell(struct reader *r, char *cell, struct error *e)
{
    if (r->n_cell == r->room) {
        char **grown = realloc(r->cell, (2 * r->room + 16) * sizeof *grown);
        if (!grown) {
            free(cell);
            return error_memory(e, r->path, r->room);
        }
        r->cell = grown;
        r->room = 2 * r->room + 16;
    }
    r->cell[r->n_cell++] = cell;
    return 0;
}

/* The cell that begins here, up to its comma or line break. */
static int read_cell(struct reader *r, struct error *e)
{
    char *cell = malloc(r->n - r->at + 1);
    size_t k = 0;
    bool quoted = r->at < r->n && r->text[r->at] == '"';
    if (!cell)
        return error_memory(e, r->path, r->n);
    r->at += quoted;
    for (; r->at < r->n; r->at++) {
        const char here = r->text[r->at];
        if (quoted && here == '"' && (r->at + 1 >= r->n || r->text[r->at + 1] != '"')) {
            quoted = false;
            continue;
        }
        if (!quoted && (here == ',' || here == '\n'))
            break;
        if (quoted && here == '"')
            r->at++;
        if (here == '\n')
            r->line++;
        if (quoted || here != '\r')
            cell[k++] = here;
    }
    cell[k] = '\0';
    if (quoted) {
        free(cell);
        return error_set(e, EXIT_USAGE, "%s:%zu: the text's closing quotation mark is missing",
                         r->path, r->line);
    }
    char *fitted = realloc(cell, k + 1);
    return add_cell(r, fitted ? fitted : cell, e);
}

/* The cells of the next line that is neither empty nor a comment; none at the end. */
static int read_line(struct reader *r, size_t *line, struct error *e)
{
    drop_cells(r);
    while (r->at < r->n &&
           (r->text[r->at] == '#' || r->text[r->at] == '\n' || r->text[r->at] == '\r')) {
        while (r->at < r->n && r->text[r->at] != '\n')
            r->at++;
        r->at += r->at < r->n;
        r->line++;
    }
    *line = r->line;
    while (r->at < r->n) {
        if (read_cell(r, e))
            return -1;
        if (r->at < r->n && r->text[r->at++] == '\n')
            break;
        if (r->at == r->n && r->text[r->n - 1] == ',') /* an empty last cell without a line break */
            return add_cell(r, text_format("%s", ""), e);
    }
    r->line++;
    return 0;
}

static int keep_line(struct cells *t, struct reader *r, size_t line, struct error *e)
{
    const size_t n = t->n_column;
    if (r->n_cell != n)
        return error_set(e, EXIT_USAGE, "%s:%zu: %zu cells; the first line names %zu columns",
                         r->path, line, r->n_cell, n);
    char **cell = realloc(t->cell, (t->n_row + 1) * n * sizeof *cell);
    if (cell)
        t->cell = cell;
    size_t *lines = realloc(t->line, (t->n_row + 1) * sizeof *lines);
    if (lines)
        t->line = lines;
    if (!cell || !lines)
        return error_memory(e, r->path, n);
    memcpy(t->cell + t->n_row * n, r->cell, n * sizeof *cell);
    t->line[t->n_row++] = line;
    r->n_cell = 0;
    return 0;
}

static int read_table(struct cells *t, struct reader *r, struct error *e)
{
    size_t line;
    if (read_line(r, &line, e))
        return -1;
    if (r->n_cell == 0)
        return error_set(e, EXIT_USAGE, "%s: is empty; the first line names its columns", r->path);
    t->name = malloc(r->n_cell * sizeof *t->name);
    if (!t->name)
        return error_memory(e, r->path, r->n_cell);
    memcpy(t->name, r->cell, r->n_cell * sizeof *t->name);
    t->n_column = r->n_cell;
    r->n_cell = 0;
    for (;;) {
        if (read_line(r, &line, e))
            return -1;
        if (r->n_cell == 0)
            return 0;
        if (keep_line(t, r, line, e))
            return -1;
    }
}

int cells_parse(struct cells *t, const char *path, const char *text, size_t n, struct error *e)
{
    struct reader r = {.path = path, .text = text, .n = n, .line = 1};
    *t = (struct cells){0};
    if (memchr(text, '\0', n) || text_invalid_utf8(text, n) != (size_t)-1)
        return error_set(e, EXIT_USAGE, "%s: is no text in UTF-8", path);
    const int status = read_table(t, &r, e);
    drop_cells(&r);
    free(r.cell);
    if (status)
        cells_free(t);
    return status;
}

int cells_read(struct cells *t, const char *path, struct error *e)
{
    *t = (struct cells){0};
    FILE *file = fopen(path, "rbe");
    if (!file)
        return error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(errno));
    char *text = NULL;
    size_t n = 0, got;
    int status = 0;
    do {
        char *grown = realloc(text, n + 65536);
        if (!grown) {
            status = error_memory(e, path, n);
            break;
        }
        text = grown;
        got = fread(text + n, 1, 65536, file);
        n += got;
    } while (got > 0 && n <= CELLS_BYTES);
    if (!status && ferror(file))
        status = error_set(e, EXIT_USAGE, "%s: cannot be read: %s", path, strerror(errno));
    if (!status && n > CELLS_BYTES)
        status = error_set(e, EXIT_USAGE, "%s: is larger than %zu MiB", path, CELLS_BYTES >> 20);
    fclose(file);
    if (!status)
        status = cells_parse(t, path, text, n, e);
    free(text);
    return status;
}

void cells_free(struct cells *t)
{
    for (size_t i = 0; i < t->n_column; i++)
        free(t->name[i]);
    for (size_t i = 0; i < t->n_row * t->n_column; i++)
        free(t->cell[i]);
    free(t->name);
    free(t->cell);
    free(t->line);
    *t = (struct cells){0};
}

size_t cells_column(const struct cells *t, const char *name)
{
    for (size_t i = 0; i < t->n_column; i++)
        if (strcmp(t->name[i], name) == 0)
            return i;
    return (size_t)-1;
}

const char *cells_at(const struct cells *t, size_t row, size_t column)
{
    return t->cell[row * t->n_column + column];
}
