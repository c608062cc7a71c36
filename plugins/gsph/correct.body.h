/* correct.body.h -- of one particle, from the sums over its pairs to the gradients: times the inverse of the
 * moment matrix, which is symmetric and positive. */
R trace = 0.0;
for (int k = 0; k < DIM; k++)
    trace += moment[k * DIM + k];
/* Both are sums of -r w'(q): one over the neighbours' volumes, one over the particle's own. */
volume = trace > 0.0 ? 1.0 + share *(volume / (rho * trace) - 1.0) : 1.0;
if (trace > 0.0) { /* else nobody is near: the sums are 0, and so are the gradients */
    R a[9], inverse[9];
    for (int k = 0; k < DIM * DIM; k++)
        a[k] = moment[k];
    /* The ridge keeps a particle with too few neighbours finite, its gradient small. */
    for (int k = 0; k < DIM; k++)
        a[k * DIM + k] += 1e-10 * trace + 1e-300;
    /* By cofactors. */
    if (DIM == 1) {
        inverse[0] = 1.0 / a[0];
    } else if (DIM == 2) {
        const R s = 1.0 / (a[0] * a[3] - a[1] * a[2]);
        inverse[0] = s * a[3];
        inverse[1] = -s * a[1];
        inverse[2] = -s * a[2];
        inverse[3] = s * a[0];
    } else {
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                inverse[3 * j + i] =
                    a[3 * ((i + 1) % 3) + (j + 1) % 3] * a[3 * ((i + 2) % 3) + (j + 2) % 3] -
                    a[3 * ((i + 1) % 3) + (j + 2) % 3] * a[3 * ((i + 2) % 3) + (j + 1) % 3];
        const R s = 1.0 / (a[0] * inverse[0] + a[1] * inverse[3] + a[2] * inverse[6]);
        for (int k = 0; k < 9; k++)
            inverse[k] *= s;
    }
    R drho[DIM], dp[DIM], dv[DIM * DIM];
    for (int i = 0; i < DIM; i++) {
        drho[i] = dp[i] = 0.0;
        for (int c = 0; c < DIM; c++) {
            drho[i] += inverse[i * DIM + c] * grho[c];
            dp[i] += inverse[i * DIM + c] * gp[c];
        }
        for (int j = 0; j < DIM; j++) {
            dv[j * DIM + i] = 0.0;
            for (int c = 0; c < DIM; c++)
                dv[j * DIM + i] += inverse[i * DIM + c] * gv[j * DIM + c];
        }
    }
    for (int i = 0; i < DIM; i++) {
        grho[i] = drho[i];
        gp[i] = dp[i];
    }
    for (int k = 0; k < DIM * DIM; k++)
        gv[k] = dv[k];
}
