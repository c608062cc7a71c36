/* io/render.h -- a picture of a snapshot: particles coloured by a column, axes with labels and units, a
 * colour bar, a title with the time; PNG by cairo. 1D scenes are drawn as graphs of the column over x. */
#ifndef IO_RENDER_H
#define IO_RENDER_H

#include "io/snapshot.h"

struct render_options {
    const char *field;    /* "rho", "v" (its length), "v.x"; NULL: rho, or the first column */
    const char *array;    /* NULL: all */
    const char *map;      /* colour map: "viridis" (default), "magma", "coolwarm", "grey" */
    double min, max;      /* NaN: from the data */
    int log_scale;
    int width, height;    /* pixels; 0: 900 x 800 or by the domain's aspect */
    double slice[2];      /* 3D: particles with z in this range; NaN: |z| below one smoothing length */
    double region_min[2], region_max[2]; /* NaN: all */
};
void render_defaults(struct render_options *o);
int render_png(const char *png, const struct snapshot *s, const struct render_options *o, struct error *e);

#endif
