/* chart/draw_legend.c -- beside the plot: series with their fits, the members of the front, failures. */
#include "chart/draw.h"

#include <stdio.h>
#include <string.h>

#define SAMPLE 28.0 /* [pixel] of line and marker before a label */
#define TEXT (SAMPLE + 8)

static void widen(struct sheet *s, double width)
{
    s->right_width = fmax(s->right_width, width);
}

static double put_series(struct sheet *s, size_t i, double y)
{
    const struct plot_series *series = &s->q->series[i];
    static const double dashes[] = {6, 4};
    if (s->draws) {
        series_colour(s->cr, series, i);
        cairo_set_dash(s->cr, dashes, series->peer ? 2 : 0, 0);
        cairo_set_line_width(s->cr, 1.4);
        cairo_move_to(s->cr, s->right, y + 7);
        cairo_line_to(s->cr, s->right + SAMPLE, y + 7);
        cairo_stroke(s->cr);
        cairo_set_dash(s->cr, dashes, 0, 0);
        series_marker(s->cr, i, s->right + SAMPLE / 2, y + 7, 4.5);
        series_markers_end(s->cr, series, i);
    }
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 11, FONT, INK, false, series->label));
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 25, FONT_SMALL, GREY, false, series->note));
    return y + 34;
}

/* "1  450 · kdk: 0.012 at 3.4" */
static double put_member(struct sheet *s, size_t i, double y)
{
    const struct plot *q = s->q;
    const size_t at = q->front[i];
    char number[24], labels[256], text[400], x_text[32], y_text[32];
    snprintf(number, sizeof number, "%zu", i + 1);
    chart_labels(q->c, &q->c->run[q->run[at]], q->varied, q->n_varied, false, labels,
                 sizeof labels);
    snprintf(text, sizeof text, "%s%s%s at %s", labels, labels[0] ? ":  " : "",
             plot_number(y_text, sizeof y_text, q->y[at], 2),
             plot_number(x_text, sizeof x_text, q->x[at], 3));
    sheet_font(s, FONT_SMALL, true);
    sheet_text(s, s->right + SAMPLE - sheet_width(s, number), y + 10, FONT_SMALL, GREY, true,
               number);
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 10, FONT_SMALL, INK, false, text));
    return y + 15;
}

static double put_front(struct sheet *s, double y)
{
    const struct plot *q = s->q;
    const size_t n = q->n_front < PLOT_FRONT_MOST ? q->n_front : PLOT_FRONT_MOST;
    char text[160];
    if (q->n_front == 0)
        return y;
    if (s->draws) {
        cairo_set_source_rgb(s->cr, 0.8, 0.8, 0.8);
        cairo_set_line_width(s->cr, 9);
        cairo_move_to(s->cr, s->right + 2, y + 7);
        cairo_line_to(s->cr, s->right + SAMPLE, y + 7);
        cairo_stroke(s->cr);
    }
    const bool peers = q->n_series > 0 && q->series[q->n_series - 1].peer;
    snprintf(text, sizeof text, "no run%s is better in both", peers ? " of ours" : "");
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 11, FONT, INK, false, "Pareto front"));
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 25, FONT_SMALL, GREY, false, text));
    y += 32;
    for (size_t i = 0; i < n; i++)
        y = put_member(s, i, y);
    if (q->n_front > n) {
        snprintf(text, sizeof text, "and %zu more", q->n_front - n);
        widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 10, FONT_SMALL, GREY, false, text));
        y += 15;
    }
    return y + 8;
}

static double put_failed(struct sheet *s, double y)
{
    char text[200];
    if (s->q->n_failed == 0)
        return y;
    if (s->draws) {
        failed_marker(s->cr, s->right + SAMPLE / 2, y + 8);
        sheet_ink(s, GREY);
        cairo_set_line_width(s->cr, 1.6);
        cairo_stroke(s->cr);
    }
    snprintf(text, sizeof text, "failed: %s", s->q->failures);
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 11, FONT, INK, false, text));
    widen(s, TEXT + sheet_text(s, s->right + TEXT, y + 25, FONT_SMALL, GREY, false,
                               s->q->p->x_axis == SIZE_MAX ? "where their cost had come to"
                                                           : "at their place on the axis"));
    return y + 32;
}

void legend_draw(struct sheet *s)
{
    double y = s->top;
    for (size_t i = 0; i < s->q->n_series; i++)
        y = put_series(s, i, y);
    y = put_front(s, y + 4);
    y = put_failed(s, y);
    s->right_height = y - s->top;
}
