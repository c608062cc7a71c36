/* border_inside.h -- the sweep compiled into the program that measures it. */
#ifndef BORDER_INSIDE_H
#define BORDER_INSIDE_H

#include <sph/batch.h>

sph_status border_inside(const sph_batch *b);

#endif
