/* scene/fill.h -- from a scene's array to particles: positions, volumes, and initial fields. */
#ifndef SCENE_FILL_H
#define SCENE_FILL_H

#include "particles/particles.h"
#include "scene/scene.h"

/* Fills `p` for array `a`. The plan has added p's columns already (x, m, h, id and whatever the
 * scene's functions declare; the user's own columns too). Sets x, m, h, id (ids count on from
 * *next_id) and every field that a fill or the array gives: expressions of x, y, z, r (distance
 * from the origin), and of `spacing`. A field that names no column is an error with a
 * suggestion, except "rho", which always may be given: m = rho * spacing^dim unless "m" is, or
 * the fill's "mass"; with m alone, a column rho is set to m / spacing^dim (but is not marked as
 * given). Every fill gives the same properties. given[c] (length p->n_column) comes out true for
 * the columns that a field, a file or a user's own column set. Particles of different fills
 * nearer than a quarter of their spacing overlap: an error that names both fills. */
int fill_array(struct particles *p, const struct scene *s, size_t a, int64_t *next_id, bool *given,
               struct error *e);

/* After all arrays are filled: overlaps between different arrays. */
int fill_check_overlap(const struct particles *arrays, size_t n, const struct scene *s,
                       struct error *e);

/* How many particles it would make, without making them (for sph plan and the guard); for a
 * glass in a region that is not a box, about how many. Over the scene's limit is an error. */
int fill_count(const struct scene *s, size_t a, uint64_t *n, struct error *e);

#endif
