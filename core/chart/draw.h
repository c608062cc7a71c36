/* chart/draw.h -- what the parts of a picture's drawing share; for core/chart/draw*.c only. */
#ifndef CHART_DRAW_H
#define CHART_DRAW_H

#include "chart/plot.h"
#include "io/render_parts.h"
#include <stdio.h>

#define FONT 12.0 /* [pixel] of most texts */
#define FONT_SMALL 10.5
#define FONT_TITLE 17.0
#define AIR 16.0 /* [pixel] around everything */
#define LINES_MOST 12
#define LINE_BYTES 400

enum shade { INK, GREY, WHITE }; /* colours of texts */

/* The sheet: title and subtitle above, the plot, to its right legend or colour bar, sources below. It
 * is laid out on a surface that only measures, then drawn on each that is wanted. */
struct sheet {
    cairo_t *cr;
    const struct plot *q;
    bool draws;  /* false: measures only */
    FILE *texts; /* of SVG: texts are written as such, not as the outlines cairo makes of them */
    double size; /* of the font that is set */
    bool bold;
    enum shade shade;
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

/* The font of what is put next, and its colour. */
void sheet_font(struct sheet *s, double size, bool bold);
void sheet_ink(struct sheet *s, enum shade shade);
double sheet_width(const struct sheet *s, const char *text);
/* A text whose anchor, 0 ... 1 of its width and of its capitals' height, is at (x, y). */
void sheet_put(struct sheet *s, double x, double y, double anchor_x, double anchor_y,
               const char *text);
/* Turned upwards, its middle at (x, y). */
void sheet_put_upward(struct sheet *s, double x, double y, const char *text);
/* Font and colour and text at once; (x, y) is the left end on the baseline. Returns its width. Nothing
 * is drawn while the sheet only measures. */
double sheet_text(struct sheet *s, double x, double y, double size, enum shade shade, bool bold,
                  const char *text);

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
