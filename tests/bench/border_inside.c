/* border_inside.c -- the sweep as part of the program. */
#include "border_inside.h"

#include "border_sweep.h"

sph_status border_inside(const sph_batch *b)
{
    return border_sweep(b);
}
