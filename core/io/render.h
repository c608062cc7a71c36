/* io/render.h -- a picture of a snapshot: particles coloured by a column, axes with labels and
 * units, a colour bar, a title with the time; PNG by cairo. 1D scenes are drawn as graphs of the
 * column over x. */
#ifndef IO_RENDER_H
#define IO_RENDER_H

#include "io/snapshot.h"

struct render_options {
    const char *field; /* "rho", "v" (its length), "v.x"; NULL: rho, or the first column */
    const char *array; /* NULL: all */
    const char *map;   /* colour map: "viridis" (default), "magma", "coolwarm", "grey" */
    double min, max;   /* NaN: from the data */
    int log_scale;
    int width, height; /* pixels; 0: 900 wide, as high as the domain's aspect asks for */
    double slice[2];   /* 3D: particles with z in this range, seen from above; NaN: a section at
                           * z = 0 (or the middle) through the particles' volumes */
    double region_min[2], region_max[2]; /* NaN: all */
};

#define RENDER_SIZE_LEAST 120
#define RENDER_SIZE_MOST 16384

void render_defaults(struct render_options *o);
/* Written aside and renamed (io/output.h). A field, array or map that is not there is an error
 * of the command line, with the nearest that is; so is a picture with nothing in it. */
int render_png(const char *png, const struct snapshot *s, const struct render_options *o,
               struct error *e);

#endif
