/* still.body.h -- of one particle: its path's acceleration, and no heat. */
du = 0.0;
for (int c = 0; c < DIM; c++)
    a[c] = c == 0 ? acceleration : 0.0;
