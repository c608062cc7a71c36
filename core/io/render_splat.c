/* render_splat.c -- particles as coloured cells: every point takes the colour of the particle
 * that it is nearest to, in units of the particle's size. So the order of the particles does not
 * matter and dense ones are not hidden. Far from particles nothing is drawn; a gap between
 * particles (they lie unevenly where a flow has squeezed them one way) is closed, the edge of
 * the whole is not moved. */
#include "config.h"

#include "io/render_parts.h"

#include <math.h>
#include <stdlib.h>

#define REACH_OPEN 0.7 /* drawn in any case, in units of the particle's size: half a diagonal */
#define FINE_MOST 6000000.0 /* points */
#define PAD_MOST 100.0      /* pixels */

struct canvas {
    int fine;          /* points along a pixel: edges are smooth */
    int pad;           /* points around the plot, so that its border is no edge */
    int width, height; /* [points], with the padding */
    float *near;       /* [points] squared distance to the nearest, in units of its reach */
    float *colour;     /* [points] of the map; NAN: no value; EMPTY: nothing there */
    float *size;       /* [points] of the nearest */
    float *inside;     /* [points] distance to the nearest where nothing is [points] */
};

#define EMPTY (-8.0f)

/* One particle: a disc, or the disc that a plane cuts from a ball. All lengths in points. */
static void splat(struct canvas *c, const double x[3], double size, float colour)
{
    /* However small, a particle is seen. */
    const double r = fmax(RENDER_REACH * size, 0.6 * c->fine);
    const double r2 = r * r - fmin(x[2] * x[2], r * r), flat = sqrt(r2);
    const int left = (int)fmax(ceil(x[0] - flat - 0.5), 0);
    const int right = (int)fmin(floor(x[0] + flat - 0.5), c->width - 1);
    const int top = (int)fmax(ceil(x[1] - flat - 0.5), 0);
    const int bottom = (int)fmin(floor(x[1] + flat - 0.5), c->height - 1);
    for (int j = top; j <= bottom; j++) {
        const double dy = j + 0.5 - x[1];
        for (int i = left; i <= right; i++) {
            const double dx = i + 0.5 - x[0], d2 = dx * dx + dy * dy;
            const size_t k = (size_t)j * (size_t)c->width + (size_t)i;
            const float d = (float)((d2 + x[2] * x[2]) / (r * r));
            if (d2 <= r2 && d < c->near[k]) {
                c->near[k] = d;
                c->colour[k] = colour;
                c->size[k] = (float)(r / RENDER_REACH);
            }
        }
    }
}

static void splat_all(struct canvas *c, const struct page *p, const struct picture_data *d)
{
    const double scale = c->fine * p->width / (p->max[0] - p->min[0]); /* points per length */
    for (size_t i = 0; i < d->n; i++) {
        const double *at = d->s->x + 3 * d->index[i];
        const double x[3] = {(at[0] - p->min[0]) * scale + c->pad,
                             (p->max[1] - at[1]) * scale + c->pad,
                             d->section ? (at[2] - d->plane) * scale : 0};
        const double t = picture_scale(d, d->value[i]);
        splat(c, x, d->size[i] * scale, isnan(t) ? NAN : (float)fmin(fmax(t, 0), 1));
    }
}

static void shorten(struct canvas *c, int i, int j, int di, int dj, float step)
{
    if (i + di < 0 || i + di >= c->width || j + dj < 0 || j + dj >= c->height)
        return;
    const float d = c->inside[(size_t)(j + dj) * (size_t)c->width + (size_t)(i + di)] + step;
    float *mine = &c->inside[(size_t)j * (size_t)c->width + (size_t)i];
    if (d < *mine)
        *mine = d;
}

/* How far inside each point is, by two passes over the neighbours (Borgefors 1986; errs by 4 %). */
static void measure_inside(struct canvas *c)
{
    const float side = 0.955f, diagonal = 1.369f;
    for (size_t k = 0; k < (size_t)c->width * (size_t)c->height; k++)
        c->inside[k] = c->colour[k] == EMPTY ? 0 : INFINITY;
    for (int j = 0; j < c->height; j++)
        for (int i = 0; i < c->width; i++) {
            shorten(c, i, j, -1, 0, side);
            shorten(c, i, j, 0, -1, side);
            shorten(c, i, j, -1, -1, diagonal);
            shorten(c, i, j, 1, -1, diagonal);
        }
    for (int j = c->height - 1; j >= 0; j--)
        for (int i = c->width - 1; i >= 0; i--) {
            shorten(c, i, j, 1, 0, side);
            shorten(c, i, j, 0, 1, side);
            shorten(c, i, j, 1, 1, diagonal);
            shorten(c, i, j, -1, 1, diagonal);
        }
}

/* Takes back what is drawn beyond the edges: near nothing, and far from its particle. */
static void trim(struct canvas *c)
{
    const float open = (float)(REACH_OPEN / RENDER_REACH);
    measure_inside(c);
    for (size_t k = 0; k < (size_t)c->width * (size_t)c->height; k++)
        if (c->near[k] > open * open &&
            c->inside[k] <= (float)(RENDER_REACH - REACH_OPEN) * c->size[k])
            c->colour[k] = EMPTY;
}

/* The mean colour of a pixel's points. */
static uint32_t pixel(const struct canvas *c, int i, int j, const struct colour_map *map)
{
    static const unsigned char white[3] = {255, 255, 255}, none[3] = {190, 190, 190};
    unsigned sum[3] = {0, 0, 0};
    for (int b = 0; b < c->fine; b++)
        for (int a = 0; a < c->fine; a++) {
            const size_t row = (size_t)(c->pad + j * c->fine + b);
            const size_t k = row * (size_t)c->width + (size_t)(c->pad + i * c->fine + a);
            const float t = c->colour[k];
            const unsigned char *rgb = isnan(t)     ? none
                                       : t == EMPTY ? white
                                                    : colour_of(map, (double)t);
            for (int m = 0; m < 3; m++)
                sum[m] += rgb[m];
        }
    const unsigned n = (unsigned)(c->fine * c->fine);
    return (uint32_t)((sum[0] + n / 2) / n << 16 | (sum[1] + n / 2) / n << 8 |
                      (sum[2] + n / 2) / n);
}

static void paint(const struct canvas *c, struct page *p, const struct colour_map *map)
{
    cairo_surface_flush(p->surface);
    unsigned char *data = cairo_image_surface_get_data(p->surface);
    const size_t stride = (size_t)cairo_image_surface_get_stride(p->surface);
    for (int j = 0; j < (int)p->height; j++) {
        uint32_t *row = (uint32_t *)(void *)(data + (size_t)((int)p->top + j) * stride);
        for (int i = 0; i < (int)p->width; i++)
            row[(int)p->left + i] = pixel(c, i, j, map);
    }
    cairo_surface_mark_dirty(p->surface);
}

int splat_draw(struct page *p, const struct picture_data *d, const struct colour_map *map,
               struct error *e)
{
    struct canvas c = {.fine = 3};
    while (c.fine > 1 && p->width * p->height * c.fine * c.fine > FINE_MOST)
        c.fine--;
    double largest = 0;
    for (size_t i = 0; i < d->n; i++)
        largest = fmax(largest, d->size[i]);
    largest *= c.fine * p->width / (p->max[0] - p->min[0]);
    c.pad = (int)fmin(ceil(2 * RENDER_REACH * largest), PAD_MOST * c.fine);
    c.width = (int)p->width * c.fine + 2 * c.pad;
    c.height = (int)p->height * c.fine + 2 * c.pad;
    const size_t n = (size_t)c.width * (size_t)c.height;
    c.near = malloc(4 * n * sizeof *c.near);
    if (!c.near)
        return error_memory(e, "a picture", 4 * n * sizeof *c.near);
    c.colour = c.near + n;
    c.size = c.colour + n;
    c.inside = c.size + n;
    for (size_t i = 0; i < n; i++) {
        c.near[i] = INFINITY;
        c.colour[i] = EMPTY;
        c.size[i] = 0;
    }
    splat_all(&c, p, d);
    trim(&c);
    paint(&c, p, map);
    free(c.near);
    return 0;
}
