/* place.body.h -- puts one particle where the path says. */
for (int c = 0; c < DIM; c++) {
    x[c] = c == 0 ? home[c] + way : home[c];
    v[c] = c == 0 ? speed : 0.0;
}
