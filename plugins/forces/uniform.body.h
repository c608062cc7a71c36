/* uniform.body.h -- a += g, with the potential -g.x. */
const R g[3] = {gx, gy, gz};
phi = 0.0;
for (int c = 0; c < DIM; c++) {
    a[c] += g[c];
    phi -= g[c] * x[c];
}
