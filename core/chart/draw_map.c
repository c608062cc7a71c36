/* chart/draw_map.c -- the error over two axes: coloured cells, hatched where the run failed. */
#include "chart/draw.h"

#include <stdio.h>
#include <string.h>

#define CELL_WIDTH 58.0
#define CELL_HEIGHT 40.0
#define BAR 14.0

/* The run of a cell, or n_run if there is none. */
static size_t run_at(const struct plot *q, size_t x, size_t y)
{
    for (size_t i = 0; i < q->c->n_run; i++) {
        const struct chart_run *r = &q->c->run[i];
        if (chart_choice_has(q->c, &q->p->select, r) && r->value[q->p->x_axis] == x &&
            r->value[q->p->y_axis] == y)
            return i;
    }
    return q->c->n_run;
}

static bool has(const struct plot *q, size_t axis, size_t value)
{
    return q->p->select.has[axis][value];
}

static size_t chosen(const struct plot *q, size_t axis)
{
    size_t n = 0;
    for (size_t i = 0; i < q->c->axis[axis].n_value; i++)
        n += has(q, axis, i);
    return n;
}

static double widest_label(struct sheet *s, size_t axis)
{
    double widest = 0;
    for (size_t i = 0; i < s->q->c->axis[axis].n_value; i++)
        if (has(s->q, axis, i))
            widest = fmax(widest, sheet_width(s, s->q->c->axis[axis].value[i].label));
    return widest;
}

/* The range of the colours: that of the errors, somewhat rounded. */
static void colour_range(struct sheet *s)
{
    s->low = (double)INFINITY;
    s->high = 0;
    for (size_t i = 0; i < s->q->n; i++) {
        s->low = fmin(s->low, s->q->y[i]);
        s->high = fmax(s->high, s->q->y[i]);
    }
    if (!(s->high > 0)) {
        s->low = 0.1;
        s->high = 1;
    }
    if (s->high < 1.1 * s->low) {
        s->low /= 1.1;
        s->high *= 1.1;
    }
}

int map_lay_out(struct sheet *s, struct error *e)
{
    const size_t nx = chosen(s->q, s->q->p->x_axis), ny = chosen(s->q, s->q->p->y_axis);
    if (colour_map_make(&s->map, NULL, e))
        return -1;
    colour_range(s);
    sheet_font(s, FONT, false);
    const double cell = fmax(CELL_WIDTH, 14 + widest_label(s, s->q->p->x_axis));
    s->w = fmax(cell, floor(300 / (double)nx)) * (double)nx;
    /* High enough for what stands upward beside it, too. */
    const double words = fmax(sheet_width(s, s->q->y_label), sheet_width(s, s->q->c->error.title));
    s->h = fmax(CELL_HEIGHT, ceil(fmax(200, words) / (double)ny)) * (double)ny;
    s->left = floor(AIR + 24 + widest_label(s, s->q->p->y_axis) + 10);
    s->right = s->left + s->w + 20;
    ticks_make(&s->bar, s->low, s->high, true, 7);
    double widest = 0;
    for (int i = 0; i < s->bar.n; i++)
        widest = fmax(widest, sheet_width(s, s->bar.text[i]));
    s->right_width = BAR + 8 + widest + 28;
    s->right_height = s->h;
    return 0;
}

/* -- Cells --------------------------------------------------------------------------------------------- */

struct box {
    double x, y, w, h;
};

static double scale(const struct sheet *s, double error)
{
    return log(error / s->low) / log(s->high / s->low);
}

static void colour(struct sheet *s, double t)
{
    const unsigned char *rgb = colour_of(&s->map, t);
    cairo_set_source_rgb(s->cr, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
}

static void draw_value(struct sheet *s, const struct box *b, double error)
{
    char text[32];
    const double t = scale(s, error);
    colour(s, t);
    cairo_rectangle(s->cr, b->x, b->y, b->w, b->h);
    cairo_fill(s->cr);
    snprintf(text, sizeof text, "%.2g", error);
    sheet_ink(s, t < 0.6 ? WHITE : INK);
    sheet_font(s, FONT_SMALL, false);
    sheet_put(s, b->x + b->w / 2, b->y + b->h / 2, 0.5, 0.5, text);
}

/* Slanted lines, and one word on white. */
static void draw_hatched(struct sheet *s, const struct box *b, const char *word)
{
    cairo_t *cr = s->cr;
    cairo_save(cr);
    cairo_rectangle(cr, b->x, b->y, b->w, b->h);
    cairo_clip(cr);
    for (double x = b->x - b->h; x < b->x + b->w; x += 7) {
        cairo_move_to(cr, x, b->y + b->h);
        cairo_line_to(cr, x + b->h, b->y);
    }
    cairo_set_source_rgb(cr, 0.6, 0.6, 0.6);
    cairo_set_line_width(cr, 1.2);
    cairo_stroke(cr);
    cairo_restore(cr);
    sheet_font(s, FONT_SMALL, false);
    const double width = sheet_width(s, word) + 6;
    cairo_rectangle(cr, b->x + (b->w - width) / 2, b->y + b->h / 2 - 8, width, 16);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_fill(cr);
    sheet_ink(s, INK);
    sheet_put(s, b->x + b->w / 2, b->y + b->h / 2, 0.5, 0.5, word);
}

static void draw_cell(struct sheet *s, const struct box *b, size_t run)
{
    const struct plot *q = s->q;
    const struct row *r = run < q->c->n_run ? &q->s->row[run] : NULL;
    if (r && r->there && r->status == ROW_DONE && r->error > 0) {
        draw_value(s, b, r->error);
    } else if (r && r->there && r->status != ROW_DONE) {
        draw_hatched(s, b, row_status_name[r->status]);
    } else {
        sheet_font(s, FONT_SMALL, false);
        sheet_ink(s, GREY);
        sheet_put(s, b->x + b->w / 2, b->y + b->h / 2, 0.5, 0.5,
                  !r         ? "skipped"
                  : r->there ? "0"
                             : "not made");
    }
    cairo_rectangle(s->cr, b->x, b->y, b->w, b->h);
    cairo_set_source_rgb(s->cr, 1, 1, 1);
    cairo_set_line_width(s->cr, 1);
    cairo_stroke(s->cr);
}

static void draw_cells(struct sheet *s)
{
    const struct chart_picture *p = s->q->p;
    const struct chart_axis *ax = &s->q->c->axis[p->x_axis], *ay = &s->q->c->axis[p->y_axis];
    struct box b = {.w = s->w / (double)chosen(s->q, p->x_axis),
                    .h = s->h / (double)chosen(s->q, p->y_axis),
                    .y = s->top + s->h};
    for (size_t j = 0; j < ay->n_value; j++) {
        if (!has(s->q, p->y_axis, j))
            continue;
        b.y -= b.h;
        b.x = s->left;
        for (size_t i = 0; i < ax->n_value; i++) {
            if (!has(s->q, p->x_axis, i))
                continue;
            draw_cell(s, &b, run_at(s->q, i, j));
            b.x += b.w;
        }
        sheet_font(s, FONT, false);
        sheet_ink(s, INK);
        sheet_put(s, s->left - 8, b.y + b.h / 2, 1, 0.5, ay->value[j].label);
    }
    b.x = s->left;
    for (size_t i = 0; i < ax->n_value; i++)
        if (has(s->q, p->x_axis, i)) {
            sheet_put(s, b.x + b.w / 2, s->top + s->h + 9, 0.5, 1, ax->value[i].label);
            b.x += b.w;
        }
}

static void draw_bar(struct sheet *s)
{
    cairo_t *cr = s->cr;
    cairo_pattern_t *shades = cairo_pattern_create_linear(0, s->top + s->h, 0, s->top);
    for (int i = 0; i <= 16; i++) {
        const unsigned char *rgb = colour_of(&s->map, i / 16.0);
        cairo_pattern_add_color_stop_rgb(shades, i / 16.0, rgb[0] / 255.0, rgb[1] / 255.0,
                                         rgb[2] / 255.0);
    }
    cairo_rectangle(cr, s->right, s->top, BAR, s->h);
    cairo_set_source(cr, shades);
    cairo_fill(cr);
    cairo_pattern_destroy(shades);
    sheet_ink(s, INK);
    sheet_font(s, FONT, false);
    double widest = 0;
    for (int i = 0; i < s->bar.n; i++) {
        const double y = s->top + (1 - scale(s, s->bar.at[i])) * s->h;
        cairo_move_to(cr, s->right + BAR, y);
        cairo_line_to(cr, s->right + BAR + 4, y);
        cairo_set_line_width(cr, 1);
        cairo_stroke(cr);
        sheet_put(s, s->right + BAR + 8, y, 0, 0.5, s->bar.text[i]);
        widest = fmax(widest, sheet_width(s, s->bar.text[i]));
    }
    sheet_put_upward(s, s->right + BAR + 8 + widest + 16, s->top + s->h / 2, s->q->c->error.title);
}

void map_draw(struct sheet *s)
{
    draw_cells(s);
    sheet_ink(s, INK);
    cairo_set_line_width(s->cr, 1);
    cairo_rectangle(s->cr, floor(s->left) + 0.5, floor(s->top) + 0.5, s->w, s->h);
    cairo_stroke(s->cr);
    sheet_put(s, s->left + s->w / 2, s->top + s->h + 31, 0.5, 1,
              s->q->c->axis[s->q->p->x_axis].name);
    sheet_put_upward(s, AIR + 6, s->top + s->h / 2, s->q->y_label);
    draw_bar(s);
}
