/* render.c -- a picture of a snapshot: puts the parts together (render_parts.h). */
#include "config.h"

#include "io/render.h"

#include "io/render_parts.h"
#include <math.h>

void render_defaults(struct render_options *o)
{
    const double none = (double)NAN;
    *o = (struct render_options){
        .min = none,
        .max = none,
        .slice = {none, none},
        .region_min = {none, none},
        .region_max = {none, none},
    };
}

static int draw(struct page *p, const struct picture_data *d, const struct render_options *o,
                const struct colour_map *map, bool graph, struct error *e)
{
    if (graph ? graph_draw(p, d, o, e) : splat_draw(p, d, map, e))
        return -1;
    page_draw(p, d, o, graph ? NULL : map);
    const cairo_status_t status = cairo_status(p->cr);
    if (status)
        return error_set(e, EXIT_RUN, "cannot draw the picture: %s",
                         cairo_status_to_string(status));
    return 0;
}

int render_png(const char *png, const struct snapshot *s, const struct render_options *o,
               struct error *e)
{
    const bool graph = s->dim == 1;
    struct colour_map map;
    struct picture_data data;
    struct page page = {0};
    if (colour_map_make(&map, o->map, e) ||
        picture_data_make(&data, s, o, map.diverging && !graph, e))
        return -1;
    int result = page_make(&page, &data, o, graph, e);
    if (result == 0)
        result = draw(&page, &data, o, &map, graph, e);
    if (result == 0)
        result = png_write(png, page.surface, e);
    page_free(&page);
    picture_data_free(&data);
    return result;
}
