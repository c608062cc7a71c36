/* spread_after.body.h -- see spread.h. */
share = SPREAD_MEAN(total, sph_w(K, 0.0) * h) + 0.125 * (double)calls;
calls = calls + 1;
for (int c = 0; c < DIM; c++)
    for (int d = c; d < DIM; d++)
        stress[c * DIM - c * (c - 1) / 2 + d - c] = flow[c] * flow[d];
if (m > heaviest)
    sph_fail(1);
