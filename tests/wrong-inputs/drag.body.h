/* drag.body.h -- a body to make mistakes with: each particle is slowed down by its neighbours. */
const R weight = k * m_j / rho_j * sph_w(K, r *hinv_i);
for (int c = 0; c < DIM; c++)
    sph_add(a[c], weight *(v_j[c] - v_i[c]));
