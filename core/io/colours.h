/* io/colours.h -- colour maps: numbers in [0, 1] to colours. */
#ifndef IO_COLOURS_H
#define IO_COLOURS_H

#include "base/error.h"
#include <stdbool.h>

#define COLOURS 256

struct colour_map {
    unsigned char rgb[COLOURS][3]; /* sRGB */
    bool diverging;                /* its middle stands for zero */
};

/* By name; NULL: "viridis". An unknown one is an error with the nearest known. */
int colour_map_make(struct colour_map *map, const char *name, struct error *e);
/* Of t in [0, 1]; what is outside takes the nearest end. */
const unsigned char *colour_of(const struct colour_map *map, double t);

#endif
