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

void sheet_font(struct sheet *s, double size, bool bold)
{
    s->size = size;
    s->bold = bold;
    cairo_select_font_face(s->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(s->cr, size);
}

static const unsigned char shades[] = {[INK] = 0x22, [GREY] = 0x6a, [WHITE] = 0xff};

void sheet_ink(struct sheet *s, enum shade shade)
{
    const double c = shades[shade] / 255.0;
    s->shade = shade;
    cairo_set_source_rgb(s->cr, c, c, c);
}

double sheet_width(const struct sheet *s, const char *text)
{
    cairo_text_extents_t extents;
    cairo_text_extents(s->cr, text, &extents);
    return extents.x_advance;
}

/* As characters of XML; it knows no control characters. */
static void put_escaped(FILE *f, const char *text)
{
    for (; *text; text++) {
        const char *name = *text == '&'   ? "&amp;"
                           : *text == '<' ? "&lt;"
                           : *text == '>' ? "&gt;"
                                          : NULL;
        if (name)
            fputs(name, f);
        else
            putc((unsigned char)*text < 0x20 ? ' ' : *text, f);
    }
}

/* A text of SVG, of the width that it was laid out with whatever font the reader has. */
static void put_text(struct sheet *s, double x, double y, bool upward, const char *text)
{
    const double width = sheet_width(s, text);
    if (!text[0])
        return;
    fprintf(s->texts, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%g\"", x, y, s->size);
    if (s->bold)
        fputs(" font-weight=\"bold\"", s->texts);
    if (s->shade != INK)
        fprintf(s->texts, " fill=\"#%02x%02x%02x\"", shades[s->shade], shades[s->shade],
                shades[s->shade]);
    if (upward)
        fprintf(s->texts, " transform=\"rotate(-90 %.1f %.1f)\"", x, y);
    fprintf(s->texts, " textLength=\"%.1f\">", width);
    put_escaped(s->texts, text);
    fputs("</text>\n", s->texts);
}

void sheet_put(struct sheet *s, double x, double y, double anchor_x, double anchor_y,
               const char *text)
{
    cairo_text_extents_t capital;
    cairo_text_extents(s->cr, "0", &capital);
    x -= anchor_x * sheet_width(s, text);
    y += anchor_y * capital.height;
    if (s->texts) {
        put_text(s, x, y, false, text);
    } else {
        cairo_move_to(s->cr, x, y);
        cairo_show_text(s->cr, text);
    }
}

void sheet_put_upward(struct sheet *s, double x, double y, const char *text)
{
    cairo_text_extents_t capital;
    cairo_text_extents(s->cr, "0", &capital);
    x += capital.height / 2;
    y += sheet_width(s, text) / 2;
    if (s->texts) {
        put_text(s, x, y, true, text);
        return;
    }
    cairo_save(s->cr);
    cairo_translate(s->cr, x, y);
    cairo_rotate(s->cr, -M_PI / 2);
    cairo_move_to(s->cr, 0, 0);
    cairo_show_text(s->cr, text);
    cairo_restore(s->cr);
}

double sheet_text(struct sheet *s, double x, double y, double size, enum shade shade, bool bold,
                  const char *text)
{
    sheet_font(s, size, bold);
    sheet_ink(s, shade);
    if (s->draws)
        sheet_put(s, x, y, 0, 0, text);
    return sheet_width(s, text);
}

/* Breaks a text at blanks to lines of at most `room` pixels, in the font that is set. */
static void break_lines(struct sheet *s, const char *text, double room)
{
    char line[LINE_BYTES] = "";
    while (*text && s->n_line < LINES_MOST) {
        const size_t word = strcspn(text, " ");
        char longer[LINE_BYTES];
        snprintf(longer, sizeof longer, "%s%s%.*s", line, line[0] ? " " : "", (int)word, text);
        if (line[0] && sheet_width(s, longer) > room) {
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

/* Where the results of others come from, below everything: the source of series i, or NULL. */
static const char *source(const struct plot *q, size_t i)
{
    return q->series[i].peer ? q->series[i].peer->source : NULL;
}

static size_t sources(const struct plot *q)
{
    size_t n = 0;
    for (size_t i = 0; i < q->n_series; i++)
        n += source(q, i) != NULL;
    return n;
}

static double foot_height(const struct plot *q)
{
    const size_t n = sources(q);
    return n ? 10 + 14 * (double)n : 0;
}

static double source_text(struct sheet *s, size_t i, double y)
{
    char text[LINE_BYTES];
    snprintf(text, sizeof text, "%s: %s", s->q->series[i].label, source(s->q, i));
    return sheet_text(s, AIR, y, FONT_SMALL, GREY, false, text);
}

static int lay_out(struct sheet *s, struct error *e)
{
    const bool map = s->q->p->kind == CHART_MAP;
    /* Sizes do not depend on where the plot stands: once to know them, then the head's height. */
    if (map && map_lay_out(s, e))
        return -1;
    if (!map)
        plot_lay_out(s);
    s->width = s->right + s->right_width + AIR;
    s->width = fmax(s->width, 2 * AIR + sheet_text(s, 0, 0, FONT_TITLE, INK, true, s->q->p->title));
    for (size_t i = 0; i < s->q->n_series; i++)
        if (source(s->q, i))
            s->width = fmax(s->width, 2 * AIR + source_text(s, i, 0));
    sheet_font(s, FONT, false);
    break_lines(s, s->q->subtitle, s->width - 2 * AIR);
    s->top = AIR + FONT_TITLE + 6 + LINE_HEIGHT * s->n_line + 14;
    const double below = map ? 0 : 48, plot = s->h + below;
    s->height = s->top + fmax(plot + (map ? 46 : 0), s->right_height) + foot_height(s->q) + AIR;
    s->width = ceil(s->width);
    s->height = ceil(s->height);
    return 0;
}

static void draw_sheet(struct sheet *s)
{
    cairo_set_source_rgb(s->cr, 1, 1, 1);
    cairo_paint(s->cr);
    s->draws = true;
    sheet_text(s, AIR, AIR + FONT_TITLE - 3, FONT_TITLE, INK, true, s->q->p->title);
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
    for (size_t i = 0; i < s->q->n_series; i++)
        if (source(s->q, i)) {
            source_text(s, i, y);
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

/* cairo numbers its surfaces, those of glyphs as well, through the process: nothing refers to this one,
 * and without its number the same picture is the same file. */
static void drop_number(char *drawn)
{
    static const char mark[] = " id=\"surface";
    char *at = strstr(drawn, mark);
    char *close = at ? strchr(at + sizeof mark, '"') : NULL;
    if (close)
        memmove(at, close + 1, strlen(close + 1) + 1);
}

/* What cairo drew, with the texts before its end. */
static int join(const struct output *o, const char *name, char *drawn, const char *texts,
                struct error *e)
{
    static const char end[] = "</svg>";
    drop_number(drawn);
    const size_t n = strlen(drawn);
    size_t at = n;
    while (at > 0 && strncmp(drawn + at, end, sizeof end - 1) != 0)
        at--;
    char *all =
        text_format("%.*s<g font-family=\"DejaVu Sans,Verdana,sans-serif\" fill=\"#222222\">"
                    "\n%s</g>\n%s\n",
                    (int)at, drawn, texts, end);
    const int status = all ? output_write(o, name, all, strlen(all), e) : error_memory(e, name, n);
    free(all);
    return status;
}

static cairo_status_t draw_svg(struct sheet *s, FILE *drawn)
{
    cairo_surface_t *surface =
        cairo_svg_surface_create_for_stream(to_stream, drawn, s->width, s->height);
    s->cr = context(surface);
    draw_sheet(s);
    cairo_status_t status = cairo_status(s->cr);
    cairo_destroy(s->cr);
    cairo_surface_finish(surface);
    status = status ? status : cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    return status;
}

static int write_svg(const struct sheet *layout, const struct output *o, const char *name,
                     struct error *e)
{
    struct sheet s = *layout;
    char *text = NULL, *texts = NULL;
    size_t size = 0, n_texts = 0;
    FILE *stream = open_memstream(&text, &size);
    s.texts = open_memstream(&texts, &n_texts);
    cairo_status_t status = CAIRO_STATUS_NO_MEMORY;
    if (stream && s.texts)
        status = draw_svg(&s, stream);
    bool closed = !stream || fclose(stream) == 0;
    closed = (!s.texts || fclose(s.texts) == 0) && closed;
    int result = 0;
    if (status || !closed)
        result = error_set(e, EXIT_RUN, "cannot draw %s: %s", name,
                           cairo_status_to_string(status ? status : CAIRO_STATUS_NO_MEMORY));
    else
        result = join(o, name, text, texts, e);
    free(text);
    free(texts);
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
