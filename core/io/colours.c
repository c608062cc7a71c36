/* colours.c -- colour maps. A few colours of each are given; between them we go straight in Oklab
 * (Ottosson 2020), where equal steps look equal. */
#include "config.h"

#include "io/colours.h"

#include "base/text.h"
#include <math.h>
#include <string.h>

#define ANCHORS_MOST 9
#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

struct recipe {
    const char *name;
    bool diverging;
    int n;
    unsigned rgb[ANCHORS_MOST]; /* 0xRRGGBB, evenly spaced */
};

static const struct recipe recipes[] = {
    {"viridis",
     false,
     9,
     {0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725}},
    {"magma",
     false,
     9,
     {0x000004, 0x1c1044, 0x4f127b, 0x812581, 0xb5367a, 0xe55964, 0xfb8761, 0xfec287, 0xfbfdbf}},
    {"coolwarm",
     true,
     9,
     {0x3b4cc0, 0x6282ea, 0x8db0fe, 0xb8d0f9, 0xdddddd, 0xf5c4ad, 0xf49a7b, 0xde604d, 0xb40426}},
    {"grey", false, 2, {0x101010, 0xf0f0f0}},
};

static double to_linear(double c)
{
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double from_linear(double c)
{
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

static void to_oklab(unsigned rgb, double lab[3])
{
    const double r = to_linear((double)(rgb >> 16 & 255) / 255);
    const double g = to_linear((double)(rgb >> 8 & 255) / 255);
    const double b = to_linear((double)(rgb & 255) / 255);
    const double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

static unsigned char to_byte(double linear)
{
    const double c = from_linear(linear > 0 ? linear : 0);
    return (unsigned char)lround(255 * (c < 1 ? c : 1));
}

static void from_oklab(const double lab[3], unsigned char rgb[3])
{
    const double l = pow(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2], 3);
    const double m = pow(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2], 3);
    const double s = pow(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2], 3);
    rgb[0] = to_byte(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s);
    rgb[1] = to_byte(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s);
    rgb[2] = to_byte(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s);
}

int colour_map_make(struct colour_map *map, const char *name, struct error *e)
{
    const struct recipe *r = name ? NULL : &recipes[0];
    for (size_t i = 0; i < COUNT(recipes) && !r; i++)
        if (strcmp(recipes[i].name, name) == 0)
            r = &recipes[i];
    if (!r) {
        const char *known[COUNT(recipes)];
        char hint[256];
        for (size_t i = 0; i < COUNT(recipes); i++)
            known[i] = recipes[i].name;
        return error_set(e, EXIT_USAGE, "there is no colour map \"%s\"%s", name,
                         text_suggest(hint, sizeof hint, name, known, COUNT(recipes)));
    }
    map->diverging = r->diverging;
    for (int i = 0; i < COLOURS; i++) {
        const double at = (double)i / (COLOURS - 1) * (r->n - 1);
        const int k = at < r->n - 2 ? (int)at : r->n - 2;
        double a[3], b[3], mix[3];
        to_oklab(r->rgb[k], a);
        to_oklab(r->rgb[k + 1], b);
        for (int c = 0; c < 3; c++)
            mix[c] = a[c] + (at - k) * (b[c] - a[c]);
        from_oklab(mix, map->rgb[i]);
    }
    return 0;
}

const unsigned char *colour_of(const struct colour_map *map, double t)
{
    if (!(t > 0))
        return map->rgb[0];
    return map->rgb[t < 1 ? (int)(t * (COLOURS - 1) + 0.5) : COLOURS - 1];
}
