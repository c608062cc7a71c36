/* scene/shape.h -- solid geometry: boxes, spheres, cylinders, half-spaces, and their union,
 * intersection and difference, as a tree with an inside test and bounds. */
#ifndef SCENE_SHAPE_H
#define SCENE_SHAPE_H

#include "base/error.h"
#include "scene/json.h"
#include <stdbool.h>

struct shape;

/* From {"box": {"min": [..], "max": [..]}}, {"sphere": {"center": [..], "radius": r}} (a disc in
 * 2D, an interval in 1D), {"cylinder": {"center": [..], "axis": [..], "radius": r, "length": l}}
 * (3D), {"half-space": {"point": [..], "normal": [..]}} (the normal points out of it), {"union":
 * [..]}, {"intersection": [..]}, {"difference": [a, b, ...]}. */
int shape_compile(struct shape **out, const struct document *d, const cJSON *node, int dim,
                  struct error *e);
void shape_free(struct shape *s);
/* Lower faces belong to it, upper do not, so that boxes side by side share no point. */
bool shape_inside(const struct shape *s, const double x[3]);
/* Bounds (infinite where there are none); false if it is unbounded (the caller intersects with the
 * domain). */
bool shape_bounds(const struct shape *s, double min[3], double max[3]);

/* Whether it is one box, so that everything within its bounds belongs to it. */
bool shape_is_box(const struct shape *s);

#endif
