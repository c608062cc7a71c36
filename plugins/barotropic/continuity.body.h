/* continuity.body.h -- one pair of the continuity equation: m_j (v_i - v_j) . grad W. */
const R slope = sph_grad(K, m_j, r, 0.5 * (hinv_i + hinv_j));
R closing = (v_i[0] - v_j[0]) * dx[0];
for (int c = 1; c < DIM; c++)
    closing += (v_i[c] - v_j[c]) * dx[c];
sph_add(drho, slope *closing);
