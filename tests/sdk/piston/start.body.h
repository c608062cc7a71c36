/* start.body.h -- of one particle, what it remembers of the start. */
volume = m / rho;
for (int c = 0; c < DIM; c++) {
    home[c] = c == 0 ? x[c] - way : x[c];
    v[c] = c == 0 ? speed : 0.0;
}
