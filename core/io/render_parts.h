/* io/render_parts.h -- what the parts of the renderer share; for core/io/render*.c, and for
 * core/chart/draw*.c, which takes texts, ticks and the PNG from here. */
#ifndef IO_RENDER_PARTS_H
#define IO_RENDER_PARTS_H

#include "io/colours.h"
#include "io/render.h"
#include <cairo.h>

/* -- render_data.c: what is drawn -------------------------------------------------------------- */

/* Half the gap that particles next to each other may leave, in units of their size. */
#define RENDER_REACH 1.7

struct picture_data {
    const struct snapshot *s;
    size_t n;         /* particles drawn */
    size_t *index;    /* [n] in the snapshot */
    double *value;    /* [n] of the field; NaN: none */
    double *size;     /* [n] spacing there: the side of the particle's volume */
    double low, high; /* of the colours or of the graph */
    bool log;
    bool below, above;     /* values lie beyond low, high */
    double min[2], max[2]; /* region: x, y */
    double plane;          /* 3D: z of the section */
    bool section;          /* 3D: cut through volumes, else seen from above */
    char label[160];       /* of the field, with its unit */
};

int picture_data_make(struct picture_data *d, const struct snapshot *s,
                      const struct render_options *o, bool diverging, struct error *e);
void picture_data_free(struct picture_data *d);
/* Where a value stands between low and high, 0 ... 1 and beyond; NaN for none. */
double picture_scale(const struct picture_data *d, double value);

/* -- render_text.c: numbers and names for people ----------------------------------------------- */

#define TICKS_MOST 24

struct ticks {
    int n;
    double at[TICKS_MOST];
    char text[TICKS_MOST][32];
    char factor[32]; /* "" or "×10⁻³": of all of them */
};

/* Ticks at round numbers of [low, high], at most `most`. */
void ticks_make(struct ticks *t, double low, double high, bool log, int most);
/* "kg/m^d" in 2D: "kg/m²". Returns out. */
const char *pretty_unit(char *out, size_t size, const char *unit, int dim);
/* "rho": "ρ"; others as they are. */
const char *pretty_name(const char *name);
/* "0.6", "−1.5×10⁻⁷" */
const char *pretty_number(char *out, size_t size, double value);

/* -- render_page.c: where everything is; title, axes, colour bar ------------------------------- */

struct page {
    cairo_surface_t *surface;
    cairo_t *cr;
    double font;                     /* [pixel] */
    double left, top, width, height; /* of the plot; whole pixels */
    double min[2], max[2];           /* what it shows */
    bool log;                        /* of the upward axis */
    struct ticks x, y, bar;
    double bar_left, bar_top, bar_width, bar_height; /* width 0: none */
    char x_label[80], y_label[160];
};

/* Lays the page out and makes its surface. Graphs have no colour bar and no equal aspect. */
int page_make(struct page *p, const struct picture_data *d, const struct render_options *o,
              bool graph, struct error *e);
void page_free(struct page *p);
/* Draws all but what is in the plot. map NULL: no colour bar. */
void page_draw(struct page *p, const struct picture_data *d, const struct render_options *o,
               const struct colour_map *map);
/* Pixel of a value on an axis. */
double page_x(const struct page *p, double x);
double page_y(const struct page *p, double y);
/* A text whose anchor, 0 ... 1 of its width and of its capitals' height, is at (x, y). */
void page_text(cairo_t *cr, double x, double y, double anchor_x, double anchor_y, const char *text);

/* -- What is in the plot ----------------------------------------------------------------------- */

int splat_draw(struct page *p, const struct picture_data *d, const struct colour_map *map,
               struct error *e);
int graph_draw(struct page *p, const struct picture_data *d, const struct render_options *o,
               struct error *e);

/* -- render_file.c: the PNG -------------------------------------------------------------------- */

int png_write(const char *path, cairo_surface_t *surface, struct error *e);

#endif
