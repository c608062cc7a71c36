/* render_layout.c -- the page of a picture: how large the letters are, where plot and colour bar
 * stand. Draws nothing. */
#include "config.h"

#include "io/render_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WIDTH_DEFAULT 900
#define PLOT_HEIGHT_MOST 900.0 /* [pixel] of a page whose height is ours to choose */
#define GRAPH_ASPECT 0.62

struct margins {
    double left, right, top, bottom;
};

static double widest_text(cairo_t *cr, const struct ticks *t)
{
    cairo_text_extents_t extents;
    double width = 0;
    for (int i = 0; i < t->n; i++) {
        cairo_text_extents(cr, t->text[i], &extents);
        width = fmax(width, extents.x_advance);
    }
    return width;
}

static void ticks_for(struct page *p, const struct picture_data *d, double width, double height)
{
    const double low = p->log ? d->low : p->min[1], high = p->log ? d->high : p->max[1];
    ticks_make(&p->x, p->min[0], p->max[0], false, (int)(width / (5.0 * p->font)));
    ticks_make(&p->y, low, high, p->log, (int)(height / (3.2 * p->font)));
    ticks_make(&p->bar, d->low, d->high, d->log,
               (int)(fmax(height, 9 * p->font) / (3.2 * p->font)));
}

/* What stands around the plot. */
static struct margins margins_of(const struct page *p, cairo_t *cr, bool graph)
{
    const double f = p->font;
    struct margins m;
    m.left = 0.8 * f + 1.6 * f + widest_text(cr, &p->y) + 0.9 * f;
    m.top = 3.0 * f + (*p->y.factor || *p->bar.factor ? 0.8 * f : 0);
    m.bottom = 4.2 * f;
    m.right = graph ? 1.6 * f : 1.2 * f + 1.3 * f + 0.9 * f + widest_text(cr, &p->bar) + 2.6 * f;
    return m;
}

/* Widens the region about its middle to what fits the plot at `scale` pixels per length. */
static void region_fit(struct page *p, double scale)
{
    const double side[2] = {p->width, p->height};
    for (int k = 0; k < 2; k++) {
        const double middle = 0.5 * (p->min[k] + p->max[k]), half = 0.5 * side[k] / scale;
        p->min[k] = middle - half;
        p->max[k] = middle + half;
    }
}

/* The plot of a map: one scale for both directions, as large as the room allows. Chooses the page's
 * height (and less width, for what is tall) where the caller does not. */
static void place_map(struct page *p, const struct margins *m, int *width, int *height,
                      bool free_width)
{
    const double dx = p->max[0] - p->min[0], dy = p->max[1] - p->min[1];
    const double bar_least = 9 * p->font, room_x = *width - m->left - m->right;
    const double room_y = *height ? *height - m->top - m->bottom : PLOT_HEIGHT_MOST;
    const double scale = fmin(room_x / dx, room_y / dy);
    p->width = fmax(floor(scale * dx + 1e-6), 16);
    p->height = fmax(floor(scale * dy + 1e-6), 16);
    region_fit(p, scale);
    if (!*height) {
        *height = (int)ceil(m->top + fmax(p->height, bar_least) + m->bottom);
        if (free_width && p->width < room_x)
            *width = (int)ceil(fmax(m->left + p->width + m->right, 28 * p->font));
    }
    const double spare_x = *width - m->left - m->right - p->width;
    const double spare_y = *height - m->top - m->bottom - p->height;
    p->left = floor(m->left + fmax(0.5 * spare_x, 0));
    p->top = floor(m->top + fmax(0.5 * spare_y, 0));
    p->bar_height = fmax(p->height, fmin(bar_least, p->height + fmax(spare_y, 0)));
    p->bar_top = floor(p->top + 0.5 * (p->height - p->bar_height));
    p->bar_width = floor(1.3 * p->font);
    p->bar_left = floor(p->left + p->width + 1.2 * p->font);
}

static void place_graph(struct page *p, const struct margins *m, int width, int height)
{
    p->left = floor(m->left);
    p->top = floor(m->top);
    p->width = floor(width - m->left - m->right);
    p->height = floor(height - m->top - m->bottom);
}

static void set_labels(struct page *p, const struct picture_data *d, bool graph)
{
    char unit[64];
    pretty_unit(unit, sizeof unit, d->s->x_unit, d->s->dim);
    const bool has_unit = *unit && strcmp(d->s->units, "none") != 0;
    snprintf(p->x_label, sizeof p->x_label, has_unit ? "x [%s]" : "x%s",
             unit + (has_unit ? 0 : strlen(unit)));
    if (graph)
        snprintf(p->y_label, sizeof p->y_label, "%s", d->label);
    else
        snprintf(p->y_label, sizeof p->y_label, "y%s", p->x_label + 1);
}

/* A graph shows the whole range with a little air. */
static void graph_range(struct page *p, const struct picture_data *d)
{
    const double air = d->log ? pow(d->high / d->low, 0.05) : 0.05 * (d->high - d->low);
    p->log = d->log;
    p->min[1] = d->log ? d->low / air : d->low - air;
    p->max[1] = d->log ? d->high * air : d->high + air;
}

static int size_check(const struct render_options *o, struct error *e)
{
    const int side[2] = {o->width, o->height};
    for (int k = 0; k < 2; k++)
        if (side[k] && (side[k] < RENDER_SIZE_LEAST || side[k] > RENDER_SIZE_MOST))
            return error_set(e, EXIT_USAGE, "a picture's %s is %d to %d pixels, not %d",
                             k ? "height" : "width", RENDER_SIZE_LEAST, RENDER_SIZE_MOST, side[k]);
    return 0;
}

static void use_font(cairo_t *cr, double size)
{
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size);
}

int page_make(struct page *p, const struct picture_data *d, const struct render_options *o,
              bool graph, struct error *e)
{
    *p = (struct page){0};
    if (size_check(o, e))
        return -1;
    int width = o->width ? o->width : WIDTH_DEFAULT, height = o->height;
    if (graph && !height)
        height = (int)fmax(GRAPH_ASPECT * width, RENDER_SIZE_LEAST);
    for (int k = 0; k < 2; k++) {
        p->min[k] = d->min[k];
        p->max[k] = d->max[k];
    }
    if (graph)
        graph_range(p, d);
    set_labels(p, d, graph);
    p->font = fmin(fmax(6 + 0.0105 * sqrt((double)width * (height ? height : 0.9 * width)), 8), 40);

    cairo_surface_t *probe = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1);
    cairo_t *cr = cairo_create(probe);
    use_font(cr, p->font);
    /* The margins follow from the ticks, whose number follows from the margins: twice is enough. */
    p->width = 0.75 * width;
    p->height = 0.75 * (height ? height : width);
    const double first[2] = {p->min[0], p->min[1]}, last[2] = {p->max[0], p->max[1]};
    for (int pass = 0, chosen = height, full = width; pass < 2; pass++) {
        ticks_for(p, d, p->width, p->height);
        const struct margins m = margins_of(p, cr, graph);
        for (int k = 0; k < 2; k++) {
            p->min[k] = first[k];
            p->max[k] = last[k];
        }
        height = chosen;
        width = full;
        if (graph)
            place_graph(p, &m, width, height);
        else
            place_map(p, &m, &width, &height, o->width == 0);
    }
    cairo_destroy(cr);
    cairo_surface_destroy(probe);
    if (p->width < 16 || p->height < 16)
        return error_set(e, EXIT_USAGE, "a picture of %d x %d pixels leaves no room for the plot",
                         width, height);
    ticks_for(p, d, p->width, p->height);
    p->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    p->cr = cairo_create(p->surface);
    if (cairo_status(p->cr))
        return error_memory(e, "a picture", 4ull * (unsigned)width * (unsigned)height);
    use_font(p->cr, p->font);
    cairo_set_source_rgb(p->cr, 1, 1, 1);
    cairo_paint(p->cr);
    return 0;
}

void page_free(struct page *p)
{
    if (p->cr)
        cairo_destroy(p->cr);
    if (p->surface)
        cairo_surface_destroy(p->surface);
    *p = (struct page){0};
}
