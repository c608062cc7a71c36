/* damp.body.h -- for one particle: its place in the layer, and what is left of its velocity. */
/* A layer of no thickness is a step; from > to is a layer on the low side. */
const R s = from == to ? (x[0] >= to ? 1.0 : 0.0) : (x[0] - from) / (to - from);
const R inside = fmin(fmax(s, 0.0), 1.0);
const R left = exp(-inside * inside * b->dt / tau);
for (int c = 0; c < DIM; c++)
    v[c] *= left;
