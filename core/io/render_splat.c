/* render_splat.c -- particles as coloured cells: every point takes the colour of the particle that it
 * is nearest to, in units of the particle's size, within that size. So the order of the particles
 * does not matter, dense ones are not hidden, and there are no gaps where there are particles. */
#include "config.h"

#include "io/render_parts.h"

#include <math.h>
#include <stdlib.h>

#define REACH 0.9             /* as in render_data.c */
#define FINE_MOST 16000000.0 /* points */

struct canvas {
    int fine; /* points along a pixel: edges are smooth */
    int width, height; /* [points] */
    float *near;   /* [points] squared distance to the nearest, in units of its reach */
    float *colour; /* [points] of the map; NAN: no value; below -1: nothing there */
};

#define EMPTY (-8.0f)

/* One particle: a disc, or the disc that a plane cuts from a ball. All lengths in points. */
static void splat(struct canvas *c, double x, double y, double z, double reach, float colour)
{
    /* A disc smaller than a point is still a point. */
    const double r = fmax(reach, 0.75), r2 = r * r - fmin(z * z, r * r), flat = sqrt(r2);
    const int left = (int)fmax(ceil(x - flat - 0.5), 0);
    const int right = (int)fmin(floor(x + flat - 0.5), c->width - 1);
    const int top = (int)fmax(ceil(y - flat - 0.5), 0);
    const int bottom = (int)fmin(floor(y + flat - 0.5), c->height - 1);
    for (int j = top; j <= bottom; j++) {
        const double dy = j + 0.5 - y;
        for (int i = left; i <= right; i++) {
            const double dx = i + 0.5 - x, d2 = dx * dx + dy * dy;
            const size_t k = (size_t)j * (size_t)c->width + (size_t)i;
            const float d = (float)((d2 + z * z) / (r * r));
            if (d2 <= r2 && d < c->near[k]) {
                c->near[k] = d;
                c->colour[k] = colour;
            }
        }
    }
}

static void splat_all(struct canvas *c, const struct page *p, const struct picture_data *d)
{
    const double scale = c->fine * p->width / (p->max[0] - p->min[0]); /* points per length */
    for (size_t i = 0; i < d->n; i++) {
        const double *x = d->s->x + 3 * d->index[i];
        const double z = d->section ? (x[2] - d->plane) * scale : 0;
        const double t = picture_scale(d, d->value[i]);
        splat(c, (x[0] - p->min[0]) * scale, (p->max[1] - x[1]) * scale, z,
              REACH * d->size[i] * scale, isnan(t) ? NAN : (float)fmin(fmax(t, 0), 1));
    }
}

/* The mean colour of a pixel's points. */
static uint32_t pixel(const struct canvas *c, int i, int j, const struct colour_map *map)
{
    static const unsigned char white[3] = {255, 255, 255}, none[3] = {190, 190, 190};
    unsigned sum[3] = {0, 0, 0};
    for (int b = 0; b < c->fine; b++)
        for (int a = 0; a < c->fine; a++) {
            const size_t k = (size_t)(j * c->fine + b) * (size_t)c->width + (size_t)(i * c->fine + a);
            const float t = c->colour[k];
            const unsigned char *rgb = isnan(t) ? none : t < -1 ? white : colour_of(map, (double)t);
            for (int m = 0; m < 3; m++)
                sum[m] += rgb[m];
        }
    const unsigned n = (unsigned)(c->fine * c->fine);
    return (uint32_t)((sum[0] + n / 2) / n << 16 | (sum[1] + n / 2) / n << 8 | (sum[2] + n / 2) / n);
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
    c.width = (int)p->width * c.fine;
    c.height = (int)p->height * c.fine;
    const size_t n = (size_t)c.width * (size_t)c.height;
    c.near = malloc(n * sizeof *c.near);
    c.colour = malloc(n * sizeof *c.colour);
    int result = 0;
    if (c.near && c.colour) {
        for (size_t i = 0; i < n; i++) {
            c.near[i] = INFINITY;
            c.colour[i] = EMPTY;
        }
        splat_all(&c, p, d);
        paint(&c, p, map);
    } else {
        result = error_memory(e, "a picture", n * 2 * sizeof *c.near);
    }
    free(c.near);
    free(c.colour);
    return result;
}
