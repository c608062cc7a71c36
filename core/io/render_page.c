/* render_page.c -- what stands around a plot: title, axes, colour bar. */
#include "config.h"

#include "io/render_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

double page_x(const struct page *p, double x)
{
    return p->left + (x - p->min[0]) / (p->max[0] - p->min[0]) * p->width;
}

double page_y(const struct page *p, double y)
{
    const double t = p->log ? log(y / p->min[1]) / log(p->max[1] / p->min[1])
                            : (y - p->min[1]) / (p->max[1] - p->min[1]);
    return p->top + (1 - t) * p->height;
}

void page_text(cairo_t *cr, double x, double y, double anchor_x, double anchor_y, const char *text)
{
    cairo_text_extents_t extents, capital;
    cairo_text_extents(cr, text, &extents);
    cairo_text_extents(cr, "0", &capital);
    cairo_move_to(cr, x - anchor_x * extents.x_advance, y + anchor_y * capital.height);
    cairo_show_text(cr, text);
}

static void text_upward(cairo_t *cr, double x, double y, const char *text)
{
    cairo_save(cr);
    cairo_translate(cr, x, y);
    cairo_rotate(cr, -M_PI / 2);
    page_text(cr, 0, 0, 0.5, 1, text);
    cairo_restore(cr);
}

static double text_width(cairo_t *cr, const char *text)
{
    cairo_text_extents_t extents;
    cairo_text_extents(cr, text, &extents);
    return extents.x_advance;
}

static void ink(cairo_t *cr)
{
    cairo_set_source_rgb(cr, 0.13, 0.13, 0.13);
}

/* Lines of whole pixels: a width that is, and a middle that fits it. */
static double line_width(const struct page *p)
{
    return fmax(1, floor(p->font / 14 + 0.25));
}

static double crisp(double x, double width)
{
    return fmod(width, 2) > 0.5 ? floor(x) + 0.5 : round(x);
}

static void line(cairo_t *cr, double x0, double y0, double x1, double y1)
{
    cairo_move_to(cr, x0, y0);
    cairo_line_to(cr, x1, y1);
}

/* The frame lies around the plot's pixels, not on them. */
static void draw_frame(const struct page *p, double left, double top, double width, double height)
{
    const double w = line_width(p);
    cairo_set_line_width(p->cr, w);
    cairo_rectangle(p->cr, left - w / 2, top - w / 2, width + w, height + w);
    cairo_stroke(p->cr);
}

static void draw_axes(const struct page *p)
{
    cairo_t *cr = p->cr;
    const double f = p->font, w = line_width(p), tick = 0.35 * f;
    const double bottom = p->top + p->height + w, left = p->left - w;
    for (int i = 0; i < p->x.n; i++) {
        const double x = crisp(page_x(p, p->x.at[i]), w);
        line(cr, x, bottom, x, bottom + tick);
        page_text(cr, x, bottom + tick + 0.35 * f, 0.5, 1, p->x.text[i]);
    }
    for (int i = 0; i < p->y.n; i++) {
        const double y = crisp(page_y(p, p->y.at[i]), w);
        line(cr, left, y, left - tick, y);
        page_text(cr, left - tick - 0.35 * f, y, 1, 0.5, p->y.text[i]);
    }
    cairo_set_line_width(cr, w);
    cairo_stroke(cr);
    draw_frame(p, p->left, p->top, p->width, p->height);
    page_text(cr, p->left + p->width / 2, bottom + tick + 2.0 * f, 0.5, 1, p->x_label);
    page_text(cr, p->left + p->width, bottom + tick + 2.0 * f, 1, 1, p->x.factor);
    page_text(cr, p->left, p->top - 0.6 * f, 0.6, 0, p->y.factor);
    double widest = 0;
    for (int i = 0; i < p->y.n; i++)
        widest = fmax(widest, text_width(cr, p->y.text[i]));
    text_upward(cr, left - tick - 0.35 * f - widest - 1.5 * f, p->top + p->height / 2, p->y_label);
}

/* A triangle at an end of the bar: there are values beyond it. */
static void draw_beyond(const struct page *p, const unsigned char *rgb, bool above)
{
    const double w = p->bar_width, x = p->bar_left, tall = 0.5 * w;
    const double y = above ? p->bar_top : p->bar_top + p->bar_height;
    cairo_move_to(p->cr, x, y);
    cairo_line_to(p->cr, x + w / 2, above ? y - tall : y + tall);
    cairo_line_to(p->cr, x + w, y);
    cairo_close_path(p->cr);
    cairo_set_source_rgb(p->cr, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
    cairo_fill_preserve(p->cr);
    ink(p->cr);
    cairo_set_line_width(p->cr, line_width(p));
    cairo_stroke(p->cr);
}

/* A label of the bar, smaller if the bar is too short for it. */
static void draw_bar_label(const struct page *p, double x, const char *text)
{
    cairo_t *cr = p->cr;
    const double room = p->bar_height + 4 * p->font, width = text_width(cr, text);
    cairo_save(cr);
    if (width > room)
        cairo_set_font_size(cr, fmax(p->font * room / width, 6));
    text_upward(cr, x, p->bar_top + p->bar_height / 2, text);
    cairo_restore(cr);
}

static void draw_bar(const struct page *p, const struct picture_data *d,
                     const struct colour_map *map)
{
    cairo_t *cr = p->cr;
    const double f = p->font, w = line_width(p), right = p->bar_left + p->bar_width + w;
    const int rows = (int)p->bar_height;
    for (int j = 0; j < rows; j++) {
        const unsigned char *rgb = colour_of(map, 1 - (j + 0.5) / rows);
        cairo_set_source_rgb(cr, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
        cairo_rectangle(cr, p->bar_left, p->bar_top + j, p->bar_width, 1);
        cairo_fill(cr);
    }
    ink(cr);
    draw_frame(p, p->bar_left, p->bar_top, p->bar_width, rows);
    double widest = 0;
    for (int i = 0; i < p->bar.n; i++) {
        const double t = picture_scale(d, p->bar.at[i]);
        const double y = crisp(p->bar_top + (1 - t) * rows, w);
        line(cr, right, y, right + 0.3 * f, y);
        page_text(cr, right + 0.6 * f, y, 0, 0.5, p->bar.text[i]);
        widest = fmax(widest, text_width(cr, p->bar.text[i]));
    }
    cairo_stroke(cr);
    page_text(cr, p->bar_left, p->bar_top - 0.9 * f, 0, 0, p->bar.factor);
    draw_bar_label(p, right + 0.6 * f + widest + 0.7 * f, d->label);
    if (d->below)
        draw_beyond(p, colour_of(map, 0), false);
    if (d->above)
        draw_beyond(p, colour_of(map, 1), true);
}

/* The longest beginning of the text that fits, "…" behind it if it is not all. */
static void fit_text(cairo_t *cr, char *out, size_t size, const char *text, double room)
{
    snprintf(out, size - 4, "%s", text);
    size_t n = strlen(out);
    bool cut = strlen(text) > n;
    while (n > 0 && (cut || text_width(cr, out) > room)) {
        if (cut && text_width(cr, out) <= room)
            break;
        n = strlen(out) - (cut ? strlen("…") : 0);
        if (n == 0 || n > strlen(out))
            break;
        do
            n--;
        while (n > 0 && ((unsigned char)out[n] & 0xC0) == 0x80);
        snprintf(out + n, size - n, "…");
        cut = true;
    }
}

/* "t = 0.6 s,  z = 0" */
static void put_when(char *out, size_t size, const struct picture_data *d,
                     const struct render_options *o)
{
    char t[64], a[64], b[64];
    const char *unit = strcasecmp(d->s->units, "SI") == 0 ? " s" : "";
    int n = snprintf(out, size, "t = %s%s", pretty_number(t, sizeof t, d->s->time), unit);
    if (d->s->dim == 3 && d->section)
        snprintf(out + n, size - (size_t)n, ",  z = %s", pretty_number(a, sizeof a, d->plane));
    else if (d->s->dim == 3)
        snprintf(out + n, size - (size_t)n, ",  z = %s … %s",
                 pretty_number(a, sizeof a, o->slice[0]), pretty_number(b, sizeof b, o->slice[1]));
}

static void draw_title(const struct page *p, const struct picture_data *d,
                       const struct render_options *o)
{
    cairo_t *cr = p->cr;
    const double f = p->font, above = *p->y.factor || *p->bar.factor ? 1.9 * f : 1.1 * f;
    const double y = fmin(p->top, p->bar_width > 0 ? p->bar_top : p->top) - above;
    const double width = cairo_image_surface_get_width(p->surface);
    char when[256], title[512];
    put_when(when, sizeof when, d, o);
    const double when_width = text_width(cr, when);
    const double right = fmin(fmax(p->left + p->width, p->left + 20 * f), width - 0.8 * f);
    page_text(cr, right, y, 1, 0, when);
    cairo_save(cr);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    fit_text(cr, title, sizeof title, d->s->title, right - when_width - 1.5 * f - p->left);
    page_text(cr, p->left, y, 0, 0, title);
    cairo_restore(cr);
}

void page_draw(struct page *p, const struct picture_data *d, const struct render_options *o,
               const struct colour_map *map)
{
    ink(p->cr);
    draw_title(p, d, o);
    draw_axes(p);
    if (map)
        draw_bar(p, d, map);
}
