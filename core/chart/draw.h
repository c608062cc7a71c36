/* chart/draw.h -- what the parts of a picture's drawing share; for core/chart/draw*.c only. */
#ifndef CHART_DRAW_H
#define CHART_DRAW_H

#include "chart/plot.h"
#include "io/render_parts.h"

#define FONT 12.0 /* [pixel] of most texts */
#define FONT_SMALL 10.5
#define FONT_TITLE 17.0
#define AIR 16.0 /* [pixel] around everything */
#define LINES_MOST 12
#define LINE_BYTES 400

/* The sheet: title and subtitle above, the plot, to its right legend or colour bar, sources below. It
 * is laid out on a surface that only measures, then drawn on each that is wanted. */
struct sheet {
    cairo_t *cr;
    const struct plot *q;
    bool draws;             /* false: measures only */
    double width, height;   /* [pixel] */
    double left, top, w, h; /* the plot */
    double right;           /* where legend or bar begin */
    double right_width, right_height;
    char line[LINES_MOST][LINE_BYTES]; /* of the subtitle */
    int n_line;
    struct ticks x, y, bar;
    struct colour_map map; /* of a map */
    double low, high;      /* its colours: errors */
};

/* Text of a size, grey or ink, bold or not; (x, y) is its left end on the baseline. Returns its width.
 * Nothing is drawn while the sheet only measures. */
enum shade { INK, GREY };
double sheet_text(struct sheet *s, double x, double y, double size, enum shade shade, bool bold,
                  const char *text);
void sheet_font(cairo_t *cr, double size, bool bold);
void sheet_ink(cairo_t *cr, enum shade shade);
double sheet_width(cairo_t *cr, const char *text);
/* Turned upwards, its middle at (x, y). */
void sheet_text_upward(struct sheet *s, double x, double y, const char *text);

/* Of series i: its colour, as the source; the path of its marker at (x, y). */
void series_colour(cairo_t *cr, const struct plot_series *s, size_t i);
void series_marker(cairo_t *cr, size_t i, double x, double y, double radius);
/* Draws the path of many markers. */
void series_markers_end(cairo_t *cr, const struct plot_series *s, size_t i);
void failed_marker(cairo_t *cr, double x, double y);

/* -- draw_plot.c, draw_legend.c, draw_map.c -------------------------------------------------------- */

double plot_x(const struct sheet *s, double value);
double plot_y(const struct sheet *s, double value);
void plot_lay_out(struct sheet *s);
void plot_draw(struct sheet *s);
/* Sets right_width and right_height; draws if the sheet does. */
void legend_draw(struct sheet *s);

int map_lay_out(struct sheet *s, struct error *e);
void map_draw(struct sheet *s);

#endif
