/* scene/fill.c -- an array's fills, one after another: points, then columns. Reads the scene,
 * writes the particles it is given. */
#include "scene/fill.h"
#include "base/text.h"
#include "scene/fill_private.h"
#include "scene/glass.h"
#include "scene/random.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* -- Lattices -------------------------------------------------------------------------------- */

/* Moves a point by up to `jitter` along each axis, but not out of its region. */
static void shake(struct random *random, const struct region *r, double jitter, double x[3])
{
    double y[3] = {0, 0, 0};
    bool within = true;
    for (int c = 0; c < r->dim; c++) {
        y[c] = x[c] + jitter * (2 * random_unit(random) - 1);
        within = within && y[c] >= r->min[c] && y[c] < r->max[c];
    }
    if (within && region_holds(r, y))
        memcpy(x, y, sizeof y);
}

/* Makes the points into q, or, if q is NULL, counts them. */
static int fill_lattice(const struct scene *s, size_t a, size_t k, struct points *q,
                        uint64_t *count, struct error *e)
{
    const struct scene_fill *f = &s->array[a].fill[k];
    struct region r;
    struct grid g;
    struct random random;
    double wanted;
    if (region_init(&r, s, f, e) < 0 || fill_spacing(s, a, k, &r, &wanted, e) < 0 ||
        grid_init(&g, s, f, &r, wanted, e) < 0)
        return -1;
    bool box = !r.shape || shape_is_box(r.shape);
    double total = grid_total(&g), spacing = pow(g.volume, 1. / s->dim);
    /* A shape may hold a small part of its bounds' points, but not so small a part. */
    if (fill_guard(s, f, box ? total : total / 8, e) < 0)
        return -1;
    *count = 0;
    if (!q && box) {
        *count = (uint64_t)total;
        return 0;
    }
    random_init(&random, f->seed);
    for (uint64_t i = 0; i < (uint64_t)total; i++) {
        double x[3];
        grid_point(&g, i, x);
        if (!region_holds(&r, x))
            continue;
        if (++*count > s->limit)
            return fill_guard(s, f, total, e);
        if (q && f->jitter > 0)
            shake(&random, &r, f->jitter * spacing, x);
        if (q && points_add(q, x, spacing, e) < 0)
            return -1;
    }
    if (!*count)
        return document_fail(s->doc, f->node, e,
                             "there are no particles inside this shape at a spacing of %.4g",
                             wanted);
    return 0;
}

/* -- Glasses --------------------------------------------------------------------------------- */

/* A glass fills the region's bounds; the shape is cut out of it. */
static int fill_glass(const struct scene *s, size_t a, size_t k, struct points *q, uint64_t *count,
                      struct error *e)
{
    const struct scene_fill *f = &s->array[a].fill[k];
    struct region r;
    double spacing, bounds = 1;
    if (region_init(&r, s, f, e) < 0 || fill_spacing(s, a, k, &r, &spacing, e) < 0)
        return -1;
    struct glass glass = {.dim = s->dim, .seed = f->seed, .sweeps = f->sweeps, .noise = f->noise};
    for (int c = 0; c < s->dim; c++) {
        glass.min[c] = r.min[c];
        glass.max[c] = r.max[c];
        bounds *= r.max[c] - r.min[c];
        glass.periodic[c] = s->box.bounded && s->box.side[c][0] == SIDE_PERIODIC &&
                            r.min[c] == s->box.min[c] && r.max[c] == s->box.max[c];
    }
    double inside = round(r.volume / pow(spacing, s->dim)),
           total = round(inside * bounds / r.volume);
    if (fill_guard(s, f, total, e) < 0)
        return -1;
    *count = (uint64_t)inside;
    if (!q)
        return 0;
    if (total < 1)
        return document_fail(s->doc, f->node, e,
                             "there are no particles inside this shape at a spacing of %.4g",
                             spacing);
    glass.n = (size_t)total;
    if (glass_make(&glass, e) < 0)
        return -1;
    *f->reached = glass.reached;
    int status = 0;
    spacing = pow(bounds / total, 1. / s->dim);
    for (size_t i = 0; i < glass.n && !status; i++) {
        double x[3] = {0, 0, 0};
        for (int c = 0; c < s->dim; c++)
            x[c] = glass.x[c][i];
        if (region_holds(&r, x))
            status = points_add(q, x, spacing, e);
    }
    glass_free(&glass);
    return status;
}

/* -- Files ----------------------------------------------------------------------------------- */

/* Gives the table's columns the names that the scene has for them. */
static int rename_columns(const struct scene *s, const struct scene_fill *f, struct table *t,
                          struct error *e)
{
    const cJSON *item;
    char hint[512];
    cJSON_ArrayForEach(item, f->rename)
    {
        int c = table_find(t, item->string);
        if (c < 0) {
            const char *known[64];
            size_t n = 0;
            for (; n < t->n_column && n < 64; n++)
                known[n] = t->column[n].name;
            return document_fail_key(s->doc, item, e, "the file has no column \"%.60s\"%s",
                                     item->string,
                                     text_suggest(hint, sizeof hint, item->string, known, n));
        }
        char *name = text_format("%s", item->valuestring);
        if (!name)
            return error_memory(e, "a column's name", 0);
        free(t->column[c].name);
        t->column[c].name = name;
    }
    return 0;
}

static int load_table(const struct scene *s, const struct scene_fill *f, struct table *t,
                      struct error *e)
{
    struct error inner = {0};
    char *path = document_relative(s->doc, f->file);
    if (!path)
        return error_memory(e, "a path", 0);
    int status = table_read(t, path, f->file_array, &inner);
    free(path);
    if (status < 0)
        return document_fail(s->doc, json_get(f->node, "file"), e, "%s", inner.text);
    status = rename_columns(s, f, t, e);
    if (!status && !t->n)
        status = document_fail(s->doc, json_get(f->node, "file"), e, "the file has no particles");
    for (int c = 0; !status && c < s->dim; c++) {
        char name[2] = {"xyz"[c], '\0'};
        if (table_find(t, name) < 0)
            status =
                document_fail(s->doc, json_get(f->node, "file"), e,
                              "the file has no column \"%s\"; \"rename\" can name another", name);
    }
    if (!status)
        status = fill_guard(s, f, (double)t->n, e);
    if (status < 0)
        table_free(t);
    return status;
}

static int fill_file(const struct scene *s, const struct scene_fill *f, struct points *q,
                     struct table *t, struct error *e)
{
    if (load_table(s, f, t, e) < 0)
        return -1;
    for (size_t i = 0; i < t->n; i++) {
        double x[3] = {0, 0, 0};
        for (int c = 0; c < s->dim; c++) {
            char name[2] = {"xyz"[c], '\0'};
            x[c] = t->column[table_find(t, name)].value[i];
        }
        if (points_add(q, x, f->spacing > 0 ? f->spacing : NAN, e) < 0)
            return -1;
    }
    return 0;
}

/* -- Arrays ---------------------------------------------------------------------------------- */

int fill_count(const struct scene *s, size_t a, uint64_t *n, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    *n = 0;
    for (size_t k = 0; k < array->n_fill; k++) {
        uint64_t count = 0;
        struct table t = {0};
        int status;
        if (array->fill[k].kind == FILL_FILE) {
            status = load_table(s, &array->fill[k], &t, e);
            count = status ? 0 : t.n;
            if (!status)
                table_free(&t);
        } else if (array->fill[k].kind == FILL_GLASS) {
            status = fill_glass(s, a, k, NULL, &count, e);
        } else {
            status = fill_lattice(s, a, k, NULL, &count, e);
        }
        if (status < 0)
            return -1;
        *n += count;
        if (fill_guard(s, &array->fill[k], (double)*n, e) < 0)
            return -1;
    }
    return 0;
}

/* Points of all fills; first[k] is where those of fill k begin. Tables of files are kept. */
static int make_points(const struct scene *s, size_t a, struct points *q, size_t *first,
                       struct table *table, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    for (size_t k = 0; k < array->n_fill; k++) {
        uint64_t count;
        int status;
        first[k] = q->n;
        if (array->fill[k].kind == FILL_FILE)
            status = fill_file(s, &array->fill[k], q, &table[k], e);
        else if (array->fill[k].kind == FILL_GLASS)
            status = fill_glass(s, a, k, q, &count, e);
        else
            status = fill_lattice(s, a, k, q, &count, e);
        if (status < 0 || fill_guard(s, &array->fill[k], (double)q->n, e) < 0)
            return -1;
    }
    first[array->n_fill] = q->n;
    return 0;
}

/* Ghosts are made of what lies inside: beyond a periodic or mirror side there must be nothing. */
static int check_domain(const struct scene *s, size_t a, const struct points *q,
                        const size_t *first, struct error *e)
{
    static const char *const words[] = {"open", "periodic", "mirror"};
    const struct box *box = &s->box;
    for (size_t i = 0; box->bounded && i < q->n; i++)
        for (int c = 0; c < s->dim; c++) {
            double x = q->x[i * (size_t)s->dim + (size_t)c];
            bool high = x > box->max[c];
            enum side side = box->side[c][high];
            if ((x >= box->min[c] && x <= box->max[c]) || side == SIDE_OPEN)
                continue;
            size_t k = 0;
            while (first[k + 1] <= i)
                k++;
            return document_fail(
                s->doc, s->array[a].fill[k].node, e,
                "a particle at %c = %.6g lies outside the domain, beyond its %s side", "xyz"[c], x,
                words[side]);
        }
    return 0;
}

/* Room for them: refused before the machine swaps. */
static int check_memory(const struct scene *s, size_t a, const struct particles *p, size_t n,
                        struct error *e)
{
    double pages = (double)sysconf(_SC_PHYS_PAGES), page = (double)sysconf(_SC_PAGESIZE);
    double have = pages * page, need = (double)n * (double)(particles_bytes(p) + 100);
    if (need <= have || have <= 0)
        return 0;
    return document_fail(s->doc, s->array[a].node, e,
                         "%zu particles take %.3g GiB, and this machine has %.3g", n,
                         need / 1073741824., have / 1073741824.);
}

static void place(struct particles *p, const struct points *q, int64_t *next_id)
{
    double *h = particles_real(p, "h", 0);
    int id = particles_find(p, "id");
    for (int c = 0; c < p->dim; c++) {
        double *x = particles_real(p, "x", (uint32_t)c);
        for (size_t i = 0; i < q->n; i++)
            x[i] = q->x[i * (size_t)p->dim + (size_t)c];
    }
    for (size_t i = 0; i < q->n; i++) {
        h[i] = q->spacing[i]; /* until fill_fields makes it the smoothing length */
        if (id >= 0)
            ((int64_t *)p->column[id].data)[i] = (*next_id)++;
    }
}

/* What one fill gives and another does not would stay 0 there without a word. */
static int check_same(const struct particles *p, const struct scene *s, size_t a,
                      const bool *before, const bool *now, size_t k, struct error *e)
{
    for (size_t c = 0; c < p->n_column; c++)
        if (before[c] != now[c])
            return document_fail(s->doc, s->array[a].fill[k].node, e,
                                 "\"%s\" is given by %s fill of this array, and not by %s",
                                 p->column[c].name, before[c] ? "an earlier" : "this",
                                 before[c] ? "this one" : "an earlier one");
    return 0;
}

static int set_columns(struct particles *p, const struct scene *s, size_t a, const size_t *first,
                       const struct table *table, bool *given, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    bool *now = calloc(p->n_column + 1, sizeof *now);
    int status = now ? 0 : error_memory(e, "the columns of an array", p->n_column);
    for (size_t k = 0; k < array->n_fill && !status; k++) {
        memset(now, 0, p->n_column * sizeof *now);
        status = fill_fields(p, s, a, k, first[k], first[k + 1] - first[k],
                             array->fill[k].kind == FILL_FILE ? &table[k] : NULL, now, e);
        if (!status && k)
            status = check_same(p, s, a, given, now, k, e);
        if (!status)
            memcpy(given, now, p->n_column * sizeof *now);
    }
    free(now);
    return status;
}

/* "(1, 2)" of particle i. */
static const char *place_text(const struct near_cloud *c, size_t i, char *out, size_t size)
{
    if (c->dim == 1)
        snprintf(out, size, "x = %.6g", c->x[0][i]);
    else if (c->dim == 2)
        snprintf(out, size, "(%.6g, %.6g)", c->x[0][i], c->x[1][i]);
    else
        snprintf(out, size, "(%.6g, %.6g, %.6g)", c->x[0][i], c->x[1][i], c->x[2][i]);
    return out;
}

/* Two particles of a file in the same place. `all` is the whole array; group is overwritten. */
static int check_twins(const struct scene *s, const struct scene_fill *f,
                       const struct near_cloud *all, size_t first, size_t end, uint32_t *group,
                       struct error *e)
{
    struct near_cloud cloud = {.dim = all->dim,
                               .near = NEAR_SAME,
                               .n = end - first,
                               .spacing = all->spacing + first,
                               .group = group + first};
    size_t i, j;
    bool found;
    char where[80];
    for (int c = 0; c < all->dim; c++)
        cloud.x[c] = all->x[c] + first;
    for (i = first; i < end; i++)
        group[i] = (uint32_t)(i - first); /* each its own */
    if (near_pair(&cloud, &found, &i, &j, e) < 0)
        return -1;
    if (!found)
        return 0;
    return document_fail(s->doc, json_get(f->node, "file"), e,
                         "particles %zu and %zu of the file stand in the same place, %s", i + 1,
                         j + 1, place_text(&cloud, i, where, sizeof where));
}

/* Between the fills of one array, and between the particles of a file. */
static int check_fills(const struct particles *p, const struct scene *s, size_t a,
                       const size_t *first, const double *spacing, struct error *e)
{
    const struct scene_array *array = &s->array[a];
    size_t i = 0, j = 0, k = 0;
    bool found = false;
    uint32_t *group = calloc(p->n + 1, sizeof *group);
    if (!group)
        return error_memory(e, "the search for overlaps", p->n * sizeof *group);
    struct near_cloud cloud = {
        .dim = s->dim, .near = NEAR_OVERLAP, .n = p->n, .spacing = spacing, .group = group};
    for (int c = 0; c < s->dim; c++)
        cloud.x[c] = particles_real(p, "x", (uint32_t)c);
    for (k = 0; k < array->n_fill; k++)
        for (i = first[k]; i < first[k + 1]; i++)
            group[i] = (uint32_t)k;
    int status = array->n_fill > 1 ? near_pair(&cloud, &found, &i, &j, e) : 0;
    if (!status && found) {
        char one[256], where[80];
        document_pointer(s->doc, array->fill[group[i]].node, one, sizeof one);
        status = document_fail(s->doc, array->fill[group[j]].node, e,
                               "this fill overlaps %s: particles of both stand near %s, "
                               "less than a quarter of their spacing apart",
                               one, place_text(&cloud, i, where, sizeof where));
    }
    for (k = 0; !status && k < array->n_fill; k++)
        if (array->fill[k].kind == FILL_FILE)
            status = check_twins(s, &array->fill[k], &cloud, first[k], first[k + 1], group, e);
    free(group);
    return status;
}

int fill_array(struct particles *p, const struct scene *s, size_t a, int64_t *next_id, bool *given,
               struct error *e)
{
    const struct scene_array *array = &s->array[a];
    struct points q = {.dim = s->dim};
    uint64_t count;
    size_t *first = calloc(array->n_fill + 1, sizeof *first);
    struct table *table = calloc(array->n_fill, sizeof *table);
    int status = first && table ? 0 : error_memory(e, "the fills of an array", 0);
    if (!status)
        status = fill_count(s, a, &count, e);
    if (!status)
        status = check_memory(s, a, p, count, e);
    if (!status)
        status = make_points(s, a, &q, first, table, e);
    if (!status)
        status = check_domain(s, a, &q, first, e);
    if (!status)
        status = particles_resize(p, q.n, 0, e);
    if (!status) {
        place(p, &q, next_id);
        status = set_columns(p, s, a, first, table, given, e);
    }
    for (size_t i = 0; !status && i < q.n; i++)
        if (isnan(q.spacing[i])) /* of a file that does not say */
            q.spacing[i] = particles_real(p, "h", 0)[i] / array->h_factor;
    if (!status)
        status = check_fills(p, s, a, first, q.spacing, e);
    for (size_t k = 0; table && k < array->n_fill; k++)
        table_free(&table[k]);
    points_fini(&q);
    free(table);
    free(first);
    return status;
}
