/* chart/draw.c -- the sheet of a picture: its layout, its words, and the files it becomes, SVG and PNG
 * by the same drawing. */
#include "config.h"

#include "chart/draw.h"

#include "base/text.h"
#include <cairo-svg.h>
#include <stdlib.h>
#include <string.h>

#define PNG_SCALE 2.0
#define LINE_HEIGHT 16.0

/* -- Text ------------------------------------------------------------------------------------------ */

void sheet_font(cairo_t *cr, double size, bool bold)
{
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size);
}

void sheet_ink(cairo_t *cr, enum shade shade)
{
    const double c = shade == INK ? 0.13 : 0.42;
    cairo_set_source_rgb(cr, c, c, c);
}

double sheet_width(cairo_t *cr, const char *text)
{
    cairo_text_extents_t extents;
    cairo_text_extents(cr, text, &extents);
    return extents.x_advance;
}

double sheet_text(struct sheet *s, double x, double y, double size, enum shade shade, bool bold,
                  const char *text)
{
    sheet_font(s->cr, size, bold);
    sheet_ink(s->cr, shade);
    if (s->draws) {
        cairo_move_to(s->cr, x, y);
        cairo_show_text(s->cr, text);
    }
    return sheet_width(s->cr, text);
}

void sheet_text_upward(struct sheet *s, double x, double y, const char *text)
{
    cairo_save(s->cr);
    cairo_translate(s->cr, x, y);
    cairo_rotate(s->cr, -M_PI / 2);
    page_text(s->cr, 0, 0, 0.5, 0.5, text);
    cairo_restore(s->cr);
}

/* Breaks a text at blanks to lines of at most `room` pixels, in the font that is set. */
static void break_lines(struct sheet *s, const char *text, double room)
{
    char line[LINE_BYTES] = "";
    while (*text && s->n_line < LINES_MOST) {
        const size_t word = strcspn(text, " ");
        char longer[LINE_BYTES];
        snprintf(longer, sizeof longer, "%s%s%.*s", line, line[0] ? " " : "", (int)word, text);
        if (line[0] && sheet_width(s->cr, longer) > room) {
            snprintf(s->line[s->n_line++], LINE_BYTES, "%s", line);
            snprintf(line, sizeof line, "%.*s", (int)word, text);
        } else {
            memcpy(line, longer, sizeof line);
        }
        text += word;
        text += strspn(text, " ");
    }
    if (line[0] && s->n_line < LINES_MOST)
        snprintf(s->line[s->n_line++], LINE_BYTES, "%s", line);
}

/* -- Layout ---------------------------------------------------------------------------------------- */

/* Where the results of others come from, below everything. */
static size_t sources(const struct plot *q)
{
    size_t n = 0;
    for (size_t i = 0; i < q->c->n_peer && q->p->kind != CHART_MAP; i++)
        n += q->c->peer[i].source != NULL;
    return n;
}

static double foot_height(const struct plot *q)
{
    const size_t n = sources(q);
    return n ? 10 + 14 * (double)n : 0;
}

static double source_text(struct sheet *s, const struct chart_peer *p, double y)
{
    char text[LINE_BYTES];
    snprintf(text, sizeof text, "%s: %s", p->label, p->source);
    return sheet_text(s, AIR, y, FONT_SMALL, GREY, false, text);
}

static int lay_out(struct sheet *s, struct error *e)
{
    const bool map = s->q->p->kind == CHART_MAP;
    /* Sizes do not depend on where the plot stands: once to know them, then the head's height. */
    if (map && map_lay_out(s, e))
        return -1;
    if (!map) {
        plot_lay_out(s);
        legend_draw(s);
    }
    s->width = s->right + s->right_width + AIR;
    s->width = fmax(s->width, 2 * AIR + sheet_text(s, 0, 0, FONT_TITLE, INK, true, s->q->c->title));
    for (size_t i = 0; i < s->q->c->n_peer && sources(s->q); i++)
        if (s->q->c->peer[i].source)
            s->width = fmax(s->width, 2 * AIR + source_text(s, &s->q->c->peer[i], 0));
    sheet_font(s->cr, FONT, false);
    break_lines(s, s->q->subtitle, s->width - 2 * AIR);
    s->top = AIR + FONT_TITLE + 6 + LINE_HEIGHT * s->n_line + 14;
    const double below = map ? 0 : 48, plot = s->h + below;
    s->height = s->top + fmax(plot + (map ? 62 : 0), s->right_height) + foot_height(s->q) + AIR;
    s->width = ceil(s->width);
    s->height = ceil(s->height);
    return 0;
}

static void draw_sheet(struct sheet *s)
{
    cairo_set_source_rgb(s->cr, 1, 1, 1);
    cairo_paint(s->cr);
    s->draws = true;
    sheet_text(s, AIR, AIR + FONT_TITLE - 3, FONT_TITLE, INK, true, s->q->c->title);
    for (int i = 0; i < s->n_line; i++)
        sheet_text(s, AIR, AIR + FONT_TITLE + 2 + LINE_HEIGHT * (i + 1), FONT, GREY, false,
                   s->line[i]);
    if (s->q->p->kind == CHART_MAP) {
        map_draw(s);
    } else {
        plot_draw(s);
        legend_draw(s);
    }
    double y = s->height - foot_height(s->q) - AIR + 20;
    for (size_t i = 0; i < s->q->c->n_peer && sources(s->q); i++)
        if (s->q->c->peer[i].source) {
            source_text(s, &s->q->c->peer[i], y);
            y += 14;
        }
}

/* -- Files ------------------------------------------------------------------------------------------- */

/* Text is measured alike at every scale: the layout holds for both files. */
static cairo_t *context(cairo_surface_t *surface)
{
    cairo_t *cr = cairo_create(surface);
    cairo_font_options_t *o = cairo_font_options_create();
    cairo_font_options_set_hint_metrics(o, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_hint_style(o, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_antialias(o, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr, o);
    cairo_font_options_destroy(o);
    return cr;
}

static cairo_status_t to_stream(void *stream, const unsigned char *data, unsigned n)
{
    return fwrite(data, 1, n, stream) == n ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static int write_svg(const struct sheet *layout, const struct output *o, const char *name,
                     struct error *e)
{
    struct sheet s = *layout;
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return error_memory(e, name, 1);
    cairo_surface_t *surface =
        cairo_svg_surface_create_for_stream(to_stream, stream, s.width, s.height);
    s.cr = context(surface);
    draw_sheet(&s);
    cairo_status_t status = cairo_status(s.cr);
    cairo_destroy(s.cr);
    cairo_surface_finish(surface);
    status = status ? status : cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    int result = fclose(stream) ? error_memory(e, name, size) : 0;
    if (!result && status)
        result = error_set(e, EXIT_RUN, "cannot draw %s: %s", name, cairo_status_to_string(status));
    if (!result)
        result = output_write(o, name, text, size, e);
    free(text);
    return result;
}

static int write_png(const struct sheet *layout, const struct output *o, const char *name,
                     struct error *e)
{
    struct sheet s = *layout;
    cairo_surface_t *surface = cairo_image_surface_create(
        CAIRO_FORMAT_RGB24, (int)(PNG_SCALE * s.width), (int)(PNG_SCALE * s.height));
    s.cr = context(surface);
    cairo_scale(s.cr, PNG_SCALE, PNG_SCALE);
    draw_sheet(&s);
    const cairo_status_t status = cairo_status(s.cr);
    cairo_destroy(s.cr);
    char *path = output_path(o, name);
    int result = 0;
    if (status)
        result = error_set(e, EXIT_RUN, "cannot draw %s: %s", name, cairo_status_to_string(status));
    else if (!path)
        result = error_memory(e, "a path", 1);
    else
        result = png_write(path, surface, e);
    cairo_surface_destroy(surface);
    free(path);
    return result;
}

int plot_write(const struct plot *q, const struct output *o, struct error *e)
{
    struct sheet s = {.q = q};
    cairo_surface_t *measure = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1);
    s.cr = context(measure);
    int status = lay_out(&s, e);
    cairo_destroy(s.cr);
    cairo_surface_destroy(measure);
    char *svg = text_format("%s.svg", q->p->name), *png = text_format("%s.png", q->p->name);
    if (!status && (!svg || !png))
        status = error_memory(e, "a path", 1);
    if (!status)
        status = write_svg(&s, o, svg, e) || write_png(&s, o, png, e) ? -1 : 0;
    free(svg);
    free(png);
    return status;
}
