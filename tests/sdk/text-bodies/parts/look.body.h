/* look.body.h -- one pair. The mark is 1. */
sph_add(n, MEAN_OF(mark));
sph_take_min(nearest, r);
sph_take_max(farthest, r);
sph_take_max(largest, shade_j);
