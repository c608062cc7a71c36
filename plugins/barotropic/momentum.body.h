/* momentum.body.h -- one pair of the momentum equation: pressures in the symmetric form. */
const R push = sph_grad(K, m_j, r, 0.5 * (hinv_i + hinv_j)) * (p_rho2_i + p_rho2_j);
for (int c = 0; c < DIM; c++)
    sph_sub(a[c], push *dx[c]);
