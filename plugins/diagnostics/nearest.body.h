/* nearest.body.h -- one pair of the distance to the nearest: r; no particle meets itself here. */
sph_take_min(nearest, r);
