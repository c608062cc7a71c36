/* chart/draw_plot.c -- error against cost: logarithmic axes with their grid, series, the front, and on
 * the upper edge what failed. */
#include "chart/draw.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLOT_HEIGHT 460.0 /* [pixel]; more beside a long legend */
#define PLOT_HEIGHT_MOST 760.0
#define PLOT_ASPECT 1.3
#define RADIUS 4.5

/* Okabe and Ito 2008, "Color universal design": told apart by all; black comes last. */
static const unsigned colours[] = {0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7,
                                   0xe69f00, 0x56b4e9, 0x000000};
#define N_COLOURS (sizeof colours / sizeof colours[0])
#define N_MARKERS 7

double plot_x(const struct sheet *s, double value)
{
    return s->left + log(value / s->q->low[0]) / log(s->q->high[0] / s->q->low[0]) * s->w;
}

double plot_y(const struct sheet *s, double value)
{
    return s->top + (1 - log(value / s->q->low[1]) / log(s->q->high[1] / s->q->low[1])) * s->h;
}

void plot_lay_out(struct sheet *s)
{
    legend_draw(s); /* for its height */
    s->h = floor(fmin(fmax(PLOT_HEIGHT, s->right_height - 48), PLOT_HEIGHT_MOST));
    s->w = floor(PLOT_ASPECT * s->h);
    ticks_make(&s->x, s->q->low[0], s->q->high[0], true, 9);
    ticks_make(&s->y, s->q->low[1], s->q->high[1], true, 9);
    sheet_font(s, FONT, false);
    double widest = 0;
    for (int i = 0; i < s->y.n; i++)
        widest = fmax(widest, sheet_width(s, s->y.text[i]));
    s->left = floor(AIR + 24 + widest + 10);
    s->right = s->left + s->w + 34;
}

/* -- Series ------------------------------------------------------------------------------------------ */

void series_colour(cairo_t *cr, const struct plot_series *s, size_t i)
{
    const unsigned rgb = s->peer ? 0x555555 : colours[i % N_COLOURS];
    cairo_set_source_rgb(cr, (double)(rgb >> 16 & 255) / 255, (double)(rgb >> 8 & 255) / 255,
                         (double)(rgb & 255) / 255);
}

static void polygon(cairo_t *cr, double x, double y, double radius, int corners, double turn)
{
    for (int k = 0; k < corners; k++) {
        const double a = 2 * M_PI * k / corners + turn;
        cairo_line_to(cr, x + radius * sin(a), y - radius * cos(a));
    }
    cairo_close_path(cr);
}

/* A cross of two bars, turned by `turn`. */
static void cross(cairo_t *cr, double x, double y, double radius, double turn)
{
    static const double at[12][2] = {{1, 3},   {1, 1},   {3, 1},   {3, -1}, {1, -1}, {1, -3},
                                     {-1, -3}, {-1, -1}, {-3, -1}, {-3, 1}, {-1, 1}, {-1, 3}};
    for (int k = 0; k < 12; k++) {
        const double u = at[k][0] * radius / 3, v = at[k][1] * radius / 3;
        cairo_line_to(cr, x + u * cos(turn) - v * sin(turn), y + u * sin(turn) + v * cos(turn));
    }
    cairo_close_path(cr);
}

/* Colour and form change together, and after seven in other pairs. */
void series_marker(cairo_t *cr, size_t i, double x, double y, double radius)
{
    cairo_new_sub_path(cr);
    switch ((i + i / N_COLOURS) % N_MARKERS) {
    case 0:
        cairo_arc(cr, x, y, radius, 0, 2 * M_PI);
        cairo_close_path(cr);
        break;
    case 1:
        polygon(cr, x, y, 1.25 * radius, 4, M_PI / 4);
        break;
    case 2:
        polygon(cr, x, y, 1.35 * radius, 4, 0);
        break;
    case 3:
        polygon(cr, x, y, 1.35 * radius, 3, M_PI);
        break;
    case 4:
        cross(cr, x, y, 1.3 * radius, 0);
        break;
    case 5:
        cross(cr, x, y, 1.3 * radius, M_PI / 4);
        break;
    default:
        polygon(cr, x, y, 1.25 * radius, 5, 0);
    }
}

void series_markers_end(cairo_t *cr, const struct plot_series *s, size_t i)
{
    series_colour(cr, s, i);
    if (s->peer) { /* hollow */
        cairo_set_line_width(cr, 3.2);
        cairo_stroke_preserve(cr);
        cairo_set_source_rgb(cr, 1, 1, 1);
        cairo_fill(cr);
        return;
    }
    cairo_fill_preserve(cr);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_set_line_width(cr, 0.8);
    cairo_stroke(cr);
}

static void draw_line(struct sheet *s, const struct plot_series *series, size_t i)
{
    cairo_t *cr = s->cr;
    static const double dashes[] = {6, 4};
    for (size_t k = 0; k < series->n_line; k++)
        cairo_line_to(cr, plot_x(s, series->x[series->line[k]]),
                      plot_y(s, series->y[series->line[k]]));
    series_colour(cr, series, i);
    cairo_set_line_width(cr, 1.2);
    cairo_set_dash(cr, dashes, series->peer ? 2 : 0, 0);
    cairo_stroke(cr);
    cairo_set_dash(cr, dashes, 0, 0);
}

static void draw_points(struct sheet *s, const struct plot_series *series, size_t i)
{
    for (size_t k = 0; k < series->n; k++)
        series_marker(s->cr, i, plot_x(s, series->x[k]), plot_y(s, series->y[k]), RADIUS);
    series_markers_end(s->cr, series, i);
}

/* -- What failed ------------------------------------------------------------------------------------- */

void failed_marker(cairo_t *cr, double x, double y)
{
    cairo_new_sub_path(cr);
    polygon(cr, x, y, 6, 3, 0);
}

static void draw_failed(struct sheet *s)
{
    for (size_t i = 0; i < s->q->n_failed; i++) {
        const struct plot_failed *f = &s->q->failed[i];
        const double x = isnan(f->x) ? s->left : plot_x(s, f->x);
        failed_marker(s->cr, x, s->top + 1);
        cairo_set_source_rgb(s->cr, 1, 1, 1);
        cairo_fill_preserve(s->cr);
        series_colour(s->cr, &s->q->series[f->series], f->series);
        cairo_set_line_width(s->cr, 1.6);
        cairo_stroke(s->cr);
    }
}

/* -- The front --------------------------------------------------------------------------------------- */

static void draw_front(struct sheet *s)
{
    const struct plot *q = s->q;
    for (size_t i = 0; i < q->n_front; i++) {
        /* Between two members nothing is better than the cheaper one: a step. */
        const double x = plot_x(s, q->x[q->front[i]]);
        if (i > 0)
            cairo_line_to(s->cr, x, plot_y(s, q->y[q->front[i - 1]]));
        cairo_line_to(s->cr, x, plot_y(s, q->y[q->front[i]]));
    }
    cairo_set_source_rgb(s->cr, 0.8, 0.8, 0.8);
    cairo_set_line_width(s->cr, 9);
    cairo_set_line_cap(s->cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(s->cr, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(s->cr);
    cairo_set_line_cap(s->cr, CAIRO_LINE_CAP_BUTT);
    cairo_set_line_join(s->cr, CAIRO_LINE_JOIN_MITER);
}

/* Members of the front with one label: its text and the upper right corner of it. */
struct number {
    size_t first, last;
    char text[48];
    double x, y, width;
};

/* To the lower left of its members, where no point of ours can be. */
static void place_number(const struct sheet *s, struct number *n)
{
    const struct plot *q = s->q;
    snprintf(n->text, sizeof n->text, n->last > n->first ? "%zu–%zu" : "%zu", n->first + 1,
             n->last + 1);
    n->width = sheet_width(s, n->text);
    n->x = fmax(plot_x(s, q->x[q->front[n->first]]) - 8, s->left + 4 + n->width);
    n->y = fmin(plot_y(s, q->y[q->front[n->last]]) + 8, s->top + s->h - 12);
}

static bool overlap(const struct number *a, const struct number *b)
{
    return a->x > b->x - b->width - 4 && b->x > a->x - a->width - 4 && fabs(a->y - b->y) < 13;
}

/* Members too close to each other have one label together: "3–5". */
static void draw_numbers(struct sheet *s)
{
    struct number number[PLOT_FRONT_MOST];
    size_t n = 0;
    for (size_t i = 0; i < s->q->n_front && i < PLOT_FRONT_MOST; i++) {
        number[n] = (struct number){.first = i, .last = i};
        place_number(s, &number[n++]);
        for (; n > 1 && overlap(&number[n - 2], &number[n - 1]); n--) {
            number[n - 2].last = number[n - 1].last;
            place_number(s, &number[n - 2]);
        }
    }
    for (size_t i = 0; i < n; i++)
        sheet_put(s, number[i].x, number[i].y, 1, 1, number[i].text);
}

/* -- Axes -------------------------------------------------------------------------------------------- */

static bool is_tick(const struct ticks *t, double value)
{
    for (int i = 0; i < t->n; i++)
        if (fabs(t->at[i] / value - 1) < 1e-6)
            return true;
    return false;
}

/* 2 ... 9 of every decade; where there are many decades, only these. */
static void draw_minor(struct sheet *s, int axis)
{
    const double low = s->q->low[axis], high = s->q->high[axis];
    const int first = (int)floor(log10(low)), last = (int)ceil(log10(high));
    for (int p = first; p < last; p++)
        for (int k = 1; k < (last - first > 8 ? 2 : 10); k++) {
            const double value = k * pow(10, p);
            if (value <= low * (1 + 1e-9) || value >= high * (1 - 1e-9) ||
                is_tick(axis ? &s->y : &s->x, value))
                continue;
            const double at = floor(axis ? plot_y(s, value) : plot_x(s, value)) + 0.5;
            cairo_move_to(s->cr, axis ? s->left : at, axis ? at : s->top);
            cairo_line_to(s->cr, axis ? s->left + s->w : at, axis ? at : s->top + s->h);
        }
    cairo_set_source_rgb(s->cr, 0.94, 0.94, 0.94);
    cairo_set_line_width(s->cr, 1);
    cairo_stroke(s->cr);
}

static void draw_grid(struct sheet *s)
{
    draw_minor(s, 0);
    draw_minor(s, 1);
    for (int i = 0; i < s->x.n; i++) {
        const double x = floor(plot_x(s, s->x.at[i])) + 0.5;
        cairo_move_to(s->cr, x, s->top);
        cairo_line_to(s->cr, x, s->top + s->h + 5);
    }
    for (int i = 0; i < s->y.n; i++) {
        const double y = floor(plot_y(s, s->y.at[i])) + 0.5;
        cairo_move_to(s->cr, s->left - 5, y);
        cairo_line_to(s->cr, s->left + s->w, y);
    }
    cairo_set_source_rgb(s->cr, 0.82, 0.82, 0.82);
    cairo_set_line_width(s->cr, 1);
    cairo_stroke(s->cr);
}

static void draw_axes(struct sheet *s)
{
    const double bottom = s->top + s->h;
    sheet_font(s, FONT, false);
    sheet_ink(s, INK);
    cairo_set_line_width(s->cr, 1);
    cairo_rectangle(s->cr, floor(s->left) + 0.5, floor(s->top) + 0.5, s->w, s->h);
    cairo_stroke(s->cr);
    for (int i = 0; i < s->x.n; i++)
        sheet_put(s, plot_x(s, s->x.at[i]), bottom + 9, 0.5, 1, s->x.text[i]);
    for (int i = 0; i < s->y.n; i++)
        sheet_put(s, s->left - 8, plot_y(s, s->y.at[i]), 1, 0.5, s->y.text[i]);
    sheet_put(s, s->left + s->w / 2, bottom + 31, 0.5, 1, s->q->x_label);
    sheet_put(s, s->left + s->w, bottom + 31, 1, 1, s->x.factor);
    sheet_put_upward(s, AIR + 6, s->top + s->h / 2, s->q->y_label);
    sheet_put(s, s->left + 6, s->top + 16, 0, 1, s->y.factor);
}

void plot_draw(struct sheet *s)
{
    draw_grid(s);
    draw_front(s);
    for (size_t i = 0; i < s->q->n_series; i++)
        draw_line(s, &s->q->series[i], i);
    for (size_t i = 0; i < s->q->n_series; i++)
        draw_points(s, &s->q->series[i], i);
    draw_axes(s);
    draw_failed(s);
    sheet_font(s, FONT_SMALL, true);
    sheet_ink(s, GREY);
    draw_numbers(s);
}
