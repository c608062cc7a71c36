/* chart/read_pictures.c -- what a chart file wants drawn, and the results of others beside ours. */
#include "chart/chart.h"

#include "base/text.h"
#include "chart/row.h"
#include "io/cells.h"
#include <stdlib.h>
#include <string.h>

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

/* -- What is along an axis ----------------------------------------------------------------------- */

static bool has_numbers(const struct chart_axis *a)
{
    for (size_t i = 0; i < a->n_value; i++)
        if (!(a->value[i].number > 0))
            return false;
    return true;
}

/* A measure or an axis: where both have the name, what was measured is meant. */
static int read_x(struct chart *c, struct chart_picture *p, struct error *e)
{
    const cJSON *node = json_get(p->node, "x");
    p->x = p->kind == CHART_COST ? "core_seconds" : "particles";
    p->x_axis = SIZE_MAX;
    if (json_string(&c->doc, p->node, "x", false, &p->x, e))
        return -1;
    if (row_is_measure(p->x))
        return 0;
    for (size_t i = 0; i < c->n_axis; i++)
        if (strcmp(c->axis[i].name, p->x) == 0) {
            if (!has_numbers(&c->axis[i]))
                return document_fail(&c->doc, node, e,
                                     "the labels of axis \"%s\" are not all positive numbers",
                                     p->x);
            p->x_axis = i;
            return 0;
        }
    const char *known[ROW_NUMBERS + 1];
    char hint[512];
    const size_t n = row_measures(known);
    return document_fail(&c->doc, node, e, "\"%s\" is neither a measure nor an axis%s", p->x,
                         text_suggest(hint, sizeof hint, p->x, known, n));
}

/* All that is neither one value nor an axis of the map itself would put many runs into one cell. */
static int check_cells(const struct chart *c, const struct chart_picture *p, struct error *e)
{
    for (size_t k = 0; k < c->n_axis; k++) {
        size_t n = 0;
        for (size_t i = 0; i < c->axis[k].n_value; i++)
            n += p->select.has[k][i];
        if (n > 1 && k != p->x_axis && k != p->y_axis)
            return document_fail(&c->doc, p->node, e,
                                 "a cell of the map would hold %zu runs: choose one of axis \"%s\" "
                                 "in \"select\"",
                                 n, c->axis[k].name);
    }
    return 0;
}

static int read_map(struct chart *c, struct chart_picture *p, struct error *e)
{
    const char *x, *y;
    const struct document *d = &c->doc;
    if (json_string(d, p->node, "x", true, &x, e) || json_string(d, p->node, "y", true, &y, e))
        return -1;
    if (json_get(p->node, "series"))
        return document_fail_key(d, json_get(p->node, "series"), e, "a map has no series");
    if (chart_axis_of(c, json_get(p->node, "x"), x, &p->x_axis, e) ||
        chart_axis_of(c, json_get(p->node, "y"), y, &p->y_axis, e))
        return -1;
    if (p->x_axis == p->y_axis)
        return document_fail(d, json_get(p->node, "y"), e, "x and y are the same axis");
    p->x = x;
    return check_cells(c, p, e);
}

static int read_series(struct chart *c, struct chart_picture *p, struct error *e)
{
    const cJSON *list = json_get(p->node, "series"), *item;
    char brief[JSON_BRIEF];
    size_t n;
    if (json_get(p->node, "y"))
        return document_fail_key(&c->doc, json_get(p->node, "y"), e,
                                 "only a map has a \"y\"; here it is the error");
    if (chart_array(c, list, "axes", &n, e))
        return -1;
    p->series = calloc(n + 1, sizeof *p->series);
    if (!p->series)
        return error_memory(e, "a chart", n);
    cJSON_ArrayForEach(item, list)
    {
        if (!cJSON_IsString(item))
            return document_fail(&c->doc, item, e, "%s is no axis's name", json_brief(item, brief));
        if (chart_axis_of(c, item, item->valuestring, &p->series[p->n_series], e))
            return -1;
        for (size_t i = 0; i < p->n_series; i++)
            if (p->series[i] == p->series[p->n_series])
                return document_fail(&c->doc, item, e, "axis \"%s\" stands twice",
                                     item->valuestring);
        p->n_series++;
    }
    return read_x(c, p, e);
}

/* -- Pictures ------------------------------------------------------------------------------------ */

static int read_name(struct chart *c, struct chart_picture *p, struct error *e)
{
    const cJSON *node = json_get(p->node, "name");
    if (json_string(&c->doc, p->node, "name", true, &p->name, e))
        return -1;
    if (p->name[0] == '.' || strchr(p->name, '/'))
        return document_fail(&c->doc, node, e, "\"%s\" is no name of a file without its ending",
                             p->name);
    for (const struct chart_picture *q = c->picture; q < p; q++)
        if (strcmp(q->name, p->name) == 0)
            return document_fail(&c->doc, node, e, "there is a picture \"%s\" already", p->name);
    return 0;
}

static int read_picture(struct chart *c, struct chart_picture *p, struct error *e)
{
    static const char *const keys[] = {"name", "title", "kind", "x", "y", "series", "select"};
    static const char *const kinds[] = {"cost", "convergence", "map"};
    const struct document *d = &c->doc;
    const char *kind = NULL;
    char hint[128];
    size_t k = 0;
    if (json_keys(d, p->node, keys, COUNT(keys), e) || read_name(c, p, e) ||
        json_string(d, p->node, "title", false, &p->title, e) ||
        json_string(d, p->node, "kind", true, &kind, e))
        return -1;
    while (k < COUNT(kinds) && strcmp(kind, kinds[k]) != 0)
        k++;
    if (k == COUNT(kinds))
        return document_fail(d, json_get(p->node, "kind"), e, "\"%s\" is no kind of picture%s",
                             kind, text_suggest(hint, sizeof hint, kind, kinds, COUNT(kinds)));
    p->kind = (enum chart_kind)k;
    p->x_axis = p->y_axis = SIZE_MAX;
    if (chart_read_choice(c, json_get(p->node, "select"), &p->select, e))
        return -1;
    return p->kind == CHART_MAP ? read_map(c, p, e) : read_series(c, p, e);
}

int chart_read_pictures(struct chart *c, struct error *e)
{
    const cJSON *list = json_get(c->doc.root, "charts"), *item;
    size_t n;
    if (chart_array(c, list, "pictures", &n, e))
        return -1;
    c->picture = calloc(n + 1, sizeof *c->picture);
    if (!c->picture)
        return error_memory(e, "a chart", n);
    cJSON_ArrayForEach(item, list)
    {
        struct chart_picture *p = &c->picture[c->n_picture++];
        p->node = item;
        p->title = c->title ? c->title : "";
        if (read_picture(c, p, e))
            return -1;
    }
    return 0;
}

/* -- Peers --------------------------------------------------------------------------------------- */

/* Every cell of a column that we use is a positive number. */
static int check_column(const struct cells *t, size_t column, const char *path, struct error *e)
{
    for (size_t k = 0; k < t->n_row; k++) {
        const char *cell = cells_at(t, k, column);
        if (!(chart_number(cell) > 0))
            return error_set(e, EXIT_USAGE, "%s:%zu: %s: \"%s\" is no positive number", path,
                             t->line[k], t->name[column], cell);
    }
    return 0;
}

static int check_peer(const struct chart *c, const struct cells *t, const char *path,
                      const cJSON *node, struct error *e)
{
    bool used = c->n_picture == 0;
    if (cells_column(t, "error") == (size_t)-1)
        return document_fail(&c->doc, node, e, "%s has no column \"error\"", path);
    if (check_column(t, cells_column(t, "error"), path, e))
        return -1;
    for (size_t i = 0; i < c->n_picture; i++) {
        const struct chart_picture *p = &c->picture[i];
        const size_t column = p->kind == CHART_MAP ? (size_t)-1 : cells_column(t, p->x);
        if (column == (size_t)-1)
            continue;
        used = true;
        if (check_column(t, column, path, e))
            return -1;
    }
    if (!used)
        return document_fail(&c->doc, node, e,
                             "%s has no column that a picture has as its x, as \"%s\"", path,
                             c->picture[0].kind == CHART_MAP ? "core_seconds" : c->picture[0].x);
    return 0;
}

static int read_peer(struct chart *c, const cJSON *node, struct chart_peer *p, struct error *e)
{
    static const char *const keys[] = {"file", "label", "source"};
    const struct document *d = &c->doc;
    const char *file = NULL;
    if (json_keys(d, node, keys, COUNT(keys), e) || json_string(d, node, "file", true, &file, e) ||
        json_string(d, node, "label", true, &p->label, e) ||
        json_string(d, node, "source", false, &p->source, e))
        return -1;
    char *path = document_relative(d, file);
    struct cells *t = calloc(1, sizeof *t);
    struct error inner = {0};
    int status = path && t ? 0 : error_memory(e, "a chart", sizeof *t);
    if (!status && cells_read(t, path, &inner))
        status = document_fail(d, json_get(node, "file"), e, "%s", inner.text);
    if (!status && check_peer(c, t, path, json_get(node, "file"), e))
        status = -1;
    free(path);
    p->table = t;
    return status;
}

int chart_read_peers(struct chart *c, struct error *e)
{
    const cJSON *list = json_get(c->doc.root, "peers"), *item;
    size_t n;
    if (chart_array(c, list, "tables", &n, e))
        return -1;
    c->peer = calloc(n + 1, sizeof *c->peer);
    if (!c->peer)
        return error_memory(e, "a chart", n);
    cJSON_ArrayForEach(item, list) if (read_peer(c, item, &c->peer[c->n_peer++], e)) return -1;
    return 0;
}

void chart_pictures_free(struct chart *c)
{
    for (size_t i = 0; i < c->n_picture; i++) {
        free(c->picture[i].series);
        chart_choice_free(c, &c->picture[i].select);
    }
    free(c->picture);
    for (size_t i = 0; i < c->n_peer; i++) {
        if (c->peer[i].table)
            cells_free(c->peer[i].table);
        free(c->peer[i].table);
    }
    free(c->peer);
    c->picture = NULL;
    c->peer = NULL;
    c->n_picture = c->n_peer = 0;
}
