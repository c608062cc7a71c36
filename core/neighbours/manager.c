/* neighbours/manager.c -- the table of neighbour managers, and which is the default. Pure. */
#include "neighbours/manager.h"

#include <string.h>

static const struct neighbour_manager table[] = {
    [NEIGHBOURS_BOXES] = {"boxes",
                          "bounding boxes over the particles in the order in which they stand, "
                          "eight under each; every box keeps the largest reach in it",
                          &manager_boxes},
    [NEIGHBOURS_CELLS] = {"cells",
                          "linked lists of the particles in the cells of a grid as wide as the "
                          "largest reach",
                          &manager_cells},
    [NEIGHBOURS_RADIX] = {"radix",
                          "particles sorted by the key of their cell, digit by digit; cells are "
                          "found among the sorted keys",
                          &manager_radix},
    [NEIGHBOURS_OCTREE] = {"octree",
                           "an octree (in 2D and 1D its like) in Morton order; every node keeps "
                           "the largest reach in it",
                           &manager_octree},
};

#define COUNT (sizeof table / sizeof table[0])

const struct neighbour_manager *neighbour_manager_at(size_t k)
{
    return k < COUNT ? &table[k] : NULL;
}

const struct neighbour_manager *neighbour_manager_find(const char *name)
{
    for (size_t k = 0; k < COUNT; k++) {
        if (strcmp(table[k].name, name) == 0) {
            return &table[k];
        }
    }
    return NULL;
}

const struct neighbour_manager *neighbour_manager_default(void)
{
    return &table[NEIGHBOURS_BOXES];
}
