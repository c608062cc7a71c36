/* render_graph.c -- a field over x, for scenes of one dimension: a line and points for each
 * array. */
#include "config.h"

#include "io/render_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINT_ROOM 3.5 /* pixels along x that a point needs to be told from its neighbour */

/* Told apart with normal and with colour-blind eyes, and in grey (after Okabe and Ito 2008). */
static const double pen[][3] = {{0.00, 0.35, 0.70}, {0.84, 0.37, 0.00}, {0.00, 0.50, 0.40},
                                {0.60, 0.30, 0.60}, {0.55, 0.45, 0.00}, {0.20, 0.20, 0.20}};

struct point {
    double x, y;
    size_t id; /* keeps the order of equals */
};

static int compare(const void *a, const void *b)
{
    const struct point *p = a, *q = b;
    return p->x < q->x ? -1 : p->x > q->x ? 1 : p->id < q->id ? -1 : p->id > q->id;
}

static void draw_grid(const struct page *p)
{
    cairo_set_source_rgb(p->cr, 0.9, 0.9, 0.9);
    cairo_set_line_width(p->cr, 1);
    for (int i = 0; i < p->x.n; i++) {
        const double x = floor(page_x(p, p->x.at[i])) + 0.5;
        cairo_move_to(p->cr, x, p->top);
        cairo_line_to(p->cr, x, p->top + p->height);
    }
    for (int i = 0; i < p->y.n; i++) {
        const double y = floor(page_y(p, p->y.at[i])) + 0.5;
        cairo_move_to(p->cr, p->left, y);
        cairo_line_to(p->cr, p->left + p->width, y);
    }
    cairo_stroke(p->cr);
}

/* The points of one array in order of x; their number. */
static size_t collect(const struct picture_data *d, int32_t array, struct point *to)
{
    size_t n = 0;
    for (size_t i = 0; i < d->n; i++)
        if (d->s->array[d->index[i]] == array)
            to[n++] = (struct point){d->s->x[3 * d->index[i]], d->value[i], i};
    qsort(to, n, sizeof *to, compare);
    return n;
}

/* The highest and lowest that a cairo path is asked to reach: far outside is as good as
 * infinite. */
static double held(const struct page *p, double y)
{
    return fmin(fmax(page_y(p, y), p->top - 10 * p->height), p->top + 11 * p->height);
}

static bool is_drawn(const struct picture_data *d, double value)
{
    return isfinite(value) && (!d->log || value > 0);
}

static void draw_line(const struct page *p, const struct picture_data *d, const struct point *at,
                      size_t n)
{
    bool down = false; /* the pen */
    for (size_t i = 0; i < n; i++) {
        if (!is_drawn(d, at[i].y))
            down = false;
        else if (down)
            cairo_line_to(p->cr, page_x(p, at[i].x), held(p, at[i].y));
        else
            cairo_move_to(p->cr, page_x(p, at[i].x), held(p, at[i].y));
        down = is_drawn(d, at[i].y);
    }
    cairo_set_line_width(p->cr, fmax(1, p->font / 11));
    cairo_set_line_join(p->cr, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(p->cr);
}

static void draw_points(const struct page *p, const struct picture_data *d, const struct point *at,
                        size_t n)
{
    const double room = p->width / (double)n, r = fmin(fmax(room / 3, 1.2), p->font / 4.5);
    for (size_t i = 0; room >= POINT_ROOM && i < n; i++)
        if (is_drawn(d, at[i].y)) {
            cairo_new_sub_path(p->cr);
            cairo_arc(p->cr, page_x(p, at[i].x), held(p, at[i].y), r, 0, 2 * M_PI);
        }
    cairo_fill(p->cr);
}

/* Names of the arrays drawn, in their colours, above the plot's right end. */
static void draw_legend(const struct page *p, const struct picture_data *d, const bool *drawn)
{
    double y = p->top + 1.2 * p->font;
    for (size_t a = 0; a < d->s->n_array; a++) {
        if (!drawn[a])
            continue;
        const double *c = pen[a % (sizeof pen / sizeof pen[0])];
        cairo_set_source_rgb(p->cr, c[0], c[1], c[2]);
        page_text(p->cr, p->left + p->width - 0.8 * p->font, y, 1, 0.5, d->s->array_name[a]);
        y += 1.5 * p->font;
    }
}

int graph_draw(struct page *p, const struct picture_data *d, const struct render_options *o,
               struct error *e)
{
    (void)o;
    struct point *at = malloc(d->n * sizeof *at);
    bool *drawn = calloc(d->s->n_array, sizeof *drawn);
    size_t arrays = 0;
    int result = 0;
    if (at && drawn) {
        draw_grid(p);
        cairo_save(p->cr);
        cairo_rectangle(p->cr, p->left, p->top, p->width, p->height);
        cairo_clip(p->cr);
        for (size_t a = 0; a < d->s->n_array; a++) {
            const size_t n = collect(d, (int32_t)a, at);
            const double *c = pen[a % (sizeof pen / sizeof pen[0])];
            if (n == 0)
                continue;
            drawn[a] = true;
            arrays++;
            cairo_set_source_rgb(p->cr, c[0], c[1], c[2]);
            draw_line(p, d, at, n);
            draw_points(p, d, at, n);
        }
        cairo_restore(p->cr);
        if (arrays > 1)
            draw_legend(p, d, drawn);
    } else {
        result = error_memory(e, "a picture", d->n * sizeof *at);
    }
    free(drawn);
    free(at);
    return result;
}
