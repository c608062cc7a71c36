/* chart/plot.h -- what a picture of a chart shows, before it is drawn: points by series, fits, the
 * front, ranges, words. */
#ifndef CHART_PLOT_H
#define CHART_PLOT_H

#include "chart/results.h"

#define PLOT_FRONT_MOST 40 /* members of the front that are named */

struct plot_series {
    char label[160], note[120];
    double *x, *y; /* of its finished runs */
    double *size;  /* their particles; NaN: not known */
    size_t n;
    size_t *line, n_line;          /* points that a line joins, by rising x */
    const struct chart_peer *peer; /* NULL: ours */
};

struct plot_failed {
    double x; /* NaN: not known */
    size_t series;
};

struct plot {
    const struct chart *c;
    const struct chart_picture *p;
    const struct results *s;
    struct plot_series *series;
    size_t n_series;
    struct plot_failed *failed;
    size_t n_failed;
    double *x, *y; /* of all finished runs that are ours, by run */
    size_t *run;
    size_t n;
    size_t *front, n_front;   /* into x, y, run */
    size_t *varied, n_varied; /* axes that tell the runs of this picture apart */
    size_t count[ROW_STATUSES], n_run, n_missing, n_zero;
    double low[2], high[2]; /* of the axes: x, y */
    char x_label[96], y_label[160], subtitle[640], failures[160];
};

int plot_make(struct plot *q, const struct chart *c, const struct chart_picture *p,
              const struct results *s, struct error *e);
void plot_free(struct plot *q);
/* "2 unstable, 1 timeout"; "" if none failed. Returns out. */
const char *plot_failures(const struct plot *q, char *out, size_t size);
/* A number for people, of so many digits: "0.012", "1800", "3.4×10⁻⁷". Returns out. */
const char *plot_number(char *out, size_t size, double value, int digits);
/* A measure for people: "core-seconds [s]"; an axis's name as it is. */
const char *plot_measure(const char *name);

/* -- draw.c: NAME.svg and NAME.png in the folder ------------------------------------------------- */

int plot_write(const struct plot *q, const struct output *o, struct error *e);

#endif
